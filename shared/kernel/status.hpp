#pragma once

#include <cstdint>
#include <string_view>

namespace proleg {

/// What the control kernel answers to a request. Anything but `ok` leaves the kernel as it was.
enum class [[nodiscard]] Status : std::uint8_t{
    ok,
    bad_joint_count,      ///< no joint, or more than 64
    bad_local_joints,     ///< the kernel has no room for the joints, or they are not part of the robot
    bad_tick_period,      ///< not 1000 to 100000 microseconds
    bad_group,            ///< a slot drives a joint that the robot does not have
    too_many_broadcasts,  ///< a joint has more than two broadcasting slots
    bad_limits,           ///< lower limit above upper limit
    unknown_slot,
    unknown_joint,  ///< not a joint of this kernel, or not driven by the slot
    unknown_parameter,
    unknown_internal_value,
    out_of_range,        ///< value outside the declared range
    staging_closed,      ///< the transaction is committed already
    staging_full,        ///< as many transactions or values wait as there is room for
    nothing_staged,      ///< commit of a transaction that was not opened
    commit_in_the_past,  ///< commit for a tick that was already computed
    bad_snapshot,        ///< not a snapshot of a kernel with this configuration
    no_room,             ///< the buffer is too small
};

/// One short phrase, for messages.
[[nodiscard]] std::string_view describe(Status status);

}  // namespace proleg
