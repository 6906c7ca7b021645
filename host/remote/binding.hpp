#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace proleg::host {

/// What an element that is pressed can do, beside changing parameters.
enum class RemoteAction : std::uint8_t {
  run,
  pause,
  step,
  restart,
  stop,         ///< stops the robot, also without control
  hold_to_run,  ///< runs while it is pressed, and pauses when it is released
};

/// The name of an action in files, for example "hold_to_run".
[[nodiscard]] std::string_view name_of(RemoteAction action);
[[nodiscard]] std::optional<RemoteAction> action_of(std::string_view name);

/// Maps the position of an element linearly: from one end to the other it is a value from `lower` to `upper`.
struct ParameterBinding {
  std::vector<std::string> parameters;  ///< names as for --set, without a value: "amplitude", "1.amplitude:J2"
  double lower = 0;                     ///< value at position -1 (of a button: 0)
  double upper = 0;                     ///< value at position 1; below `lower`: the direction is reversed
  double step = 0;                      ///< values are whole steps from `lower`, and `upper`
  double dead_zone = 0;                 ///< positions of an axis this near the middle are the middle; 0 to 0.9
  double curve = 1;                     ///< exponent: above 1 it is finer in the middle; 0.2 to 5
  bool take_up = true;  ///< the element has no effect until it has passed the present value, so that nothing jumps
};

struct Binding {
  std::string device;  ///< name of the device; all devices of this name act alike
  std::string element;
  std::variant<ParameterBinding, RemoteAction> target;
};

}  // namespace proleg::host
