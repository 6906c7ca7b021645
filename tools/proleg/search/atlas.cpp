// proleg atlas: fills a map of gaits as proleg optimise does, and writes the scenario of any of its cells.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/run_measures.hpp"
#include "tools/proleg/common/scratch_folder.hpp"
#include "tools/proleg/search/map_result.hpp"
#include "tools/proleg/search/optimise.hpp"
#include "tools/proleg/search/search_result.hpp"

namespace proleg::tools {
namespace {

using optimize::Evaluation;
using optimize::Experiment;
using optimize::GaitMap;

struct AtlasOptions : OptimiseOptions {
  std::optional<std::string> of;
  std::optional<std::string> cell;
  std::optional<std::string> near;
};

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    parts.emplace_back(trimmed(text.substr(start, end - start)));
    start = end + 1;
  }
  return parts;
}

/// "height from 1 to 25, duty_factor from 1 to 20".
std::string places_text(const GaitMap& map) {
  std::string text;
  for (const GaitMap::PlaceNumber& number : map.place_numbers()) {
    text += (text.empty() ? "" : ", ") + number.name + " from 1 to " + std::to_string(number.count);
  }
  return text;
}

/// The cell that --cell names; it is filled.
GaitMap::Elite named_cell(const GaitMap& map, const std::string& text) {
  std::vector<std::uint32_t> place;
  for (const std::string& word : split(text)) {
    const std::optional<std::uint32_t> number = parse_whole<std::uint32_t>(word);
    place.push_back(number.value_or(0) - 1);  // 0 becomes a number that no axis has
  }
  const std::optional<std::size_t> cell = map.cell_at(place);
  if (!cell) {
    throw InputError("--cell", 0, in_quotes(text), "the numbers of a cell, as map.tsv has them: " + places_text(map));
  }
  if (const GaitMap::Elite* const elite = map.elite_of(*cell)) {
    return *elite;
  }
  const std::vector<double> middle = map.middle(*cell);
  std::string nearest;
  constexpr std::size_t named = 3;
  for (const GaitMap::Elite& elite :
       map.nearest(std::vector<std::optional<double>>(middle.begin(), middle.end()), named)) {
    nearest += (nearest.empty() ? "" : " ") + map.place_text(elite.cell);
  }
  throw InputError("--cell", 0, "the empty cell " + map.place_text(*cell), "a filled one; the nearest: " + nearest);
}

/// The filled cell that is nearest to the values of --near.
GaitMap::Elite nearest_cell(const Experiment& experiment, const GaitMap& map, const std::string& text) {
  std::vector<std::optional<double>> values(experiment.axes.size());
  std::vector<std::string> names;
  for (std::size_t i = 0; i < values.size(); ++i) {
    names.push_back(experiment.objectives[1 + i].name);
  }
  for (const std::string& word : split(text)) {
    const std::size_t sign = std::min(word.find('='), word.size());
    const auto name = std::ranges::find(names, trimmed(std::string_view(word).substr(0, sign)));
    const std::optional<double> value =
        parse_number(trimmed(std::string_view(word).substr(std::min(sign + 1, word.size()))));
    if (name == names.end() || !value || !std::isfinite(*value)) {
      throw InputError("--near", 0, in_quotes(word),
                       "a value of an axis, as " + names.front() + "=0.02; the axes are " + listed(names));
    }
    std::optional<double>& its = values[static_cast<std::size_t>(name - names.begin())];
    if (its) {
      throw InputError("--near", 0, "a second value of " + *name, "one");
    }
    its = value;
  }
  return map.nearest(values, 1).front();
}

Json object_of(const Experiment& experiment, const GaitMap& map, std::size_t cell, const Evaluation& evaluation,
               const std::filesystem::path& file) {
  return {{"cell", place_object(map, cell)},
          {"number", evaluation.number},
          {"engine", optimize::trial_maker(experiment)},
          {"score", evaluation.scores.front()},
          {"measures", measures_object(evaluation.measures)},
          {"values", values_object(experiment.space, evaluation.candidate)},
          {"scenario", file.string()}};
}

void print_cell(const Experiment& experiment, const GaitMap& map, std::size_t cell, const Evaluation& evaluation,
                const std::filesystem::path& file) {
  print_line("cell", map.place_text(cell));
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    const optimize::Objective& objective = experiment.objectives[i];
    print_line("  " + objective.name, optimize::rounded_text(evaluation.scores[i], objective.unit()));
  }
  print_line("engine", std::string(optimize::trial_maker(experiment)));
  print_line("written", file.string());
}

/// Throws BadInput for options that mean nothing beside --of.
void refuse_search(const std::vector<std::string>& given) {
  constexpr std::array<std::string_view, 6> of_cell{"--of", "--cell", "--near", "--out", "--json", "--algorithms"};
  for (const std::string& option : given) {
    if (std::ranges::count(of_cell, option) == 0) {
      throw BadInput("found --of beside a search (" + option + "), expected one of them");
    }
  }
}

/// Throws BadInput if a file that a person may have edited, or that is of another search, would be replaced.
/// new_files: has the files that will be written.
void refuse_other_content(const std::filesystem::path& out, const std::filesystem::path& new_files) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(new_files)) {
    const std::filesystem::path old = out / std::filesystem::relative(entry.path(), new_files);
    std::error_code error;
    if (entry.is_regular_file() && std::filesystem::exists(std::filesystem::symlink_status(old, error)) &&
        (!std::filesystem::is_regular_file(old, error) || read_whole_file(old) != read_whole_file(entry.path()))) {
      throw BadInput(old.string() +
                     ": found an existing file with other content, expected none; --out FOLDER names another folder");
    }
  }
}

/// Writes the scenario of a cell of a map that a search has filled.
int write_cell(const AtlasOptions& options) {
  require_map_store("--of", *options.of);
  const std::filesystem::path folder(*options.of);
  const std::filesystem::path store = store_path(folder);
  const Experiment experiment = optimize::read_experiment_of(store);
  require_map(experiment);
  const std::vector<Evaluation> evaluations =
      optimize::Store(store, experiment, {}, optimize::Store::Opening::trust).evaluations(0);
  const GaitMap map = optimize::gait_map(experiment, evaluations);
  if (map.elites().empty()) {
    throw BadInput(store.string() + ": found no filled cell, expected a search that has filled some");
  }
  const GaitMap::Elite elite =
      options.cell ? named_cell(map, *options.cell) : nearest_cell(experiment, map, *options.near);
  const Evaluation& evaluation = evaluations[elite.candidate];
  const std::string place = map.place_text(elite.cell);
  std::string name = "cell_" + place;
  std::ranges::replace(name, ',', '_');
  const std::filesystem::path out = chosen_folder(options.out, std::nullopt, folder.string(), "cell");
  check_result_folder(out, {});
  const std::array files{name + ".simulation.xml", name + ".actuation.xml", name + ".files"};
  const std::array<std::string_view, 3> written{files[0], files[1], files[2]};
  refuse_overwriting(experiment, out, written);
  const auto write_to = [&](const std::filesystem::path& its_folder) {
    return optimize::write_scenario(
        optimize::searched_world(experiment, evaluation),
        "Cell " + place + " of the map of gaits of " + std::filesystem::path(experiment.path).filename().string() + ".",
        its_folder, name);
  };
  const ScratchFolder scratch;
  write_to(scratch.path());
  refuse_other_content(out, scratch.path());
  const std::filesystem::path file = write_to(out);
  if (options.json) {
    std::cout << object_of(experiment, map, elite.cell, evaluation, file).text() << '\n';
  } else {
    print_cell(experiment, map, elite.cell, evaluation, file);
  }
  return exit_success;
}

int atlas(const AtlasOptions& options, const std::vector<std::string>& given) {
  const bool names_cell = options.cell || options.near;
  if (options.of.has_value() != names_cell) {
    throw BadInput(options.of ? "found --of without a cell, expected --cell or --near"
                              : "found --cell or --near without --of, expected --of FOLDER");
  }
  if (options.of) {
    refuse_search(given);
    try {
      return write_cell(options);
    } catch (const optimize::StoreError& error) {
      throw BadInput(error.what());
    }
  }
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) {
    throw BadInput("found mpirun, expected 'mpirun proleg optimise FILE --engine reduced', which fills the same map");
  }
  return optimise(options, [](const Experiment& experiment, const OptimiseOptions& search) {
    return std::make_unique<optimize::LocalWorkers>(experiment, parse_workers(search.workers));
  });
}

}  // namespace

int atlas_command(int argc, char** argv) {
  AtlasOptions options;
  options.program = "proleg atlas";
  options.fills_atlas = true;
  CommandLine command_line(options.program,
                           "Fills a map of gaits with the reduced engine: many different gaits, the best of each kind "
                           "(<mapElites>). ODE then "
                           "simulates some of them again. With --of, writes the scenario of any cell of a map.");
  add_optimise_options(command_line, options);
  command_line.add_option("--judge", options.judge,
                          "number of cells, drawn at random, that ODE simulates again after the search; default: " +
                              std::to_string(usual_judged_cells));
  command_line
      .add_option("--of", options.of,
                  "write the scenario of a cell of the map in this folder, into the folder or --out")
      .value_name("FOLDER");
  command_line
      .add_option("--cell", options.cell,
                  "the cell: its number on each axis, as map.tsv has it: 3,7; of a map with centroids its one number")
      .value_name("X,Y,...");
  command_line
      .add_option("--near", options.near,
                  "the filled cell that is nearest to these measures: height=0.02,duty_factor=0.3")
      .value_name("MEASURE=VALUE,...")
      .excludes("--cell");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return atlas(options, command_line.given()); });
}

}  // namespace proleg::tools
