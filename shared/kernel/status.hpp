#pragma once

#include <cstdint>
#include <string_view>

namespace proleg {

/// The control kernel's answer to a request. Every answer but `ok` leaves the kernel as it was. The module sends the
/// number in object 0x2001:8.
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
    staging_full,        ///< max_transactions transactions or max_staged_values values of the joint wait
    nothing_staged,      ///< commit of a transaction that was not opened
    commit_in_the_past,  ///< commit for a tick that was already computed
};

/// A short phrase that describes the status, for messages.
[[nodiscard]] std::string_view describe(Status status);

}  // namespace proleg
