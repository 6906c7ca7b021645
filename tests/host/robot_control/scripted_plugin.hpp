#pragma once

// A plug-in for tests that does what a test says, also what a plug-in must not do. One robot at a time.

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "host/robot_control/plugin_library.hpp"
#include "host/robot_control/robot_control.hpp"

namespace proleg::test {

struct PluginScript {
  // What describe() reports.
  std::uint32_t joints = 2;
  std::uint32_t sensor_modules = 0;
  std::uint32_t sensors_per_module = 0;
  std::string topology = "chain";
  double lower_deg = -90.0;
  double upper_deg = 90.0;

  int result = PROLEG_OK;  ///< of connect() and all later functions
  std::string error;       ///< written when the result is not PROLEG_OK
  std::uint32_t error_line = 0;
  bool opens_nothing = false;
  int open_result = PROLEG_OK;

  std::vector<double> values{0.0, 0.0};  ///< returned by request_information()
  std::uint32_t count = UINT32_MAX;      ///< what it says is their number; UINT32_MAX: the truth

  std::function<void(const std::string&)> on_call;  ///< before a function does anything

  // What happened.
  std::vector<std::string> calls;
  std::vector<std::vector<double>> goals;
  bool has_power = false;
};

inline PluginScript*& script() {
  static PluginScript* current = nullptr;
  return current;
}

inline int scripted_result(const std::string& call, proleg_error* error) {
  PluginScript& plugin = *script();
  if (plugin.on_call) {
    plugin.on_call(call);
  }
  plugin.calls.push_back(call);
  if (plugin.result != PROLEG_OK) {
    // Not bounded by a zero byte on purpose if the text is long.
    std::memcpy(error->text, plugin.error.data(), std::min(plugin.error.size(), sizeof error->text));
  }
  return plugin.result;
}

inline const proleg_robot_control_plugin& scripted_plugin() {
  static const proleg_robot_control_plugin plugin{
      PROLEG_ROBOT_CONTROL_ABI_VERSION,
      sizeof(proleg_robot_control_plugin),
      "scripted",
      [](const proleg_setup* setup, proleg_robot** robot, proleg_error* error) {
        setup->show(setup->context, "opened");
        if (script()->open_result != PROLEG_OK) {
          error->line = script()->error_line;
          std::memcpy(error->text, script()->error.c_str(), script()->error.size());
        } else if (!script()->opens_nothing) {
          *robot = reinterpret_cast<proleg_robot*>(script());
        }
        return script()->open_result;
      },
      [](proleg_robot*) { script()->calls.emplace_back("close"); },
      [](proleg_robot*, proleg_description* description, proleg_error*) {
        description->joint_count = script()->joints;
        description->sensor_module_count = script()->sensor_modules;
        description->sensors_per_module = script()->sensors_per_module;
        std::memcpy(description->topology, script()->topology.data(),
                    std::min(script()->topology.size(), sizeof description->topology));
        for (unsigned joint = 0; joint < PROLEG_MAX_JOINTS; ++joint) {
          description->lower_limit_deg[joint] = script()->lower_deg;
          description->upper_limit_deg[joint] = script()->upper_deg;
        }
        return PROLEG_OK;
      },
      [](proleg_robot*, std::uint32_t, proleg_error* error) { return scripted_result("connect", error); },
      [](proleg_robot*, std::uint32_t) {
        script()->calls.emplace_back("disconnect");
        script()->has_power = false;
      },
      [](proleg_robot*, int on, std::uint32_t, proleg_error* error) {
        script()->has_power = on != 0;
        return scripted_result(on != 0 ? "power on" : "power off", error);
      },
      [](proleg_robot*, const char* command, const double* values, std::uint32_t count, std::uint32_t, std::uint32_t,
         proleg_error* error) {
        script()->goals.emplace_back(values, values + count);
        return scripted_result(command, error);
      },
      [](proleg_robot*, const char* command, double, std::uint32_t, proleg_error* error) {
        return scripted_result(command, error);
      },
      [](proleg_robot*, std::uint8_t* bytes, std::uint32_t capacity, std::uint32_t* count, std::uint32_t,
         proleg_error* error) {
        std::memset(bytes, 'x', capacity);
        *count = script()->count;
        return scripted_result("all", error);
      },
      [](proleg_robot*, const char* kind, double* values, std::uint32_t capacity, std::uint32_t* count, std::uint32_t,
         proleg_error* error) {
        const std::vector<double>& known = script()->values;
        const std::size_t written = std::min<std::size_t>(capacity, known.size());
        std::copy_n(known.begin(), written, values);
        *count = script()->count == UINT32_MAX ? static_cast<std::uint32_t>(known.size()) : script()->count;
        return scripted_result(kind, error);
      },
      [](proleg_robot*, std::uint32_t, proleg_error* error) { return scripted_result("test", error); },
      [](proleg_robot*, proleg_error* error) { return scripted_result("reset", error); }};
  return plugin;
}

inline host::RobotControlSetup setup_of(unsigned joints) {
  host::RobotControlSetup setup;
  setup.file = "robot.xml";
  setup.line = 7;
  for (unsigned joint = 1; joint <= joints; ++joint) {
    setup.joints.push_back({"J" + std::to_string(joint)});
  }
  return setup;
}

inline host::Plugin plugin_of(PluginScript& used) {
  script() = &used;
  return host::check_plugin(&scripted_plugin(), "test");
}

}  // namespace proleg::test
