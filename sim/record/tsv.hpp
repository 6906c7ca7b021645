#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "sim/record/recording.hpp"

namespace proleg::sim {

/// What a column's name ends with: "_deg"; empty for numbers without unit.
[[nodiscard]] std::string unit_suffix(Unit unit);

/// Writes a recording as one wide table: a header line, then a line for each tick, columns separated by tabs.
///
///   tick, time_s                                  the number k of the tick, and the time of SYNC k + 1, at which its
///                                                 values hold
///   setpoint_deg.J, servo_us.J, angle_deg.J       for each joint J, from the head: commanded, sent, measured
///   current_phase_deg.J, ...                      its internal values, with their units (none: dimensionless); a slot
///                                                 number is added (current_phase_deg.J.slot1) where names would meet
///   x_m.L, y_m.L, z_m.L                           for each link L, from the head: position in the world
///   contact_rear.L, contact_front.L               1: the touch sensor was pressed at SYNC k, a tick before time_s,
///                                                 when the modules were given the contacts
///
/// Numbers do not depend on the locale. Fixed-point values are the shortest decimals that mean the same raw value,
/// others the shortest that read back as the same double.
void write_tsv(const Recording& recording, const std::function<void(std::string_view)>& write);

}  // namespace proleg::sim
