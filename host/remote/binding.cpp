#include "host/remote/binding.hpp"

#include <array>
#include <utility>

namespace proleg::host {
namespace {

constexpr std::array<std::pair<RemoteAction, std::string_view>, 6> actions{
    {{RemoteAction::run, "run"},
     {RemoteAction::pause, "pause"},
     {RemoteAction::step, "step"},
     {RemoteAction::restart, "restart"},
     {RemoteAction::stop, "stop"},
     {RemoteAction::hold_to_run, "hold_to_run"}}};

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

}  // namespace proleg::host
