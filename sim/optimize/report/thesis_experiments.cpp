#include "sim/optimize/report/thesis_experiments.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace proleg::optimize {
namespace {

/// Rows from head to tail, by the first joint that each dimension sets.
std::vector<ThesisRow> joint_rows(const SearchSpace& space) {
  std::vector<std::size_t> order(space.dimensions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return space.dimensions[i].targets.front().joint; });
  std::vector<ThesisRow> rows;
  rows.reserve(order.size());
  for (const std::size_t dimension : order) {
    rows.push_back({"Joint " + std::to_string(rows.size()), dimension});
  }
  return rows;
}

/// Rows with the thesis's names of the constants.
std::vector<ThesisRow> constant_rows(const SearchSpace& space) {
  std::vector<ThesisRow> rows;
  for (const Dimension& dimension : space.dimensions) {
    std::string name = dimension.name;
    if (name == "stuck_threshold") {
      name = "Get-stuck";
    } else if (name == "recovering") {
      name = "Recovering";
    } else if (name.starts_with("constant_")) {
      name = "Constant " + name.substr(name.find('_') + 1);
    }
    rows.push_back({name, rows.size()});
  }
  return rows;
}

constexpr std::array<ThesisMethod, 3> wave_methods{{
    {"great-deluge", "great_deluge.optimise.xml", "table_6_2.tsv", "figure_6_3.svg", "figure_6_4.svg"},
    {"genetic", "genetic.optimise.xml", "table_6_4.tsv", "figure_6_5.svg", "figure_6_6.svg"},
    {"cma-es", "cma_es.optimise.xml", "table_cma_es.tsv", "figure_cma_es_runs.svg", "figure_cma_es_spread.svg"},
}};
constexpr std::array<ReferenceScenario, 1> wave_references{{{"uniform amplitudes of 40 deg", "uniform", "", 1.65}}};

constexpr std::array<ThesisMethod, 4> touch_methods{{
    {"great-deluge", "great_deluge.optimise.xml", "table_6_7.tsv", "figure_6_10.svg", "figure_6_11.svg"},
    {"great-deluge-bounded", "great_deluge_bounded.optimise.xml", "table_6_7_bounded.tsv", "figure_6_10_bounded.svg",
     "figure_6_11_bounded.svg"},
    {"genetic", "genetic.optimise.xml", "table_6_9.tsv", "figure_6_12.svg", "figure_6_13.svg"},
    {"cma-es", "cma_es.optimise.xml", "table_cma_es.tsv", "figure_cma_es_runs.svg", "figure_cma_es_spread.svg"},
}};
constexpr std::string_view touch_level_ground = "plain_level.simulation.xml";
constexpr std::array<ReferenceScenario, 3> touch_references{{
    {"the sine without the reflex", "no reflex", "plain.simulation.xml", 0.0},
    {"the reflex as set by hand", "set by hand", "reflex.simulation.xml", 0.0},
    {"the sine on level ground", "level ground", touch_level_ground, 0.0},
}};

}  // namespace

const ThesisExperiment& travelling_wave_experiment() {
  static constexpr ThesisExperiment experiment{.name = "travelling_wave",
                                               .title = "Travelling wave",
                                               .about = "the amplitudes of section 6.1",
                                               .repetitions = "3",
                                               .engine = "",
                                               .methods = wave_methods,
                                               .references = wave_references,
                                               .level_ground = "",
                                               .comparison_figure = "figure_7_1.svg",
                                               .overtaking = "5000",
                                               .shown_value = "tail joint",
                                               .shown_row = 4,
                                               .shown_unit = "deg",
                                               .rows = joint_rows};
  return experiment;
}

const ThesisExperiment& adaptive_touch_experiment() {
  static constexpr ThesisExperiment experiment{.name = "adaptive_touch",
                                               .title = "Irregular obstacle",
                                               .about = "the adaptive algorithm of section 6.2",
                                               .repetitions = "20",
                                               .engine = "reduced",
                                               .methods = touch_methods,
                                               .references = touch_references,
                                               .level_ground = touch_level_ground,
                                               .comparison_figure = "figure_7_2.svg",
                                               .overtaking = "3000",
                                               .shown_value = "get-stuck",
                                               .shown_row = 0,
                                               .shown_unit = "ms",
                                               .rows = constant_rows};
  return experiment;
}

std::span<const ThesisExperiment* const> thesis_experiments() {
  static const std::array<const ThesisExperiment*, 2> all{&travelling_wave_experiment(), &adaptive_touch_experiment()};
  return all;
}

}  // namespace proleg::optimize
