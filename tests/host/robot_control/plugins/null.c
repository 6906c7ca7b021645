/* A plug-in that returns nothing. */
#include "host/robot_control_abi/robot_control.h"

const proleg_robot_control_plugin* proleg_robot_control_plugin_v1(void) { return 0; }
