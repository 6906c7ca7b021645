#include "firmware/module/abort_code.hpp"

namespace proleg::firmware {

using canopen::AbortCode;

AbortCode abort_code_of(Status status) {
  switch (status) {
    case Status::ok:
      return AbortCode::none;
    case Status::bad_joint_count:
    case Status::bad_local_joints:
    case Status::bad_tick_period:
    case Status::bad_group:
    case Status::too_many_broadcasts:
      return AbortCode::refused_by_application;
    case Status::bad_limits:
      return AbortCode::general_incompatibility;
    case Status::unknown_slot:  // the sub-index is the slot
    case Status::unknown_joint:
      return AbortCode::no_such_sub_index;
    case Status::unknown_parameter:
    case Status::unknown_internal_value:
      return AbortCode::no_such_object;
    case Status::out_of_range:
      return AbortCode::out_of_range;
    case Status::staging_full:
      return AbortCode::out_of_memory;
    case Status::staging_closed:
    case Status::nothing_staged:
    case Status::commit_in_the_past:
      return AbortCode::refused_by_state;
  }
  return AbortCode::general_error;
}

}  // namespace proleg::firmware
