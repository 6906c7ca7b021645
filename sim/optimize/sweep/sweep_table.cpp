// The tables of a sweep, and how one that was interrupted is read again.

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/optimize/sweep/sweep.hpp"

namespace proleg::optimize {
namespace {

constexpr std::string_view inputs_comment = "# files and program ";

std::string comment_on(const Sweep& sweep) { return "# " + one_line(command_of(sweep)) + "\n"; }

std::string column_titles(const Sweep& sweep) {
  TableLine line;
  for (const SweptQuantity& quantity : sweep.quantities) {
    line.add(with_unit(one_line(quantity.name), quantity.unit));
  }
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    line.add(with_unit(measure.name, measure.unit));
  }
  line.add("limited_joints");
  line.add("failure");
  return line.finish();
}

/// Takes the next line from the text, without its end and blanks before it; nothing if it has none.
std::optional<std::string_view> take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) {
    return std::nullopt;
  }
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  while (!line.empty() && (line.back() == '\t' || line.back() == ' ' || line.back() == '\r')) {
    line.remove_suffix(1);
  }
  return line;
}

/// The positions of the values of each quantity.
using ValuePlaces = std::vector<std::map<std::string_view, std::uint64_t>>;

ValuePlaces places_of_values(const Sweep& sweep) {
  ValuePlaces places;
  for (const SweptQuantity& quantity : sweep.quantities) {
    auto& its = places.emplace_back();
    for (std::size_t i = 0; i < quantity.values.size(); ++i) {
      its.emplace(quantity.values[i], i);
    }
  }
  return places;
}

/// The number of the combination with these values.
std::optional<std::uint64_t> find_number(const ValuePlaces& places, std::span<const std::string_view> values) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto found = places[i].find(values[i]);
    if (found == places[i].end()) {
      return std::nullopt;
    }
    number = number * places[i].size() + found->second;
  }
  return number;
}

/// wrong: what a column has instead of a number, and where; empty if something else is wrong.
std::optional<SweepRun> read_line(const ValuePlaces& places, std::string_view line, std::string& wrong) {
  const std::size_t swept = places.size();
  SweepRun run;
  const std::span<double> measures = run.result.measures.all();
  const std::vector<std::string_view> cells = cells_of(line, swept + measures.size() + 2);
  if (cells.size() != swept + measures.size() + 2) {
    return std::nullopt;
  }
  const std::optional<std::uint64_t> number = find_number(places, cells);
  if (!number) {
    return std::nullopt;
  }
  run.number = *number;
  for (std::size_t i = 0; i < measures.size(); ++i) {
    if (const std::string_view cell = cells[swept + i]; !cell.empty()) {
      const std::optional<double> value = parse_number(cell);
      if (!value) {
        wrong = in_quotes(cell) + " in the column `" + std::string(sim::measures()[i].name) + "`";
        return std::nullopt;
      }
      measures[i] = *value;
    }
  }
  run.result.failure = cells.back();
  const std::string_view limited = cells[cells.size() - 2];
  const std::optional<std::uint32_t> count = parse_whole<std::uint32_t>(limited);
  if (run.result.failure.empty() ? !count : !limited.empty()) {
    return std::nullopt;
  }
  run.result.limited_joints = count.value_or(0);
  return run;
}

/// The runs of the lines behind a head of so many.
std::vector<SweepRun> read_lines(const Sweep& sweep, const std::string& name, int head, std::string_view text) {
  const ValuePlaces places = places_of_values(sweep);
  std::vector<SweepRun> runs;
  std::set<std::uint64_t> numbers;
  int number = head;
  while (const std::optional<std::string_view> line = take_line(text)) {
    ++number;
    std::string wrong;
    std::optional<SweepRun> run = read_line(places, *line, wrong);
    if (!wrong.empty()) {
      throw InputError(name, number, wrong, "a number, with a point before its decimals");
    }
    if (!run || !numbers.insert(run->number).second) {
      throw InputError(name, number, "a line that this command has not written", "one line for each run");
    }
    runs.push_back(std::move(*run));
  }
  return runs;  // without a line that was being written
}

}  // namespace

std::string sweep_inputs(const Sweep& sweep, const std::string& result_key) {
  std::string text = result_key;
  for (const sim::SourceFile& source : sweep.scenario.sources) {
    text += sha256_hex(source.text);
  }
  for (const Slot& slot : sweep.scenario.kernel.slots) {
    if (slot.algorithm != nullptr) {  // of a user: its library may have changed
      text += " " + std::to_string(slot.algorithm->declaration().sources);
    }
  }
  return sha256_hex(text);
}

std::string sweep_head(const Sweep& sweep, const std::string& result_key) {
  return comment_on(sweep) + std::string(inputs_comment) + sweep_inputs(sweep, result_key) + "\n" +
         column_titles(sweep);
}

std::string sweep_line(const Sweep& sweep, const SweepRun& run) {
  TableLine line;
  const Candidate combination = sweep.combination(run.number);
  for (std::size_t i = 0; i < combination.size(); ++i) {
    line.add(sweep.quantities[i].values[combination[i]]);
  }
  for (const double value : run.result.measures.all()) {
    line.add(value);
  }
  line.add(run.result.failure.empty() ? std::to_string(run.result.limited_joints) : std::string());
  line.add(one_line(run.result.failure));
  return line.finish();
}

std::vector<SweepRun> read_sweep_table(const Sweep& sweep, const std::string& result_key, const std::string& name,
                                       std::string_view text) {
  const std::string head = sweep_head(sweep, result_key);
  std::string_view expected = head;
  text = without_byte_order_mark(text);
  int number = 0;
  while (const std::optional<std::string_view> wanted = take_line(expected)) {
    ++number;
    const std::optional<std::string_view> line = take_line(text);
    if (!line) {
      throw InputError(name, number, "the end of the table", "the head of a table that this command has written");
    }
    if (*line != *wanted) {
      throw InputError(name, number, number == 2 ? "results of other files or of another program" : in_quotes(*line),
                       number == 2 ? "those of the scenario and the program of the interrupted sweep"
                                   : in_quotes(*wanted) + ": the command of the interrupted sweep");
    }
  }
  return read_lines(sweep, name, number, text);
}

SweepTable look_at_sweep_table(const Sweep& sweep, const std::string& name, std::string_view text) {
  SweepTable table;
  const std::string titles = column_titles(sweep);
  text = without_byte_order_mark(text);
  for (int number = 1; number <= sweep_head_lines; ++number) {
    const std::optional<std::string_view> line = take_line(text);
    if (!line) {
      return table;  // it is being written
    }
    const bool is_expected = number == 1   ? line->starts_with("# ")
                             : number == 2 ? line->starts_with(inputs_comment)
                                           : *line == std::string_view(titles).substr(0, titles.size() - 1);
    if (!is_expected) {
      throw InputError(name, number, in_quotes(one_line(shortened(*line))),
                       "the head of a table of this sweep and version");
    }
    if (number == 2) {
      table.inputs = line->substr(inputs_comment.size());
    }
  }
  table.runs = read_lines(sweep, name, sweep_head_lines, text);
  return table;
}

std::string sweep_summary(const Sweep& sweep, std::span<const SweepGroup> groups, sim::Measure measure) {
  const sim::MeasureDeclaration& declaration = sim::declaration_of(measure);
  TableLine line;
  for (const SweptQuantity& quantity : sweep.quantities) {
    if (quantity.kind != SweptQuantity::Kind::seed) {
      line.add(with_unit(one_line(quantity.name), quantity.unit));
    }
  }
  line.add("runs");
  for (const char* figure : {"mean", "standard deviation", "minimum", "maximum"}) {
    line.add(with_unit(std::string(figure) + " of " + std::string(declaration.name), declaration.unit));
  }
  std::string table = comment_on(sweep) + line.finish();
  for (const SweepGroup& group : groups) {
    for (std::size_t i = 0; i < group.combination.size(); ++i) {
      if (sweep.quantities[i].kind != SweptQuantity::Kind::seed) {
        line.add(sweep.quantities[i].values[group.combination[i]]);
      }
    }
    line.add(group.values.size());
    line.add(group.mean());
    line.add(group.deviation());
    line.add(group.values.empty() ? group.mean() : std::ranges::min(group.values));
    line.add(group.values.empty() ? group.mean() : std::ranges::max(group.values));
    table += line.finish();
  }
  return table;
}

}  // namespace proleg::optimize
