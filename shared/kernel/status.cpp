#include "shared/kernel/status.hpp"

namespace proleg {

std::string_view describe(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::bad_joint_count:
      return "a robot has 1 to 64 joints";
    case Status::bad_local_joints:
      return "the kernel has no room for these joints";
    case Status::bad_tick_period:
      return "a tick lasts 1 to 100 ms";
    case Status::bad_group:
      return "the slot drives a joint that the robot does not have";
    case Status::too_many_broadcasts:
      return "more than two broadcasting algorithms on one joint";
    case Status::bad_limits:
      return "lower limit above upper limit";
    case Status::unknown_slot:
      return "no such slot";
    case Status::unknown_joint:
      return "no such joint in the slot";
    case Status::unknown_parameter:
      return "no such parameter";
    case Status::unknown_internal_value:
      return "no such internal value";
    case Status::out_of_range:
      return "value out of range";
    case Status::staging_closed:
      return "the transaction is committed already";
    case Status::staging_full:
      return "too many changes wait for their tick";
    case Status::nothing_staged:
      return "the transaction was not staged";
    case Status::commit_in_the_past:
      return "the tick has passed";
  }
  return "unknown status";
}

}  // namespace proleg
