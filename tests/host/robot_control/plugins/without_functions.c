/* A plug-in whose functions are missing. */
#include "host/robot_control_abi/robot_control.h"

static const proleg_robot_control_plugin plugin = {
    .abi_version = PROLEG_ROBOT_CONTROL_ABI_VERSION, .size = sizeof(proleg_robot_control_plugin), .name = "empty"};

const proleg_robot_control_plugin* proleg_robot_control_plugin_v1(void) { return &plugin; }
