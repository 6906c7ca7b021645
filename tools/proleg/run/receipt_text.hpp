#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/scenario/overrides.hpp"

namespace proleg::tools {

/// What repeats a run, and what it gave: one line that another machine can verify.
///
///   proleg-receipt:1 scenario=9f86... core=1a2b3c4d engine=reduced-1 seconds=30 seed=7 set=amplitude=41
///   distance=1.6408 world=0f81...
struct Receipt {
  std::string scenario;               ///< SHA-256 of the texts of its files
  std::string core;                   ///< fingerprint of the algorithms
  std::string engine;                 ///< with its version
  std::string seconds;                ///< as --seconds
  sim::OverrideWords overrides;       ///< as the options; no engine
  std::vector<std::string> settings;  ///< as --set, in their order
  std::string measure;                ///< its name
  std::string value;                  ///< of the measure
  std::string world;                  ///< hash of the states of the world

  bool operator==(const Receipt&) const = default;
};

/// Without a line feed. No text may contain white space.
[[nodiscard]] std::string text_of(const Receipt& receipt);

/// White space between the words may be any. Throws InputError.
[[nodiscard]] Receipt read_receipt(std::string_view text);

}  // namespace proleg::tools
