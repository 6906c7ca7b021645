#pragma once

#include <string>

namespace proleg {

/// The text of the error that a call throws; empty if it throws none of that kind.
template <typename Error, typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace proleg
