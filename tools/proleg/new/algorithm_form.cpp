#include "tools/proleg/new/algorithm_form.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <span>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/crc32.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::tools {
namespace {

constexpr std::size_t longest_form_name = 32;
constexpr std::size_t longest_value_name = 60;
constexpr std::size_t longest_help = 200;
/// A pattern generator has three internal values of its own.
constexpr std::size_t values_of_wave = 3;

/// Words that C++ or the example needs, and names of CMake's targets: a function or a target with such a name does not
/// compile.
constexpr std::array reserved{"about",
                              "alignas",
                              "alignof",
                              "all",
                              "amplitude",
                              "and",
                              "and_eq",
                              "asm",
                              "auto",
                              "bitand",
                              "bitor",
                              "bool",
                              "break",
                              "case",
                              "catch",
                              "char",
                              "char16_t",
                              "char32_t",
                              "char8_t",
                              "class",
                              "clean",
                              "co_await",
                              "co_return",
                              "co_yield",
                              "compl",
                              "concept",
                              "const",
                              "const_cast",
                              "consteval",
                              "constexpr",
                              "constinit",
                              "continue",
                              "decltype",
                              "default",
                              "delete",
                              "depend",
                              "do",
                              "double",
                              "dynamic_cast",
                              "edit_cache",
                              "else",
                              "enum",
                              "explicit",
                              "export",
                              "extern",
                              "false",
                              "float",
                              "for",
                              "frame",
                              "frequency",
                              "friend",
                              "goto",
                              "help",
                              "if",
                              "inline",
                              "install",
                              "instance",
                              "int",
                              "internal_values",
                              "list_install_components",
                              "long",
                              "main",
                              "mutable",
                              "namespace",
                              "new",
                              "noexcept",
                              "not",
                              "not_eq",
                              "nullptr",
                              "operator",
                              "or",
                              "or_eq",
                              "package",
                              "package_source",
                              "parameters",
                              "phase_difference",
                              "preinstall",
                              "private",
                              "proleg",
                              "proleg_core",
                              "protected",
                              "public",
                              "rebuild_cache",
                              "register",
                              "reinterpret_cast",
                              "requires",
                              "return",
                              "short",
                              "signed",
                              "sine",
                              "sizeof",
                              "static",
                              "static_assert",
                              "static_cast",
                              "steepness",
                              "struct",
                              "switch",
                              "template",
                              "test",
                              "tested_algorithm",
                              "this",
                              "thread_local",
                              "throw",
                              "true",
                              "try",
                              "typedef",
                              "typeid",
                              "typename",
                              "union",
                              "unsigned",
                              "user",
                              "using",
                              "virtual",
                              "void",
                              "volatile",
                              "wchar_t",
                              "while",
                              "xor",
                              "xor_eq",
                              "Algorithm",
                              "Parameter"};

/// Words that a parameter or an internal value may not be: names in the source that the form gives.
constexpr std::array used_by_source{"advance",
                                    "advance_pattern",
                                    "add_wrapping",
                                    "current_phase",
                                    "declaration",
                                    "derive",
                                    "derive_pattern",
                                    "derived",
                                    "extrapolate",
                                    "first_own_derived",
                                    "first_own_value",
                                    "harmonic",
                                    "measured_frequency",
                                    "measured_phase_difference",
                                    "multiply",
                                    "next",
                                    "nominal_frequency",
                                    "output",
                                    "phase_increment",
                                    "raw",
                                    "rejoin",
                                    "reset",
                                    "reset_pattern",
                                    "senses_contacts",
                                    "start_phase",
                                    "state",
                                    "surroundings",
                                    "theta",
                                    "ticks_per_second",
                                    "touches",
                                    "tuning",
                                    "values"};

bool is_reserved(std::string_view name) { return std::ranges::find(reserved, name) != reserved.end(); }

/// Whether the word is one of the example's parameters, for which `reserved` has it.
bool is_parameter_of_example(std::string_view name) {
  return name == "amplitude" || name == "frequency" || name == "phase_difference" || name == "steepness";
}

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

bool is_word(std::string_view name, std::size_t longest) {
  return !name.empty() && name.size() <= longest && is_letter(name.front()) &&
         std::ranges::all_of(name, [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; }) &&
         name.find("__") == std::string_view::npos;
}

FormParameter form_of(const Parameter& parameter) {
  const auto text = [&](std::int32_t raw) {
    if (wraps(parameter.unit) && raw == phase_maximum) {
      return std::string("180");
    }
    return std::string(format_decimal(raw, parameter.unit).view());
  };
  return {std::string(parameter.name),   parameter.unit,          text(parameter.minimum),
          text(parameter.default_value), text(parameter.maximum), std::string(std::string_view(parameter.help))};
}

const FormParameter* find(const AlgorithmForm& form, std::string_view name, Unit unit) {
  const auto found = std::ranges::find_if(
      form.parameters, [&](const FormParameter& each) { return each.name == name && each.unit == unit; });
  return found == form.parameters.end() ? nullptr : &*found;
}

void check_help(const std::string& help, const std::string& field) {
  // It becomes a text in the source.
  if (help.empty() || help.size() > longest_help || !is_visible_line(help) ||
      help.find_first_of("\"\\@") != std::string::npos || help.find("??") != std::string::npos) {
    throw InputError(field, 0, in_quotes(shortened(help)),
                     "a sentence of at most " + std::to_string(longest_help) + " characters without \" \\ @");
  }
}

void check_value_name(const std::string& name, const AlgorithmForm& form, const std::string& field,
                      std::set<std::string>& names) {
  if (!is_word(name, longest_value_name)) {
    throw InputError(field, 0, in_quotes(name), "a letter, then letters, digits and single _");
  }
  if ((is_reserved(name) && !is_parameter_of_example(name)) ||
      std::ranges::find(used_by_source, name) != used_by_source.end() || name == form.name) {
    throw InputError(field, 0, in_quotes(name), "a name that C++ or the source does not use");
  }
  if (!names.insert(name).second) {
    throw InputError(field, 0, "another one with the name " + in_quotes(name), "different names");
  }
}

std::int32_t checked_value(const std::string& text, Unit unit, bool is_maximum, const std::string& field) {
  const std::optional<std::int32_t> value = form_value(text, unit, is_maximum);
  if (!value) {
    throw InputError(field, 0, in_quotes(text),
                     std::string("a number in ") +
                         (scale_of(unit).symbol[0] == '\0' ? "whole steps" : scale_of(unit).symbol) +
                         " that the unit has");
  }
  return *value;
}

void check_parameter(const FormParameter& parameter, const std::string& field) {
  const std::int32_t minimum = checked_value(parameter.minimum, parameter.unit, false, field + "minimum");
  const std::int32_t maximum = checked_value(parameter.maximum, parameter.unit, true, field + "maximum");
  const std::int32_t usual = checked_value(parameter.usual, parameter.unit, false, field + "default");
  if (maximum < minimum) {
    throw InputError(field + "maximum", 0, parameter.maximum, "at least the lowest value, " + parameter.minimum);
  }
  if (usual < minimum || usual > maximum) {
    throw InputError(field + "default", 0, parameter.usual, parameter.minimum + " to " + parameter.maximum);
  }
  check_help(parameter.help, field + "help");
}

}  // namespace

AlgorithmForm example_form(const std::string& name, std::uint8_t id) {
  return {name,
          id,
          "a sine with a second harmonic",
          {form_of(generator_parameters::amplitude),
           form_of(generator_parameters::frequency),
           form_of(generator_parameters::phase_difference),
           {"steepness", Unit::ratio, "0", "0.25", "1",
            "How much faster the wave falls than it rises. Share of the second harmonic."}},
          {},
          false};
}

bool is_wave(const AlgorithmForm& form) {
  return find(form, "amplitude", Unit::degree) != nullptr && find(form, "frequency", Unit::hertz) != nullptr &&
         find(form, "phase_difference", Unit::phase_degree) != nullptr;
}

bool has_harmonic(const AlgorithmForm& form) {
  return is_wave(form) && find(form, "steepness", Unit::ratio) != nullptr;
}

bool has_values_of_example(const AlgorithmForm& form) {
  const AlgorithmForm example = example_form(form.name, form.id);
  return form.values.empty() && !form.senses_touch &&
         std::ranges::equal(form.parameters, example.parameters, [](const FormParameter& a, const FormParameter& b) {
           return a.name == b.name && a.unit == b.unit &&
                  form_value(a.minimum, a.unit) == form_value(b.minimum, b.unit) &&
                  form_value(a.usual, a.unit) == form_value(b.usual, b.unit) &&
                  form_value(a.maximum, a.unit, true) == form_value(b.maximum, b.unit, true);
         });
}

std::optional<std::int32_t> form_value(const std::string& text, Unit unit, bool is_maximum) {
  const DecimalResult result = parse_decimal(text, unit);
  if (result.error != DecimalError::none) {
    return std::nullopt;
  }
  return wraps(unit) && is_maximum && result.raw == phase_minimum ? phase_maximum : result.raw;
}

void check_algorithm_name(const std::string& name, std::size_t longest, const std::string& field) {
  if (!is_word(name, longest) || name.ends_with("_test")) {
    throw InputError(field, 0, in_quotes(name),
                     "a letter, then up to " + std::to_string(longest - 1) +
                         " letters, digits and single _, that does not end in _test");
  }
  if (is_reserved(name)) {
    throw InputError(field, 0, in_quotes(name), "a name that C++ or the example does not use");
  }
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const Declaration& known = algorithm_at(i).declaration();
    if (lower_case(known.name) == lower_case(name)) {
      throw InputError(field, 0,
                       in_quotes(name) + (is_user_algorithm(known.id) ? ", a loaded" : ", a built-in") + " algorithm",
                       "another name");
    }
  }
}

void check_form(const AlgorithmForm& form) {
  check_algorithm_name(form.name, longest_form_name, "name");
  if (!is_user_algorithm(form.id)) {
    throw InputError("id", 0, std::to_string(form.id),
                     std::to_string(first_user_id) + " to " + std::to_string(last_user_id));
  }
  if (const ActuationModule* const same = find_algorithm(form.id)) {
    throw InputError("id", 0, std::to_string(form.id) + ", that of " + in_quotes(same->declaration().name),
                     "a free one");
  }
  check_help(form.help, "help");
  if (form.parameters.empty() || form.parameters.size() > max_parameters) {
    throw InputError("parameters", 0, std::to_string(form.parameters.size()), "1 to " + std::to_string(max_parameters));
  }
  const std::size_t most_values = max_internal_values - (is_wave(form) ? values_of_wave : 0);
  if (form.values.size() > most_values) {
    throw InputError("values", 0, std::to_string(form.values.size()), "at most " + std::to_string(most_values));
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < form.parameters.size(); ++i) {
    const std::string field = "parameters." + std::to_string(i) + '.';
    check_value_name(form.parameters[i].name, form, field + "name", names);
    check_parameter(form.parameters[i], field);
  }
  for (std::size_t i = 0; i < form.values.size(); ++i) {
    const std::string field = "values." + std::to_string(i) + '.';
    check_value_name(form.values[i].name, form, field + "name", names);
    check_help(form.values[i].help, field + "help");
  }
}

std::uint8_t usual_id(const std::string& name) {
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(name.data()), name.size());
  return static_cast<std::uint8_t>(first_user_id + crc32(bytes) % max_user_algorithms);
}

}  // namespace proleg::tools
