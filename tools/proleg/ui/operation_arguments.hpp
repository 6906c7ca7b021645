#pragma once

#include <nlohmann/json.hpp>
#include <optional>

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

}  // namespace proleg::tools
