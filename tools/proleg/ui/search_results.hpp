#pragma once

// What searches have found, as the page shows it (docs/page-interface.md, Searches): read from their stores, which
// other programs may write meanwhile.

#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// All functions throw StoreError for a store that cannot be read, and InputError for an experiment that this program
/// does not read and for an evaluation that does not exist. search: the folder of a search.
class SearchResults {
 public:
  /// The value of `search.open`, without `name`.
  [[nodiscard]] nlohmann::json describe(const std::filesystem::path& search);
  /// The value of `search.rows`.
  [[nodiscard]] nlohmann::json rows(const std::filesystem::path& search, std::uint32_t run, std::uint64_t from);
  /// The value of `search.candidate`.
  [[nodiscard]] nlohmann::json candidate(const std::filesystem::path& search, std::uint32_t run, std::uint64_t number);
  /// The value of `search.adaptations`: those in a folder, and in the folders in it, that have the map of this search.
  [[nodiscard]] nlohmann::json adaptations(const std::filesystem::path& search, const std::filesystem::path& folder);
  /// The own world of a candidate (optimize::own_world()).
  [[nodiscard]] sim::Scenario scenario_of(const std::filesystem::path& search, std::uint32_t run, std::uint64_t number);

 private:
  /// A store that was read, for the next look at it.
  struct Open {
    std::filesystem::path search;
    std::string identity;  ///< of the store
    std::unique_ptr<const optimize::Experiment> experiment;
  };

  /// It stays until other searches are looked at.
  const optimize::Experiment& experiment_of(const std::filesystem::path& search);

  std::list<Open> open_;  ///< the one that was used last is the first
};

}  // namespace proleg::tools
