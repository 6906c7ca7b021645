#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

/// An argument of an operation, or nothing. Throws InputError if it has another type. expected: for the message.
template <typename Value>
std::optional<Value> argument(const nlohmann::json& arguments, const char* name, const char* expected) {
  const auto found = arguments.find(name);
  if (found == arguments.end() || found->is_null()) {
    return std::nullopt;
  }
  try {
    return found->get<Value>();
  } catch (const nlohmann::json::exception&) {
    throw InputError(name, 0, shortened(found->dump()), expected);
  }
}

/// A whole number from 0 to 2^32 - 1. Nothing is converted or cut: -1 and 2.5 are errors, too.
inline std::optional<std::uint32_t> whole_argument(const nlohmann::json& arguments, const char* name,
                                                   const char* expected) {
  const auto found = arguments.find(name);
  if (found == arguments.end() || found->is_null()) {
    return std::nullopt;
  }
  const bool is_natural =
      found->is_number_unsigned() || (found->is_number_integer() && found->get<std::int64_t>() >= 0);
  if (!is_natural || found->get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(name, 0, shortened(found->dump()), expected);
  }
  return found->get<std::uint32_t>();
}

/// The names of the operation `reset`; nothing: all parameters. Throws InputError.
inline std::optional<std::vector<std::string>> parameter_names(const nlohmann::json& arguments) {
  return argument<std::vector<std::string>>(arguments, "names", "names such as \"1.amplitude:J2\"");
}

/// What carries an operation out. Throws InputError, which names all operations, if there is no such one.
template <typename Handler>
const Handler& handler_of(const std::map<std::string_view, Handler>& handlers, const std::string& operation) {
  const auto handler = handlers.find(operation);
  if (handler != handlers.end()) {
    return handler->second;
  }
  std::vector<std::string> names;
  names.reserve(handlers.size());
  for (const auto& [name, function] : handlers) {
    names.emplace_back(name);
  }
  throw InputError("operation", 0, in_quotes(shortened(operation)), "one of " + listed(names));
}

}  // namespace proleg::tools
