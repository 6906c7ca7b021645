/* The interface of a plug-in that drives a robot without Proleg's firmware (thesis, appendix A.4: RobotControl).

   This header is all that a plug-in needs. It is plain C99, so that the binary interface does not depend on a compiler
   or on a version of Proleg. A plug-in is a shared library that exports one function:

       const proleg_robot_control_plugin* proleg_robot_control_plugin_v1(void);

   docs/robot-control.md shows a complete plug-in. Rules for all functions:

   - No exception, signal or longjmp may leave a function of the plug-in.
   - Strings are UTF-8, end with a zero byte, and belong to the caller unless stated otherwise. A callee copies what it
     needs after it returns.
   - All functions of one robot are called from one thread, one after the other. That thread is not the main thread.
   - Joints are numbered in the order of proleg_setup.joints: from 0, from the head to the tail. Angles are in degrees,
     0 is the middle position of the robot's file.
   - A function with a timeout returns before the timeout is over, also if the robot does not answer. If it does not
     return, Proleg gives the plug-in up: it calls none of its functions again and the program ends.
   - A function that fails writes one line without a line end to error->text: what was found, what was expected, and
   what a user can do. */

#ifndef PROLEG_ROBOT_CONTROL_H
#define PROLEG_ROBOT_CONTROL_H

#include <stdint.h> /* NOLINT(modernize-deprecated-headers): this header is C */

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this interface. A host loads only plug-ins with its own version. The version changes when the meaning or
   the layout of anything below changes; new functions at the end of a struct change only its size. */
#define PROLEG_ROBOT_CONTROL_ABI_VERSION 1u

/* Name of the exported function. */
#define PROLEG_ROBOT_CONTROL_ENTRY "proleg_robot_control_plugin_v1"

/* Destination of a command for the whole robot. */
#define PROLEG_ALL_JOINTS 0xFFFFFFFFu

/* A robot has 1 to this number of joints. */
#define PROLEG_MAX_JOINTS 64

/* Results. Any other value counts as PROLEG_FAILED. */
#define PROLEG_OK 0
#define PROLEG_FAILED 1      /* error->text says why */
#define PROLEG_UNSUPPORTED 2 /* the plug-in does not know this command or this kind of information */

/* One robot of a plug-in. The plug-in defines the struct. */
typedef struct proleg_robot proleg_robot;

typedef struct proleg_error {
  uint32_t line;  /* line of the robot's file that is wrong, from proleg_parameter.line; 0: none */
  char text[508]; /* one line; empty at the call */
} proleg_error;

/* A <parameter> of <robot_control> in the robot's file. */
typedef struct proleg_parameter {
  const char* name;
  const char* value;
  uint32_t joint; /* the joint that it is for, or PROLEG_ALL_JOINTS */
  uint32_t line;  /* in the robot's file */
} proleg_parameter;

/* A joint of the robot's file. */
typedef struct proleg_joint {
  const char* name;
  double lower_limit_deg; /* -90 to 0 */
  double upper_limit_deg; /* 0 to 90 */
  double max_speed_deg_s; /* of the joint's motor, above 0 */
} proleg_joint;

/* What the host knows of the robot. Valid until open() returns. */
typedef struct proleg_setup {
  uint32_t size;    /* sizeof(proleg_setup) of the host */
  uint32_t tick_us; /* a goal position is sent once in this time */
  uint32_t joint_count;
  uint32_t parameter_count;
  const proleg_joint* joints;
  const proleg_parameter* parameters;
  /* Shows a line to the user. May be called from open() to close(), from the thread that called the plug-in. */
  void (*show)(void* context, const char* line);
  void* context;
} proleg_setup;

/* What the plug-in knows of the robot. */
typedef struct proleg_description {
  uint32_t size;                             /* set by the host: sizeof(proleg_description) */
  uint32_t joint_count;                      /* must be that of proleg_setup */
  uint32_t sensor_module_count;              /* links with touch sensors: 0, or joint_count + 1 */
  uint32_t sensors_per_module;               /* touch sensors under a link: 0, or 2 (rear, front) */
  char topology[64];                         /* "chain" */
  double lower_limit_deg[PROLEG_MAX_JOINTS]; /* what the robot's joint can reach, -360 to 360; the host cuts goal */
  double upper_limit_deg[PROLEG_MAX_JOINTS]; /* positions to it and to the limits of the robot's file */
} proleg_description;

typedef struct proleg_robot_control_plugin {
  uint32_t abi_version; /* PROLEG_ROBOT_CONTROL_ABI_VERSION. This member is first in all versions */
  uint32_t size;        /* sizeof(proleg_robot_control_plugin) of the plug-in */
  const char* name;     /* of the plug-in, for messages */

  /* Makes the robot and checks all parameters. Sends nothing. Writes the robot to *robot if it succeeds. */
  int (*open)(const proleg_setup* setup, proleg_robot** robot, proleg_error* error);
  /* Frees the robot, which is disconnected. */
  void (*close)(proleg_robot* robot);
  int (*describe)(proleg_robot* robot, proleg_description* description, proleg_error* error);

  /* Finds all parts of the robot and reads the angles of all joints. Must not move the robot: the servos have no power
     when it returns. Fails if a part is missing. The robot can be connected again after disconnect(). */
  int (*connect)(proleg_robot* robot, uint32_t timeout_us, proleg_error* error);
  /* Takes the power from the servos, and leaves the robot. May be called in any state, also twice. */
  void (*disconnect)(proleg_robot* robot, uint32_t timeout_us);

  /* on != 0: the servos hold the angles that they have. 0: they have no power. */
  int (*enable_servos)(proleg_robot* robot, int on, uint32_t timeout_us, proleg_error* error);

  /* Sends a command. destination: a joint, or PROLEG_ALL_JOINTS. Every plug-in has the command "goal_position" for all
     joints: count is the number of joints, values are their angles in degrees. It is sent once a tick. If a servo has
     failed, it still sends the command to the others and then fails. */
  int (*send_command)(proleg_robot* robot, const char* command, const double* values, uint32_t count,
                      uint32_t destination, uint32_t timeout_us, proleg_error* error);
  /* Sends a command with one number for the whole robot. */
  int (*send_command_by_value)(proleg_robot* robot, const char* command, double value, uint32_t timeout_us,
                               proleg_error* error);

  /* Everything that the plug-in knows of the robot, in a format of its own. Writes at most `capacity` bytes, and their
     number to *count. */
  int (*request_all_information)(proleg_robot* robot, uint8_t* bytes, uint32_t capacity, uint32_t* count,
                                 uint32_t timeout_us, proleg_error* error);
  /* One kind of information, as numbers. Writes at most `capacity` values, and their number to *count. All values are
     finite. The host calls it in every tick, so it returns the values that were received last. Kinds:
       "position"     angle of each joint in degrees, -360 to 360; every plug-in has it from connect() on
       "current"      of each servo, mA
       "temperature"  of each servo, degrees Celsius
       "contact"      of each touch sensor, 0 or 1: rear then front, link by link from the head; only with sensors */
  int (*request_information)(proleg_robot* robot, const char* kind, double* values, uint32_t capacity, uint32_t* count,
                             uint32_t timeout_us, proleg_error* error);

  /* Checks that all parts of the connected robot answer. Moves nothing. */
  int (*test)(proleg_robot* robot, uint32_t timeout_us, proleg_error* error);
  /* Forgets commands that are not sent yet, and received bytes that are not read yet. */
  int (*reset_command_buffer)(proleg_robot* robot, proleg_error* error);
} proleg_robot_control_plugin;

/* The plug-in exports this function. The struct is constant while the library is loaded. */
const proleg_robot_control_plugin* proleg_robot_control_plugin_v1(void);

#ifdef __cplusplus
}
#endif

#endif
