#include <algorithm>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/optimize/sweep/sweep.hpp"

namespace proleg::optimize {
namespace {

std::string comment_on(const Sweep& sweep) { return "# " + one_line(command_of(sweep)) + "\n"; }

}  // namespace

std::string fixed_options(const Sweep& sweep) {
  std::string text;
  for (const std::string& setting : sweep.settings) {
    text += "--set " + setting + " ";
  }
  text += "--seconds " + exact_text(sweep.scenario.duration_s);
  const sim::OverrideWords words = sim::words_of(sweep.scenario.overrides);
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& word = words.*declaration.word) {
      text += " --" + std::string(declaration.name) + " " + *word;
    }
  }
  return text;
}

std::string command_of(const Sweep& sweep) {
  std::string text = "proleg sweep " + sweep.scenario.path;
  for (const SweptQuantity& quantity : sweep.quantities) {
    text += " --over " + quantity.word;
  }
  return text + " " + fixed_options(sweep);
}

std::string sweep_table(const Sweep& sweep, std::span<const SweepRun> runs) {
  TableLine line;
  for (const SweptQuantity& quantity : sweep.quantities) {
    line.add(with_unit(one_line(quantity.name), quantity.unit));
  }
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    line.add(with_unit(measure.name, measure.unit));
  }
  line.add("limited_joints");
  line.add("failure");
  std::string table = comment_on(sweep) + line.finish();
  for (const SweepRun& run : runs) {
    const Candidate combination = sweep.combination(run.number);
    for (std::size_t i = 0; i < combination.size(); ++i) {
      line.add(sweep.quantities[i].values[combination[i]]);
    }
    for (const double value : run.result.measures.all()) {
      line.add(value);
    }
    line.add(run.result.failure.empty() ? std::to_string(run.result.limited_joints) : std::string());
    line.add(one_line(run.result.failure));
    table += line.finish();
  }
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
