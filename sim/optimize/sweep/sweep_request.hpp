#pragma once

// What a sweep was asked for, as a file in the folder of its results: other programs can show the sweep and continue
// it.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/sweep/sweep.hpp"
#include "sim/scenario/overrides.hpp"

namespace proleg::optimize {

inline constexpr const char* sweep_request_name = "options.tsv";
inline constexpr const char* sweep_table_name = "sweep.tsv";

struct SweepRequest {
  std::string started;   ///< ISO 8601
  std::string folder;    ///< in which the program was started: absolute, or relative to that of the results
  std::string scenario;  ///< file, relative to that folder
  std::string measure;
  std::vector<std::string> over;   ///< arguments of `--over`
  std::vector<std::string> units;  ///< of the quantities, in the same order
  std::vector<std::string> settings;
  std::optional<std::string> seconds;
  sim::OverrideWords overrides;
};

/// A line for each value: its name, a tab, and the value.
[[nodiscard]] std::string sweep_request_text(const SweepRequest& request);
/// name: of the file, for errors. Throws InputError for a text that sweep_request_text() does not write.
[[nodiscard]] SweepRequest read_sweep_request(const std::string& name, std::string_view text);

/// The sweep without its scenario, which may be gone: its quantities, for its tables. Throws InputError.
[[nodiscard]] Sweep sweep_without_scenario(const SweepRequest& request);

/// The words of the command line of `proleg sweep` that ask for it, without the folder of the results.
[[nodiscard]] std::vector<std::string> words_of(const SweepRequest& request);

}  // namespace proleg::optimize
