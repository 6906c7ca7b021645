// This file defines the only symbol that the shared library exports.

#include "host/dynamixel/plugin.hpp"

extern "C" __attribute__((visibility("default"))) const proleg_robot_control_plugin* proleg_robot_control_plugin_v1() {
  return &proleg::host::dynamixel_plugin();
}
