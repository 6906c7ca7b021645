#include "host/server/client_message.hpp"

#include <algorithm>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

using nlohmann::json;

constexpr int max_levels = 16;
constexpr std::size_t max_name_characters = 60;
constexpr std::size_t max_signals = 64;
constexpr std::uint64_t max_number = (std::uint64_t{1} << 53U) - 1;

[[noreturn]] void reject(const std::string& found, const std::string& expected) {
  throw InputError("message", 0, found, expected);
}

std::string found_text(const json& value) {
  // A long value is not written out in full.
  if (value.is_object()) {
    return "an object";
  }
  return value.is_array() ? "an array" : shortened(value.dump(), 40);
}

const json& field(const json& message, const char* name) {
  const auto found = message.find(name);
  if (found == message.end()) {
    reject("no field '" + std::string(name) + "'", "one");
  }
  return *found;
}

std::string text_field(const json& message, const char* name) {
  const json& value = field(message, name);
  if (!value.is_string()) {
    reject(found_text(value), "a text in '" + std::string(name) + "'");
  }
  return value.get<std::string>();
}

std::uint64_t number_in(const json& value, const char* name) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > max_number) {
    reject(found_text(value), "a whole number from 0 to 2^53 - 1 in '" + std::string(name) + "'");
  }
  return value.get<std::uint64_t>();
}

/// False if the field is missing.
bool flag(const json& message, const char* name) {
  const auto found = message.find(name);
  if (found == message.end()) {
    return false;
  }
  if (!found->is_boolean()) {
    reject(found_text(*found), "true or false as '" + std::string(name) + "'");
  }
  return found->get<bool>();
}

std::string viewer_name(const json& message) {
  std::string name = text_field(message, "name");
  std::size_t characters = 0;
  for (std::size_t position = 0; position < name.size(); ++characters) {
    position += utf8_character_size(std::string_view(name).substr(position));  // the parser accepts only UTF-8
  }
  if (characters == 0 || characters > max_name_characters || !is_visible_line(name)) {
    reject("the name " + in_quotes(one_line(name)), "1 to 60 characters that a person sees, in one line");
  }
  return name;
}

Hello hello(const json& message) {
  Hello result;
  result.protocol = number_in(field(message, "protocol"), "protocol");
  result.token = text_field(message, "token");
  result.name = viewer_name(message);
  const auto only = message.find("only");
  if (only != message.end() && *only != "stop") {
    reject(found_text(*only), "'only' missing or \"stop\"");
  }
  result.is_only_stop = only != message.end();
  result.wants_control = flag(message, "wants_control");
  return result;
}

Operation operation(const json& message) {
  Operation result;
  result.id = number_in(field(message, "id"), "id");
  const auto epoch = message.find("epoch");
  result.epoch = epoch == message.end() ? 0 : number_in(*epoch, "epoch");
  result.name = text_field(message, "name");
  const auto arguments = message.find("arguments");
  result.arguments = arguments == message.end() ? json::object() : *arguments;
  if (!result.arguments.is_object()) {
    reject(found_text(result.arguments), "an object in 'arguments'");
  }
  return result;
}

Beat beat(const json& message) {
  const json& age = field(message, "age_ms");
  if (!age.is_number() || age.get<double>() < 0) {
    reject(found_text(age), "a number of at least 0 in 'age_ms'");
  }
  return {age.get<double>()};
}

Subscribe subscribe(const json& message) {
  Subscribe result;
  const json& signals = field(message, "signals");
  if (!signals.is_array() || signals.size() > max_signals) {
    reject("no such list", "at most 64 names in 'signals'");
  }
  for (const json& name : signals) {
    if (!name.is_string()) {
      reject(found_text(name), "a text in 'signals'");
    }
    // The size of a row has a bound only if no signal is in it twice.
    if (std::find(result.signals.begin(), result.signals.end(), name) != result.signals.end()) {
      reject(found_text(name) + " twice", "different names in 'signals'");
    }
    result.signals.push_back(name.get<std::string>());
  }
  const auto hash = message.find("hash");
  if (hash != message.end()) {
    result.hash = number_in(*hash, "hash");
  }
  result.newest = flag(message, "newest");
  return result;
}

json parse(std::string_view text) {
  try {
    return json::parse(text, [](int levels_around, json::parse_event_t event, const json&) {
      const bool begins = event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
      if (begins && levels_around >= max_levels) {
        reject("more than 16 levels", "at most 16");
      }
      return true;
    });
  } catch (const json::out_of_range&) {
    reject("a number that is too large", "numbers of 64 bits (IEEE 754)");
  } catch (const json::exception&) {
    reject("text that is not JSON", "an object in JSON");
  }
}

}  // namespace

ClientMessage parse_client_message(std::string_view text) {
  const json message = parse(text);
  if (!message.is_object()) {
    reject(found_text(message), "an object");
  }
  const std::string type = text_field(message, "type");
  if (type == "hello") {
    return hello(message);
  }
  if (type == "operation") {
    return operation(message);
  }
  if (type == "stop") {
    return Stop{};
  }
  if (type == "beat") {
    return beat(message);
  }
  if (type == "subscribe") {
    return subscribe(message);
  }
  reject("type " + in_quotes(type), "hello, operation, stop, beat or subscribe");
}

}  // namespace proleg::host
