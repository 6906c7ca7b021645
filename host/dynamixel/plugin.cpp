#include "host/dynamixel/plugin.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <sstream>
#include <string_view>
#include <utility>

#include "host/dynamixel/chain_settings.hpp"
#include "host/dynamixel/line.hpp"
#include "host/dynamixel/servo_chain.hpp"

using proleg::host::ChainSettings;
using proleg::host::Line;
using proleg::host::ServoChain;

/// A robot whose servos are on one line. The chain exists while it is connected.
struct proleg_robot {
  ChainSettings settings;
  void (*show)(void* context, const char* line);
  void* context;
  std::unique_ptr<Line> line;
  std::unique_ptr<ServoChain> chain;
};

namespace proleg::host {
namespace {

LineMaker& line_maker() {
  static LineMaker maker = [](const std::string& device, unsigned rate) {
    return std::make_unique<SerialLine>(device, rate);
  };
  return maker;
}

void set_error(proleg_error* error, const char* text, std::uint32_t line = 0) {
  error->line = line;
  std::strncpy(error->text, text, sizeof error->text - 1);
  error->text[sizeof error->text - 1] = '\0';
}

/// Runs an action so that no exception leaves the plug-in.
template <typename Action>
int guarded(proleg_error* error, const Action& action) {
  try {
    return action();
  } catch (const SettingError& failure) {
    set_error(error, failure.what(), failure.line());
  } catch (const std::exception& failure) {
    set_error(error, failure.what());
  } catch (...) {
    set_error(error, "the plug-in failed for an unknown reason");
  }
  return PROLEG_FAILED;
}

/// Runs an action that requires a connected robot, with its deadline.
template <typename Action>
int guarded_on(proleg_robot* robot, std::uint32_t timeout_us, proleg_error* error, const Action& action) {
  return guarded(error, [&] {
    if (!robot->chain || !robot->chain->is_connected()) {
      set_error(error, "the robot is not connected");
      return PROLEG_FAILED;
    }
    return action(*robot->chain, robot->line->now_us() + timeout_us);
  });
}

int open_robot(const proleg_setup* setup, proleg_robot** robot, proleg_error* error) {
  return guarded(error, [&] {
    auto made = std::make_unique<proleg_robot>(
        proleg_robot{read_chain_settings(*setup), setup->show, setup->context, nullptr, nullptr});
    *robot = made.release();
    return PROLEG_OK;
  });
}

void close_robot(proleg_robot* robot) { delete robot; }

int describe(proleg_robot* robot, proleg_description* description, proleg_error* /*error*/) {
  const auto& servos = robot->settings.servos;
  description->joint_count = static_cast<std::uint32_t>(servos.size());
  description->sensor_module_count = 0;
  description->sensors_per_module = 0;
  std::strncpy(description->topology, "chain", sizeof description->topology);
  for (std::size_t joint = 0; joint < servos.size(); ++joint) {
    description->lower_limit_deg[joint] = servos[joint].lower_limit_deg;
    description->upper_limit_deg[joint] = servos[joint].upper_limit_deg;
  }
  return PROLEG_OK;
}

int connect_robot(proleg_robot* robot, std::uint32_t timeout_us, proleg_error* error) {
  return guarded(error, [&] {
    robot->chain.reset();
    robot->line.reset();  // the port is closed before it is opened again
    robot->line = line_maker()(robot->settings.device, robot->settings.rate);
    robot->chain = std::make_unique<ServoChain>(
        *robot->line, robot->settings, [robot](const std::string& text) { robot->show(robot->context, text.c_str()); });
    robot->chain->connect(robot->line->now_us() + timeout_us);
    return PROLEG_OK;
  });
}

void disconnect_robot(proleg_robot* robot, std::uint32_t timeout_us) {
  proleg_error ignored{};
  static_cast<void>(guarded_on(robot, timeout_us, &ignored, [](ServoChain& chain, std::uint64_t deadline_us) {
    chain.switch_off(deadline_us);
    return PROLEG_OK;
  }));
  robot->chain.reset();
  robot->line.reset();
}

int enable_servos(proleg_robot* robot, int on, std::uint32_t timeout_us, proleg_error* error) {
  return guarded_on(robot, timeout_us, error, [on](ServoChain& chain, std::uint64_t deadline_us) {
    if (on != 0) {
      chain.switch_on(deadline_us);
    } else {
      chain.switch_off(deadline_us);
    }
    return PROLEG_OK;
  });
}

int send_command(proleg_robot* robot, const char* command, const double* values, std::uint32_t count,
                 std::uint32_t destination, std::uint32_t timeout_us, proleg_error* error) {
  if (std::string_view(command) != "goal_position") {
    return PROLEG_UNSUPPORTED;
  }
  return guarded_on(robot, timeout_us, error, [&](ServoChain& chain, std::uint64_t deadline_us) {
    const std::span<const double> angles(values, count);
    const bool are_finite = std::ranges::all_of(angles, [](double angle) { return std::isfinite(angle); });
    if (destination != PROLEG_ALL_JOINTS || count != chain.settings().servos.size() || !are_finite) {
      set_error(error, "goal_position needs a finite angle for each joint");
      return PROLEG_FAILED;
    }
    chain.send_goals(angles, deadline_us);
    return PROLEG_OK;
  });
}

int send_command_by_value(proleg_robot* /*robot*/, const char* /*command*/, double /*value*/,
                          std::uint32_t /*timeout_us*/, proleg_error* /*error*/) {
  return PROLEG_UNSUPPORTED;
}

/// Writes a line of text for each joint: name, id, degrees, current, degrees Celsius.
int request_all_information(proleg_robot* robot, std::uint8_t* bytes, std::uint32_t capacity, std::uint32_t* count,
                            std::uint32_t timeout_us, proleg_error* error) {
  return guarded_on(robot, timeout_us, error, [&](ServoChain& chain, std::uint64_t /*deadline_us*/) {
    std::ostringstream lines;
    for (std::size_t joint = 0; joint < chain.readings().size(); ++joint) {
      const ServoSettings& servo = chain.settings().servos[joint];
      const ServoChain::Reading& reading = chain.readings()[joint];
      lines << servo.joint << '\t' << unsigned{servo.id} << '\t' << reading.angle_deg << '\t' << reading.current << '\t'
            << reading.temperature_c << '\n';
    }
    const std::string text = lines.str();
    *count = static_cast<std::uint32_t>(std::min<std::size_t>(text.size(), capacity));
    std::memcpy(bytes, text.data(), *count);
    return PROLEG_OK;
  });
}

int request_information(proleg_robot* robot, const char* kind, double* values, std::uint32_t capacity,
                        std::uint32_t* count, std::uint32_t timeout_us, proleg_error* error) {
  using Reading = ServoChain::Reading;
  const std::string_view name = kind;
  const double Reading::*const value = name == "position"      ? &Reading::angle_deg
                                       : name == "current"     ? &Reading::current
                                       : name == "temperature" ? &Reading::temperature_c
                                                               : nullptr;
  if (value == nullptr) {
    return PROLEG_UNSUPPORTED;
  }
  return guarded_on(robot, timeout_us, error, [&](ServoChain& chain, std::uint64_t /*deadline_us*/) {
    *count = 0;
    for (const Reading& reading : chain.readings()) {
      if (*count < capacity) {
        values[(*count)++] = reading.*value;
      }
    }
    return PROLEG_OK;
  });
}

int test_robot(proleg_robot* robot, std::uint32_t timeout_us, proleg_error* error) {
  return guarded_on(robot, timeout_us, error, [](ServoChain& chain, std::uint64_t deadline_us) {
    chain.test(deadline_us);
    return PROLEG_OK;
  });
}

int reset_command_buffer(proleg_robot* robot, proleg_error* error) {
  return guarded_on(robot, 0, error, [](ServoChain& chain, std::uint64_t /*deadline_us*/) {
    chain.discard_input();
    return PROLEG_OK;
  });
}

}  // namespace

const proleg_robot_control_plugin& dynamixel_plugin() {
  static constexpr proleg_robot_control_plugin plugin{PROLEG_ROBOT_CONTROL_ABI_VERSION,
                                                      sizeof(proleg_robot_control_plugin),
                                                      "dynamixel",
                                                      open_robot,
                                                      close_robot,
                                                      describe,
                                                      connect_robot,
                                                      disconnect_robot,
                                                      enable_servos,
                                                      send_command,
                                                      send_command_by_value,
                                                      request_all_information,
                                                      request_information,
                                                      test_robot,
                                                      reset_command_buffer};
  return plugin;
}

void use_lines_of(LineMaker make_line) { line_maker() = std::move(make_line); }

}  // namespace proleg::host
