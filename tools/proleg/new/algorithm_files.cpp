#include "tools/proleg/new/algorithm_files.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "sim/authoring/new_scenario.hpp"

namespace proleg::tools {
namespace {

constexpr std::size_t widest_line = 110;

constexpr std::string_view name_of(Unit unit) {
  switch (unit) {
    case Unit::degree:
      return "Unit::degree";
    case Unit::phase_degree:
      return "Unit::phase_degree";
    case Unit::hertz:
      return "Unit::hertz";
    case Unit::per_second:
      return "Unit::per_second";
    case Unit::ratio:
      return "Unit::ratio";
    case Unit::count:
      break;
  }
  return "Unit::count";
}

/// A decimal number without an exponent as a quotient; nothing if a member is too large for raw().
std::optional<std::pair<std::int64_t, std::int64_t>> quotient_of(std::string_view text) {
  constexpr std::int64_t largest = 1'000'000'000;
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;
  bool is_behind_point = false;
  for (const char c : text.starts_with('-') || text.starts_with('+') ? text.substr(1) : text) {
    if (c == '.') {
      is_behind_point = true;
      continue;
    }
    if (c < '0' || c > '9') {
      return std::nullopt;
    }
    numerator = 10 * numerator + (c - '0');
    denominator *= is_behind_point ? 10 : 1;
    if (numerator > largest || denominator > largest) {
      return std::nullopt;
    }
  }
  const std::int64_t divisor = std::gcd(numerator, denominator);
  return std::pair((text.starts_with('-') ? -1 : 1) * numerator / divisor, denominator / divisor);
}

/// A value of the form as C++.
std::string value_code(const std::string& text, Unit unit, bool is_maximum = false) {
  const std::int32_t value = form_value(text, unit, is_maximum).value_or(0);
  if (value == 0) {
    return "0";
  }
  if (wraps(unit) && (value == phase_minimum || value == phase_maximum)) {
    return value == phase_minimum ? "phase_minimum" : "phase_maximum";
  }
  if (unit == Unit::degree && std::abs(static_cast<std::int64_t>(value)) == quarter_turn) {
    return value > 0 ? "quarter_turn" : "-quarter_turn";
  }
  const auto quotient = quotient_of(text);
  if (!quotient || unit == Unit::count) {
    return std::to_string(value);
  }
  const auto [numerator, denominator] = *quotient;
  return "raw(" + std::string(name_of(unit)) + ", " + std::to_string(numerator) +
         (denominator == 1 ? "" : ", " + std::to_string(denominator)) + ")";
}

/// Whether it is a parameter that several generators share.
bool is_shared(const FormParameter& form, const Parameter& parameter) {
  return form.name == parameter.name && form.unit == parameter.unit && form.help == std::string_view(parameter.help) &&
         form_value(form.minimum, form.unit) == parameter.minimum &&
         form_value(form.usual, form.unit) == parameter.default_value &&
         form_value(form.maximum, form.unit, true) == parameter.maximum;
}

std::string parameter_code(const FormParameter& parameter) {
  namespace shared = generator_parameters;
  for (const Parameter& known :
       {shared::amplitude, shared::frequency, shared::phase_difference, shared::phase, shared::offset, shared::rate}) {
    if (is_shared(parameter, known)) {
      return "    generator_parameters::" + parameter.name + ",\n";
    }
  }
  const std::string head = "    Parameter{\"" + parameter.name + "\", " + std::string(name_of(parameter.unit)) + ", " +
                           value_code(parameter.usual, parameter.unit) + ", " +
                           value_code(parameter.minimum, parameter.unit) + ", " +
                           value_code(parameter.maximum, parameter.unit, true) + ",";
  return head + "\n              \"" + parameter.help + "\"},\n";
}

std::string value_declaration(const FormValue& value) {
  const std::string head = "    InternalValue{\"" + value.name + "\", " + std::string(name_of(value.unit)) + ", 0,";
  const std::string help = "\"" + value.help + "\"},\n";
  return head + (head.size() + help.size() < widest_line ? " " : "\n                  ") + help;
}

template <typename Named>
std::string names_of(const std::vector<Named>& items, const std::string& first_suffix = "") {
  std::string text;
  for (const Named& item : items) {
    text += (text.empty() ? "" : ", ") + item.name + (text.empty() ? first_suffix : "");
  }
  return text;
}

std::string actuation_lines(const AlgorithmForm& form) {
  std::string text;
  for (const FormParameter& parameter : form.parameters) {
    const std::string_view symbol = scale_of(parameter.unit).symbol;
    text += "    <parameter name=\"" + parameter.name + "\" value=\"" + parameter.usual + "\"" +
            (symbol.empty() ? "" : " unit=\"" + std::string(symbol) + "\"") + "/>\n";
  }
  return text;
}

/// What the templates ask for: lines between `@if KEY@`, `@else@` and `@end@` are there if it holds.
class Filling {
 public:
  Filling(const AlgorithmForm& form, const std::string& source_tree) {
    conditions_ = {{"example", has_values_of_example(form)},
                   {"harmonic", has_harmonic(form)},
                   {"own_values", !form.values.empty()},
                   {"touch", form.senses_touch},
                   {"values", is_wave(form) || !form.values.empty()},
                   {"wave", is_wave(form)}};
    std::string parameters;
    for (const FormParameter& parameter : form.parameters) {
      parameters += parameter_code(parameter);
    }
    std::string values;
    std::string reset;
    std::string advance;
    for (const FormValue& value : form.values) {
      values += value_declaration(value);
      reset += "    state[" + value.name + "] = 0;\n";
      advance += "    next[" + value.name + "] = state[" + value.name + "];\n";
    }
    words_ = {{"NAME", form.name},
              {"ID", std::to_string(form.id)},
              {"HELP", form.help},
              {"SOURCE", source_tree},
              {"PARAMETER_NAMES", names_of(form.parameters)},
              {"VALUE_NAMES", names_of(form.values)},
              {"FIRST_VALUE_NAMES", names_of(form.values, " = first_own_value")},
              {"VALUES", conditions_["values"] ? "internal_values" : "{}"},
              {"FRAME", conditions_["wave"] ? "frame" : "{}"},
              {"SURROUNDINGS", form.senses_touch ? "surroundings" : "/*surroundings*/"},
              {"STATE", is_wave(form) || !form.values.empty() ? "state" : "/*state*/"},
              {"NEXT", is_wave(form) || !form.values.empty() ? "next" : "/*next*/"}};
    blocks_ = {{"@PARAMETERS@", parameters},
               {"@OWN_VALUES@", values},
               {"@RESET_VALUES@", reset},
               {"@ADVANCE_VALUES@", advance},
               {"@ACTUATION@", actuation_lines(form)}};
  }

  [[nodiscard]] std::string fill(std::string_view text) const {
    std::string result;
    struct Condition {
      bool is_shown;
      bool is_else_shown;
    };
    std::vector<Condition> around{{true, false}};  // a line; each with those around it
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
      const std::string_view line = text.substr(0, end);
      text.remove_prefix(end);
      if (const std::string_view key = trimmed(line); key.starts_with("@if ")) {
        const std::string name(key.substr(4, key.size() - 5));
        const bool holds = conditions_.at(name);
        around.push_back({around.back().is_shown && holds, around.back().is_shown && !holds});
      } else if (key == "@else@") {
        around.back().is_shown = around.back().is_else_shown;
      } else if (key == "@end@") {
        around.pop_back();
      } else if (around.back().is_shown) {
        const auto block = blocks_.find(std::string(key));
        result += block == blocks_.end() ? filled_line(line) : block->second;
      }
    }
    return result;
  }

 private:
  [[nodiscard]] std::string filled_line(std::string_view line) const {
    std::string result(line);
    for (const auto& [key, value] : words_) {
      const std::string mark = "@" + key + "@";
      for (std::size_t at = result.find(mark); at != std::string::npos; at = result.find(mark, at + value.size())) {
        result.replace(at, mark.size(), value);
      }
    }
    return result;
  }

  std::map<std::string, bool> conditions_;
  std::map<std::string, std::string> words_;
  std::map<std::string, std::string> blocks_;  ///< in place of a whole line
};

}  // namespace

void check_algorithm_folder(const std::string& folder, const std::string& field) {
  if (folder.find_first_of(";\"\\$ \t\n") != std::string::npos) {
    throw InputError(field, 0, in_quotes(folder),
                     "a folder without blanks and ; \" \\ $, which CMake treats specially");
  }
}

std::vector<sim::SourceFile> algorithm_files(const AlgorithmForm& form, const std::string& source_tree) {
  const Filling filling(form, source_tree);
  std::vector<sim::SourceFile> files{
      {"README.md", filling.fill(algorithm_readme_text())},
      {form.name + ".cpp", filling.fill(algorithm_source_text())},
      {form.name + "_test.cpp",
       filling.fill(has_values_of_example(form) ? algorithm_test_text() : algorithm_plain_test_text())},
      {"CMakeLists.txt", filling.fill(algorithm_cmake_text())}};
  for (sim::SourceFile& file : sim::new_scenario_files(sim::robot_kinds().front(), "ppppp")) {
    if (file.path == "robot.actuation.xml") {
      file.text = filling.fill(algorithm_actuation_text());
    }
    files.push_back({"robot/" + file.path, std::move(file.text)});
  }
  return files;
}

}  // namespace proleg::tools
