#include "host/remote/binding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

using nlohmann::json;

constexpr std::array<std::pair<RemoteAction, std::string_view>, 6> actions{
    {{RemoteAction::run, "run"},
     {RemoteAction::pause, "pause"},
     {RemoteAction::step, "step"},
     {RemoteAction::restart, "restart"},
     {RemoteAction::stop, "stop"},
     {RemoteAction::hold_to_run, "hold_to_run"}}};

constexpr int version = 1;
constexpr std::size_t max_parameters = 16;
constexpr std::size_t max_text = 200;

std::string found_text(const json& value) {
  if (value.is_object()) {
    return "an object";
  }
  return value.is_array() ? "a list" : shortened(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

/// A JSON object whose fields are read one by one; an unknown field is an error.
class Fields {
 public:
  Fields(const json& object, std::string where, std::initializer_list<const char*> known)
      : object_(object), where_(std::move(where)) {
    if (!object.is_object()) {
      refuse(found_text(object), "an object");
    }
    const std::vector<std::string> names(known.begin(), known.end());
    for (const auto& [name, value] : object.items()) {
      if (std::ranges::find(names, name) == names.end()) {
        refuse("field " + in_quotes(name), "some of " + listed(names));
      }
    }
  }

  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const {
    throw InputError(where_, 0, found, expected);
  }
  [[nodiscard]] bool has(const char* name) const { return object_.contains(name); }
  [[nodiscard]] const json& at(const char* name) const {
    if (!has(name)) {
      refuse("no field '" + std::string(name) + "'", "one");
    }
    return object_[name];
  }
  [[nodiscard]] std::string text(const char* name, const json& value) const {
    if (!value.is_string() || value.get_ref<const std::string&>().empty() ||
        value.get_ref<const std::string&>().size() > max_text) {
      refuse(found_text(value), "1 to " + std::to_string(max_text) + " bytes of text in '" + name + "'");
    }
    return value.get<std::string>();
  }
  [[nodiscard]] std::string text(const char* name) const { return text(name, at(name)); }
  [[nodiscard]] double number(const char* name) const {
    const json& value = at(name);
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      refuse(found_text(value), "a number in '" + std::string(name) + "'");
    }
    return value.get<double>();
  }
  [[nodiscard]] double number(const char* name, double without, double least, double most) const {
    const double value = has(name) ? number(name) : without;
    if (value < least || value > most) {
      refuse(found_text(at(name)), number_text(least) + " to " + number_text(most) + " in '" + name + "'");
    }
    return value;
  }

 private:
  const json& object_;
  std::string where_;
};

RemoteAction read_action(const Fields& fields) {
  const std::string name = fields.text("action");
  const std::optional<RemoteAction> action = action_of(name);
  if (!action) {
    fields.refuse("action " + in_quotes(name), "run, pause, step, restart, stop or hold_to_run");
  }
  return *action;
}

std::vector<std::string> read_parameters(const Fields& fields) {
  const json& list = fields.at("parameters");
  if (!list.is_array() || list.empty() || list.size() > max_parameters) {
    fields.refuse(list.is_array() ? std::to_string(list.size()) + " parameters" : found_text(list),
                  "a list of 1 to " + std::to_string(max_parameters) + " names in 'parameters'");
  }
  std::vector<std::string> names;
  for (const json& value : list) {
    std::string name = fields.text("parameters", value);
    if (name.find_first_of("=@") != std::string::npos) {
      fields.refuse(in_quotes(name), "a name such as 1.amplitude:J2, without a value");
    }
    if (std::ranges::find(names, name) != names.end()) {
      fields.refuse(in_quotes(name) + " twice", "different names");
    }
    names.push_back(std::move(name));
  }
  return names;
}

ParameterBinding read_target(const Fields& fields) {
  ParameterBinding target;
  target.parameters = read_parameters(fields);
  if (fields.has("method") && fields.text("method") != "linear") {
    fields.refuse("method " + in_quotes(fields.text("method")), "linear");
  }
  target.lower = fields.number("lower");
  target.upper = fields.number("upper");
  target.step = fields.number("step");
  if (target.lower == target.upper) {
    fields.refuse("'lower' and 'upper' both " + number_text(target.lower), "different limits");
  }
  const double range = std::abs(target.upper - target.lower);
  if (!std::isfinite(range) || !(target.step > 0) || target.step > range || range / target.step > 1e9) {
    fields.refuse("step " + number_text(target.step),
                  "one above 0, at most the range from 'lower' to 'upper', and at "
                  "least a thousand millionth of it");
  }
  target.dead_zone = fields.number("dead_zone", 0, 0, 0.9);
  target.curve = fields.number("curve", 1, 0.2, 5);
  if (fields.has("take_up")) {
    const json& take_up = fields.at("take_up");
    if (!take_up.is_boolean()) {
      fields.refuse(found_text(take_up), "true or false in 'take_up'");
    }
    target.take_up = take_up.get<bool>();
  }
  return target;
}

json parse(std::string_view text, const std::string& file) {
  if (text.size() > max_binding_file_bytes) {
    throw InputError(file, 0, std::to_string(text.size()) + " bytes", "at most 1 MiB");
  }
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte > 0 ? error.byte - 1 : 0);
    const auto line = 1 + std::ranges::count(before, '\n');
    throw InputError(file, static_cast<int>(line), "text that is not JSON", "an object in JSON");
  } catch (const json::exception&) {
    throw InputError(file, 0, "a number that is too large", "an object in JSON");
  }
}

/// The text of a file; nothing if there is no such file.
std::optional<std::string> file_text(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return std::nullopt;
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(path.string(), 0, "no ordinary file", "bindings of a remote control");
  }
  std::ifstream file(path, std::ios::binary);
  std::string text(max_binding_file_bytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad()) {
    throw FileError(path, "cannot be read");
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

}  // namespace

std::string_view name_of(RemoteAction action) {
  for (const auto& [known, name] : actions) {
    if (known == action) {
      return name;
    }
  }
  return {};
}

std::optional<RemoteAction> action_of(std::string_view name) {
  for (const auto& [action, known] : actions) {
    if (known == name) {
      return action;
    }
  }
  return std::nullopt;
}

Binding read_binding(const json& value, const std::string& where) {
  const bool is_action = value.is_object() && value.contains("action");
  const Fields fields = is_action ? Fields(value, where, {"device", "element", "action"})
                                  : Fields(value, where,
                                           {"device", "element", "action", "parameters", "method", "lower", "upper",
                                            "step", "dead_zone", "curve", "take_up"});
  Binding binding{fields.text("device"), fields.text("element"), {}};
  if (is_action) {
    binding.target = read_action(fields);
  } else {
    binding.target = read_target(fields);
  }
  return binding;
}

json binding_json(const Binding& binding) {
  json value{{"device", binding.device}, {"element", binding.element}};
  if (const auto* const action = std::get_if<RemoteAction>(&binding.target)) {
    value["action"] = name_of(*action);
    return value;
  }
  const auto& target = std::get<ParameterBinding>(binding.target);
  value.update({{"parameters", target.parameters},
                {"method", "linear"},
                {"lower", target.lower},
                {"upper", target.upper},
                {"step", target.step},
                {"dead_zone", target.dead_zone},
                {"curve", target.curve},
                {"take_up", target.take_up}});
  return value;
}

std::vector<Binding> read_bindings(std::string_view text, const std::string& file) {
  const json document = parse(text, file);
  const Fields fields(document, file, {"version", "bindings"});
  if (fields.at("version") != version) {
    fields.refuse("version " + found_text(fields.at("version")), "1");
  }
  const json& list = fields.at("bindings");
  if (!list.is_array() || list.size() > max_bindings) {
    fields.refuse(list.is_array() ? std::to_string(list.size()) + " bindings" : found_text(list),
                  "a list of at most " + std::to_string(max_bindings) + " in 'bindings'");
  }
  std::vector<Binding> bindings;
  bindings.reserve(list.size());
  for (const json& value : list) {
    bindings.push_back(read_binding(value, file + ": binding " + std::to_string(bindings.size() + 1)));
  }
  return bindings;
}

std::string bindings_text(const std::vector<Binding>& bindings) {
  json list = json::array();
  for (const Binding& binding : bindings) {
    list.push_back(binding_json(binding));
  }
  return json{{"version", version}, {"bindings", std::move(list)}}.dump(2) + '\n';
}

std::filesystem::path binding_file_of(const std::filesystem::path& scenario) {
  constexpr std::string_view ending = ".simulation.xml";
  std::string name = scenario.filename().string();
  if (name.ends_with(ending)) {
    name.resize(name.size() - ending.size());
  }
  return scenario.parent_path() / (name + ".remote.json");
}

BindingStore::BindingStore(const std::filesystem::path& path) : path_(path), text_(file_text(path)) {
  if (text_) {
    bindings_ = host::read_bindings(*text_, path.string());
  }
}

bool BindingStore::has(const std::vector<Binding>& bindings) const {
  return bindings_text(bindings) == (text_ ? bindings_text(bindings_) : bindings_text({}));
}

void BindingStore::save(const std::vector<Binding>& bindings) {
  if (path_.empty()) {
    throw std::runtime_error("there is no scenario file beside which bindings can be saved: start `proleg ui FILE`");
  }
  if (file_text(path_) != text_) {
    throw std::runtime_error(path_.string() + ": somebody has changed the file meanwhile; nothing was written");
  }
  const std::string text = bindings_text(bindings);
  write_file(path_, text);
  text_ = text;
  bindings_ = bindings;
}

}  // namespace proleg::host
