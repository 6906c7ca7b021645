/* A plug-in of a later interface, whose other members may be anything. */
#include "host/robot_control_abi/robot_control.h"

static const unsigned later[2] = {PROLEG_ROBOT_CONTROL_ABI_VERSION + 1, 8};

const proleg_robot_control_plugin* proleg_robot_control_plugin_v1(void) {
  return (const proleg_robot_control_plugin*)(const void*)later;
}
