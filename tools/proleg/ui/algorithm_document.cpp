#include "tools/proleg/ui/algorithm_document.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

struct NamedUnit {
  std::string_view name;
  Unit unit;
};
constexpr std::array named_units{NamedUnit{"degree", Unit::degree}, NamedUnit{"phase_degree", Unit::phase_degree},
                                 NamedUnit{"hertz", Unit::hertz},   NamedUnit{"per_second", Unit::per_second},
                                 NamedUnit{"ratio", Unit::ratio},   NamedUnit{"count", Unit::count}};

constexpr std::string_view name_of(Unit unit) {
  for (const NamedUnit& named : named_units) {
    if (named.unit == unit) {
      return named.name;
    }
  }
  return "count";
}
/// A member that is a text.
std::string text_of(const json& object, const char* name, const std::string& field) {
  constexpr std::size_t longest = 1000;
  const auto found = object.find(name);
  if (found == object.end() || !found->is_string() || found->get_ref<const std::string&>().size() > longest) {
    throw InputError(field + name, 0, found == object.end() ? "nothing" : shortened(found->dump()), "a text");
  }
  return found->get<std::string>();
}

Unit unit_of(const json& object, const std::string& field) {
  const std::string word = text_of(object, "unit", field);
  std::vector<std::string> names;
  for (const NamedUnit& named : named_units) {
    if (named.name == word) {
      return named.unit;
    }
    names.emplace_back(named.name);
  }
  throw InputError(field + "unit", 0, in_quotes(shortened(word)), "one of " + listed(names));
}

/// A list of objects, or nothing.
const json& list_of(const json& arguments, const char* name) {
  static const json none = json::array();
  constexpr std::size_t most = 64;
  const auto found = arguments.find(name);
  if (found == arguments.end()) {
    return none;
  }
  const bool is_list = found->is_array() && found->size() <= most;
  for (std::size_t i = 0; is_list && i < found->size(); ++i) {
    if (!(*found)[i].is_object()) {
      throw InputError(std::string(name) + '.' + std::to_string(i), 0, shortened((*found)[i].dump()), "an object");
    }
  }
  if (!is_list) {
    throw InputError(name, 0, shortened(found->dump()), "a list");
  }
  return *found;
}

const char* name_of(CompilerMessage::Severity severity) {
  switch (severity) {
    case CompilerMessage::Severity::error:
      return "error";
    case CompilerMessage::Severity::warning:
      return "warning";
    case CompilerMessage::Severity::note:
      break;
  }
  return "note";
}

/// A file of the algorithm by its name; others as they are.
std::string shown_file(const std::string& file, std::span<const AlgorithmFolder> algorithms) {
  const std::filesystem::path path(file);
  const bool is_own = std::ranges::any_of(
      algorithms, [&path](const AlgorithmFolder& algorithm) { return path.parent_path() == algorithm.path; });
  return is_own ? path.filename().string() : file;
}

}  // namespace

json algorithms_json() {
  json algorithms = json::array();
  const std::size_t count = algorithm_count();
  for (std::size_t i = 0; i < count; ++i) {
    const Declaration& declaration = algorithm_at(i).declaration();
    json parameters = json::array();
    for (const Parameter& parameter : declaration.parameters) {
      parameters.push_back(parameter_declaration_json(parameter));
    }
    algorithms.push_back({{"name", std::string(declaration.name)},
                          {"id", declaration.id},
                          {"help", one_line(std::string_view(declaration.help))},
                          {"own", is_user_algorithm(declaration.id)},
                          {"touch", algorithm_at(i).senses_contacts()},
                          {"broadcasts", !declaration.frame.empty()},
                          {"parameters", std::move(parameters)}});
  }
  return algorithms;
}

json example_form_json() {
  std::uint8_t id = first_user_id;
  while (id < last_user_id && find_algorithm(id) != nullptr) {
    ++id;
  }
  const AlgorithmForm form = example_form("", id);
  json parameters = json::array();
  for (const FormParameter& parameter : form.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"unit", std::string(name_of(parameter.unit))},
                          {"minimum", parameter.minimum},
                          {"default", parameter.usual},
                          {"maximum", parameter.maximum},
                          {"help", parameter.help}});
  }
  return {{"name", form.name},       {"id", form.id},
          {"help", form.help},       {"parameters", std::move(parameters)},
          {"values", json::array()}, {"touch", form.senses_touch}};
}

AlgorithmForm read_form(const json& arguments) {
  AlgorithmForm form;
  form.name = text_of(arguments, "name", "");
  const auto id = argument<std::uint32_t>(arguments, "id", "96 to 126");
  if (!id || *id < first_user_id || *id > last_user_id) {
    throw InputError("id", 0, id ? std::to_string(*id) : "nothing",
                     std::to_string(first_user_id) + " to " + std::to_string(last_user_id));
  }
  form.id = static_cast<std::uint8_t>(*id);
  form.help = text_of(arguments, "help", "");
  const json& parameters = list_of(arguments, "parameters");
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const json& from = parameters[i];
    const std::string field = "parameters." + std::to_string(i) + '.';
    form.parameters.push_back({text_of(from, "name", field), unit_of(from, field), text_of(from, "minimum", field),
                               text_of(from, "default", field), text_of(from, "maximum", field),
                               text_of(from, "help", field)});
  }
  const json& values = list_of(arguments, "values");
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string field = "values." + std::to_string(i) + '.';
    form.values.push_back(
        {text_of(values[i], "name", field), unit_of(values[i], field), text_of(values[i], "help", field)});
  }
  form.senses_touch = argument<bool>(arguments, "touch", "true or false").value_or(false);
  return form;
}

json messages_json(std::span<const CompilerMessage> messages, std::span<const AlgorithmFolder> algorithms) {
  json list = json::array();
  for (const CompilerMessage& message : messages) {
    list.push_back({{"file", shown_file(message.file, algorithms)},
                    {"line", message.line},
                    {"column", message.column},
                    {"severity", name_of(message.severity)},
                    {"text", message.text}});
  }
  return list;
}

}  // namespace proleg::tools
