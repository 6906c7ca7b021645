#include "tools/proleg/ui/sweep_results.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using optimize::Candidate;
using optimize::Sweep;
using optimize::SweptQuantity;

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

json finite_or_null(double value) { return std::isfinite(value) ? json(value) : json(); }

bool is_seed(const SweptQuantity& quantity) { return quantity.kind == SweptQuantity::Kind::seed; }

std::uint64_t cell_count(const Sweep& sweep) {
  std::uint64_t count = 1;
  for (const SweptQuantity& quantity : sweep.quantities) {
    count *= is_seed(quantity) ? 1 : quantity.values.size();
  }
  return count;
}

std::uint64_t cell_of(const Sweep& sweep, const Candidate& combination) {
  std::uint64_t cell = 0;
  for (std::size_t i = 0; i < combination.size(); ++i) {
    if (!is_seed(sweep.quantities[i])) {
      cell = cell * sweep.quantities[i].values.size() + combination[i];
    }
  }
  return cell;
}

/// The combination of a cell with the first seed. Throws InputError.
Candidate combination_of(const Sweep& sweep, std::uint64_t cell) {
  if (cell >= cell_count(sweep)) {
    throw InputError("cell", 0, std::to_string(cell), "below " + std::to_string(cell_count(sweep)));
  }
  Candidate combination(sweep.quantities.size(), 0);
  for (std::size_t i = combination.size(); i-- > 0;) {
    if (!is_seed(sweep.quantities[i])) {
      const std::size_t count = sweep.quantities[i].values.size();
      combination[i] = static_cast<std::uint32_t>(cell % count);
      cell /= count;
    }
  }
  return combination;
}

/// The sweep with its scenario, as its files are now.
Sweep sweep_with_scenario(const fs::path& sweep, const NotedSweep& note) {
  ScenarioOptions options;
  options.file = (sweep / note.request.folder / note.request.scenario).lexically_normal().string();
  options.seconds = note.request.seconds;
  options.overrides = note.request.overrides;
  options.settings = note.request.settings;
  Sweep whole = note.outline;
  whole.scenario = prepare_run(options).scenario;
  return whole;
}

}  // namespace

const SweepResults::Table& SweepResults::table_of(const fs::path& sweep) {
  const fs::path file = SweepFolder::table_of(sweep);
  std::error_code error;
  const std::uintmax_t size = fs::is_regular_file(file, error) ? fs::file_size(file, error) : 0;
  const fs::file_time_type time = fs::last_write_time(file, error);
  if (table_ && table_->sweep == sweep) {
    const bool is_same = table_->size == size && table_->time == time;
    if (is_same || (size > table_->size && Clock::now() < table_->next_look)) {
      return *table_;
    }
  }
  const auto begin = Clock::now();
  table_.reset();
  Table table{sweep, size, time, {}, SweepFolder::note_of(sweep), {}, {}, {}};
  const std::string text = size > 0 ? read_whole_file(file) : std::string();
  table.content = optimize::look_at_sweep_table(table.note.outline, file.filename().string(), text);
  const auto end = Clock::now();
  table.next_look = end + 9 * (end - begin);  // at most a tenth of the time
  return table_.emplace(std::move(table));
}

void SweepResults::group(Table& table, sim::Measure measure) {
  if (table.measure == measure) {
    return;
  }
  const Sweep& sweep = table.note.outline;
  table.cells.assign(cell_count(sweep), {undefined, undefined});
  for (const optimize::SweepGroup& group : optimize::group_runs(sweep, table.content.runs, measure)) {
    Cell& cell = table.cells[cell_of(sweep, group.combination)];
    cell.mean = group.mean();
    cell.deviation = group.deviation();
    cell.values = group.values.size();
  }
  for (const optimize::SweepRun& run : table.content.runs) {
    if (!std::isfinite(run.result.measures[measure])) {  // a run that failed has none
      ++table.cells[cell_of(sweep, sweep.combination(run.number))].failed;
    }
  }
  table.measure = measure;
}

json SweepResults::describe(const fs::path& sweep) {
  const NotedSweep note = SweepFolder::note_of(sweep);
  json quantities = json::array();
  for (const SweptQuantity& quantity : note.outline.quantities) {
    quantities.push_back({{"name", one_line(quantity.name)},
                          {"unit", quantity.unit},
                          {"is_seed", is_seed(quantity)},
                          {"values", quantity.values}});
  }
  json joints;
  json problem;
  try {
    const Sweep whole = sweep_with_scenario(sweep, note);
    joints = whole.scenario.robot.joints.size();
    const std::string& inputs = table_of(sweep).content.inputs;
    if (!inputs.empty() && inputs != optimize::sweep_inputs(whole, result_key)) {
      problem = "the files of the scenario, or Proleg, have changed since: a gait may move otherwise now";
    }
  } catch (const std::exception& error) {
    problem = one_line(error.what());
  }
  std::string options;
  for (const std::string& word : optimize::words_of(note.request)) {
    options += (options.empty() ? "" : " ") + one_line(word);
  }
  return {{"measure", note.request.measure},       {"options", "proleg sweep " + options},
          {"planned", note.outline.size()},        {"cells", cell_count(note.outline)},
          {"quantities", std::move(quantities)},   {"joints", std::move(joints)},
          {"scenario_problem", std::move(problem)}};
}

json SweepResults::cells(const fs::path& sweep, const std::optional<std::string>& measure, std::uint64_t from) {
  constexpr std::uint64_t most = 5000;
  static_cast<void>(table_of(sweep));
  Table& table = *table_;
  const std::string name = measure.value_or(table.note.request.measure);
  const std::optional<sim::Measure> found = sim::find_measure(name);
  if (!found) {
    throw InputError("measure", 0, in_quotes(shortened(name)), "one of " + listed(sim::measure_names()));
  }
  group(table, *found);
  json cells = json::array();
  for (std::uint64_t i = from; i < table.cells.size() && i - from < most; ++i) {
    const Cell& cell = table.cells[i];
    cells.push_back({finite_or_null(cell.mean), finite_or_null(cell.deviation), cell.values, cell.failed});
  }
  return {{"from", from}, {"made", table.content.runs.size()}, {"cells", std::move(cells)}};
}

json SweepResults::cell(const fs::path& sweep, std::uint64_t number) {
  static_cast<void>(table_of(sweep));
  const NotedSweep& note = table_->note;
  const Candidate combination = combination_of(note.outline, number);
  std::vector<std::string> words = note.request.settings;
  json others = json::array();
  for (std::size_t i = 0; i < combination.size(); ++i) {
    const SweptQuantity& quantity = note.outline.quantities[i];
    std::string word = quantity.name + "=" + quantity.values[combination[i]];
    if (quantity.kind == SweptQuantity::Kind::parameter) {
      words.push_back(std::move(word));
    } else if (!is_seed(quantity)) {
      others.push_back(std::move(word));
    }
  }
  json failure;
  for (const optimize::SweepRun& run : table_->content.runs) {
    if (failure.is_null() && !run.result.failure.empty() &&
        cell_of(note.outline, note.outline.combination(run.number)) == number) {
      failure = one_line(run.result.failure);
    }
  }
  return {
      {"cell", number}, {"words", std::move(words)}, {"others", std::move(others)}, {"failure", std::move(failure)}};
}

sim::Scenario SweepResults::scenario_of(const fs::path& sweep, std::uint64_t number) {
  const NotedSweep note = SweepFolder::note_of(sweep);
  const Candidate combination = combination_of(note.outline, number);
  return sweep_with_scenario(sweep, note).scenario_of(combination);
}

}  // namespace proleg::tools
