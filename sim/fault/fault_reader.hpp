#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sim/fault/fault.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// Reads a fault schedule (docs/faults.md): a fault in each line, "#" starts a comment; JOINT is a name of the robot or
/// "*" for one fault at each joint. Throws InputError that names file and line: for an unknown kind, joint or form, for
/// a time at or after the end of the run, and for two faults of one kind at one place at the same time.
[[nodiscard]] FaultSchedule read_faults(const std::string& path, const RobotModel& robot, std::uint64_t run_us);

/// Reads a fault schedule from text. path: name for messages.
[[nodiscard]] FaultSchedule parse_faults(const std::string& text, const std::string& path, const RobotModel& robot,
                                         std::uint64_t run_us);

/// Parses a frame as cansend of can-utils does: "080#05", three hexadecimal digits up to 7FF, up to 8 bytes in
/// hexadecimal.
[[nodiscard]] std::optional<CanFrame> parse_frame(std::string_view word);

/// Text of a file with the faults, which read_faults() reads.
[[nodiscard]] std::string faults_text(const FaultSchedule& schedule, const RobotModel& robot);

}  // namespace proleg::sim
