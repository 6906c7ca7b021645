#pragma once

// Checks the gaits of an experiment of the thesis: those without a search, and the best of each method.

#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "sim/optimize/report/thesis_experiment.hpp"
#include "tools/proleg/search/experiment_methods.hpp"
#include "tools/proleg/search/gait_checks.hpp"
#include "tools/proleg/search/repetitions.hpp"

namespace proleg::tools {

/// The figures of check_gaits().
inline constexpr std::array<std::string_view, 2> gait_check_figures{"figure_6_8.svg", "figure_7_3.svg"};

[[nodiscard]] std::vector<optimize::Reference> reference_distances(const optimize::ThesisExperiment& thesis,
                                                                   const optimize::Experiment& experiment,
                                                                   const std::filesystem::path& scenarios);

/// Checks the references on the obstacle, the best of each method, and its best that keeps the level, if it has one:
/// each in its own world, in other worlds and on level ground. Writes figures 6.8, the crossing of the best, and 7.3,
/// all distances on a ruler, to the folder, and the gaits that keep the level to those of the methods. results: one for
/// each chosen method. The experiment must have a level ground. Throws CheckInterrupted.
[[nodiscard]] std::vector<CheckedGait> check_gaits(const optimize::ThesisExperiment& thesis,
                                                   const std::vector<ChosenMethod>& chosen,
                                                   const std::vector<MethodResult>& results,
                                                   const std::filesystem::path& scenarios,
                                                   const std::filesystem::path& folder);

}  // namespace proleg::tools
