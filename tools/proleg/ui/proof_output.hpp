#pragma once

// What `proleg verify --json` prints (docs/user-algorithms.md).

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace proleg::tools {

/// What is done now: the last step that standard error names.
struct ProofStep {
  std::uint32_t done = 0;  ///< from 1; 0: none is named yet
  std::uint32_t of = 0;
  std::string text;
};
[[nodiscard]] ProofStep proof_step(std::string_view errors);

/// The object of standard output; null as long as it is not there.
[[nodiscard]] nlohmann::json proof_object(std::string_view output);

/// Why the algorithm is not verified, after the end of the program; empty if it is.
[[nodiscard]] std::string proof_error(const nlohmann::json& proof, std::string_view errors, int status);

}  // namespace proleg::tools
