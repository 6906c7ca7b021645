#pragma once

// The entries of the object dictionary with fixed addresses. objects.hpp has the entries that follow from the
// declarations of the algorithms.

#include <array>

#include "shared/can/can_port.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/object.hpp"
#include "shared/kernel/kernel.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::canopen {

/// Version of docs/protocol.md: the major number is the high byte, the minor number the low byte.
inline constexpr std::uint16_t protocol_version = 0x0100;
/// A placeholder ("PROL") for a vendor id, which CiA has not assigned. A maker of modules replaces it with its own.
inline constexpr std::uint32_t placeholder_vendor = 0x50524F4C;
/// This bit in a COB-ID switches the PDO off (CiA 301, 7.5.2.35).
inline constexpr std::uint32_t pdo_off = 0x80000000;
/// This bit in the COB-ID of a transmit PDO excludes remote frames (CiA 301, 7.5.2.37).
inline constexpr std::uint32_t no_remote_frames = 0x40000000;
/// This bit in 0x1005 says that the module produces SYNC (CiA 301, 7.5.2.5).
inline constexpr std::uint32_t produces_sync = 0x40000000;

/// Modes of operation (0x6060). Negative numbers are for the manufacturer.
inline constexpr std::int8_t mode_gait = -1;
inline constexpr std::int8_t mode_direct_position = 8;  ///< cyclic synchronous position (CiA 402)

/// Bits of the capabilities (0x2000:5).
inline constexpr std::uint32_t measures_angle = 1U << 0U;  ///< the joint has a feedback potentiometer
/// The chip is reset when its supply falls below 2.8 V: its option bytes have the brown-out level that docs/board.md
/// asks for.
inline constexpr std::uint32_t has_brown_out_reset = 1U << 1U;
/// Nothing measures the servo's current: 0x6078 is 0, and over-current is not detected.
inline constexpr std::uint32_t has_no_current_sensor = 1U << 2U;

/// Bit 10 of the statusword (0x6041): target reached (CiA 402, 8.4.2). Here it says that the joint has ramped in.
inline constexpr std::uint16_t target_reached = 1U << 10U;

/// Values that are written to 0x1010 and 0x1011: "save" and "load", the first letter in the lowest byte (CiA 301,
/// 7.5.2.13).
inline constexpr std::uint32_t signature_save = 0x65766173;
inline constexpr std::uint32_t signature_load = 0x64616F6C;

/// Time for which a client waits for the answer to a request that stores something: 0x1010, 0x1011, LSS 'store
/// configuration'. The module erases and programs flash before it answers. On the reference board that takes 0.5 s at
/// most (DS8626); after 1 s the module answers that the flash has failed.
inline constexpr Microseconds storing_time_us = 1'500'000;

/// Value of 0x2009:3 if the ADC has not read the potentiometer.
inline constexpr std::uint16_t feedback_not_read = 0xFFFF;
/// Value of 0x6064 if the module does not measure the angle.
inline constexpr std::int32_t position_not_measured = -0x7FFFFFFF - 1;

/// The mapping parameter of an entry: index, sub-index and length in bits (CiA 301, 7.5.2.36).
[[nodiscard]] constexpr std::uint32_t mapping_of(const Object& object) {
  return std::uint32_t{object.address.index} << 16U | std::uint32_t{object.address.sub} << 8U |
         8U * size_of(object.type);
}

namespace object {

inline constexpr Range full_angle{static_cast<std::uint32_t>(-quarter_turn), quarter_turn};
inline constexpr UnitScale angle = scale_of(Unit::degree);
/// Unit of the upper 16 bits of an angle.
inline constexpr UnitScale short_angle{angle.symbol, angle.numerator >> 16U, angle.denominator};

// Entries of the communication (CiA 301, section 7.5.2).

inline constexpr Object device_type =
    constant({0x1000, 0}, "Device type", DataType::unsigned32, 0x00020192, "servo drive, CiA 402");
inline constexpr Object error_register =
    read_only({0x1001, 0}, "Error register", DataType::unsigned8, "bit 0: an error; others as in CiA 301");
inline constexpr ObjectGroup error_history{0x1003, ObjectCode::array, "Pre-defined error field"};
inline constexpr Object error_count =
    read_write(error_history.at(0), "Number of errors", DataType::unsigned8, 0, full_range(DataType::unsigned8),
               "that are kept; a write of 0 clears them, other values are refused");
inline constexpr ObjectArray recent_error{
    read_only(error_history.at(1), "Standard error field", DataType::unsigned32,
              "the newest first; lower half: emergency code, upper half: lower half of its detail"),
    8};
inline constexpr Object sync_identifier = read_write(
    {0x1005, 0}, "COB-ID SYNC message", DataType::unsigned32, identifier::sync, {identifier::sync, identifier::sync},
    "0x40000080: the module produces SYNC and TICK, 0x80: another does", produces_sync | identifier::sync);
inline constexpr Object tick_period =
    in_unit("us", read_write({0x1006, 0}, "Communication cycle period", DataType::unsigned32, 10'000, {1'000, 100'000},
                             "a tick, in microseconds"));
inline constexpr Object device_name = constant_text({0x1008, 0}, "Manufacturer device name", "Proleg joint module");
inline constexpr Object hardware_version =
    read_only({0x1009, 0}, "Manufacturer hardware version", DataType::visible_string, "\"board\" and the board id");
inline constexpr Object software_version =
    read_only({0x100A, 0}, "Manufacturer software version", DataType::visible_string,
              "\"protocol\" and its version, \"core\" and the core fingerprint");

inline constexpr ObjectGroup storing{0x1010, ObjectCode::array, "Store parameters"};
inline constexpr Object store_parameters =
    read_write(storing.at(1), "Save all parameters", DataType::unsigned32, 1, full_range(DataType::unsigned32),
               "0x65766173 (save): keeps 0x200A, 0x2020 and 0x607D in flash; 1: it can");
inline constexpr ObjectGroup restoring{0x1011, ObjectCode::array, "Restore default parameters"};
inline constexpr Object restore_parameters =
    read_write(restoring.at(1), "Restore all default parameters", DataType::unsigned32, 1,
               full_range(DataType::unsigned32), "0x64616F6C (load): defaults from the next reset on; 1: it can");

inline constexpr Object emergency_identifier =
    node_identifier({0x1014, 0}, "COB-ID emergency message", identifier::emergency);

inline constexpr ObjectGroup consumer_heartbeat{0x1016, ObjectCode::array, "Consumer heartbeat time"};
inline constexpr Object host_heartbeat =
    read_write(consumer_heartbeat.at(1), "Consumer heartbeat time of the host", DataType::unsigned32, 0,
               {0, 0x007FFFFF}, "65536 * node + timeout in ms; 0: no heartbeat is expected");

inline constexpr Object heartbeat_period =
    in_unit("ms", read_write({0x1017, 0}, "Producer heartbeat time", DataType::unsigned16, 0,
                             full_range(DataType::unsigned16), "in ms; 0: off"));

inline constexpr ObjectGroup identity{0x1018, ObjectCode::record, "Identity object"};
inline constexpr Object vendor = constant(identity.at(1), "Vendor-ID", DataType::unsigned32, placeholder_vendor,
                                          "a placeholder, not assigned by CiA");
inline constexpr Object product = read_only(identity.at(2), "Product code", DataType::unsigned32, "the board id");
inline constexpr Object revision = constant(identity.at(3), "Revision number", DataType::unsigned32, 0x00010000,
                                            "major and minor revision of this dictionary, 16 bits each");
inline constexpr Object serial =
    read_only(identity.at(4), "Serial number", DataType::unsigned32, "CRC-32 of the unique id, 0x2003");

inline constexpr Object sync_counter_overflow =
    read_write({0x1019, 0}, "Synchronous counter overflow value", DataType::unsigned8, sync_counters,
               {sync_counters, sync_counters}, "SYNC counts 1 to 128");

inline constexpr ObjectGroup sdo_server{0x1200, ObjectCode::record, "SDO server parameter"};
inline constexpr Object sdo_request_identifier =
    node_identifier(sdo_server.at(1), "COB-ID client to server", identifier::sdo_request);
inline constexpr Object sdo_answer_identifier =
    node_identifier(sdo_server.at(2), "COB-ID server to client", identifier::sdo_answer);

// Entries of the device.

inline constexpr ObjectGroup device{0x2000, ObjectCode::record, "Device"};
inline constexpr Object version =
    constant(device.at(1), "Protocol version", DataType::unsigned16, protocol_version, "major and minor, a byte each");
inline constexpr Object frame_layout =
    constant(device.at(2), "State frame layout", DataType::unsigned8, 1, "docs/protocol.md, State frame");
inline constexpr Object core_fingerprint = read_only(device.at(3), "Core fingerprint", DataType::unsigned32,
                                                     "modules with equal fingerprints compute equal bits");
inline constexpr Object board_id =
    read_only(device.at(4), "Board id", DataType::unsigned16, "1: reference board STM32F405");
inline constexpr Object capabilities = read_only(
    device.at(5), "Capabilities", DataType::unsigned32,
    "bit 0: measures the actual angle of the joint; bit 1: its chip is reset below 2.8 V; bit 2: has no sensor "
    "for the servo's current, so over-current is not detected");
inline constexpr Object update_key = read_only(device.at(6), "Key of images", DataType::unsigned32,
                                               "id of the key with which images must be signed; 0: it takes any image");

inline constexpr ObjectGroup place{0x2001, ObjectCode::record, "Place in the robot"};
inline constexpr Object joint_index =
    read_write(place.at(1), "Joint index", DataType::unsigned8, 0, {0, max_joints - 1}, "0: the joint at the head");
inline constexpr Object joint_count =
    read_write(place.at(2), "Joint count", DataType::unsigned8, 1, {1, max_joints}, "joints of the robot");
inline constexpr Object front_node = read_write(place.at(3), "Front node", DataType::unsigned8, 0, {0, max_node_id},
                                                "node id of the next joint towards the head; 0: none");
inline constexpr Object rear_node = read_write(place.at(4), "Rear node", DataType::unsigned8, 0, {0, max_node_id},
                                               "node id of the next joint towards the tail; 0: none");
inline constexpr Object robot_id =
    read_write(place.at(5), "Robot id", DataType::unsigned16, 1, full_range(DataType::unsigned16), "as in COMMIT");
inline constexpr Object configuration_crc = read_only(place.at(6), "Configuration CRC", DataType::unsigned32,
                                                      "CRC-32 of what all modules agree on, as in TICK");
inline constexpr Object current_tick = read_only(place.at(7), "Current tick", DataType::unsigned32, "of the next SYNC");
inline constexpr Object refusal = read_only(place.at(8), "Refusal", DataType::unsigned8,
                                            "reason of the last request that the kernel refused; 0: none");

inline constexpr Object session_token =
    read_write({0x2002, 0}, "Session token", DataType::unsigned32, 0, full_range(DataType::unsigned32),
               "of the host that drives the robot, 0: none; another token is refused while one is held");

inline constexpr ObjectGroup unique_ids{0x2003, ObjectCode::array, "Unique id"};
inline constexpr ObjectArray unique_id{
    read_only(unique_ids.at(1), "Unique id, word", DataType::unsigned32, "of 96 bits, the lowest word first"), 3};

inline constexpr ObjectGroup staging{0x2004, ObjectCode::record, "Staging"};
inline constexpr Object transaction =
    read_write(staging.at(1), "Transaction", DataType::unsigned16, 0, full_range(DataType::unsigned16),
               "a write opens the transaction and drops another one that is open");
inline constexpr Object staged_count =
    read_only(staging.at(2), "Staged values", DataType::unsigned8, "number of values staged in the transaction");

inline constexpr ObjectGroup kernel{0x2005, ObjectCode::record, "Control kernel"};
inline constexpr Object seed_low = read_write(kernel.at(1), "Seed, lower half", DataType::unsigned32, 1,
                                              full_range(DataType::unsigned32), "of the noise, one for all joints");
inline constexpr Object seed_high =
    read_write(kernel.at(2), "Seed, upper half", DataType::unsigned32, 0, full_range(DataType::unsigned32));
inline constexpr Object servo_period =
    in_unit("us", read_write(kernel.at(3), "Servo period", DataType::unsigned32, 20'000, {100, 100'000},
                             "between two pulses, in microseconds"));
inline constexpr Object lower_limit =
    in_unit(angle, read_write(kernel.at(4), "Lower limit", DataType::integer32, full_angle.minimum, full_angle,
                              "of the joint angle; 2^30 is 90 degrees"));
inline constexpr Object upper_limit =
    in_unit(angle, read_write(kernel.at(5), "Upper limit", DataType::integer32, full_angle.maximum, full_angle,
                              "of the joint angle; 2^30 is 90 degrees"));
inline constexpr Object activate = read_write(kernel.at(6), "Activate", DataType::unsigned8, 0, {0, 1},
                                              "1: applies joint index, slots, seed and periods; 0: not configured");

inline constexpr ObjectGroup slot_algorithms{0x2006, ObjectCode::array, "Slot algorithms"};
inline constexpr ObjectArray slot_algorithm{read_write(slot_algorithms.at(1), "Algorithm of slot", DataType::unsigned8,
                                                       0, {0, 127}, "algorithm id; 0: the slot is empty"),
                                            max_slots};
inline constexpr ObjectGroup slot_groups_low{0x2007, ObjectCode::array, "Slot groups, joints 0-31"};
inline constexpr ObjectArray slot_group_low{
    read_write(slot_groups_low.at(1), "Joints 0-31 of slot", DataType::unsigned32, 0, full_range(DataType::unsigned32),
               "bit j: joint j"),
    max_slots};
inline constexpr ObjectGroup slot_groups_high{0x2008, ObjectCode::array, "Slot groups, joints 32-63"};
inline constexpr ObjectArray slot_group_high{
    read_write(slot_groups_high.at(1), "Joints 32-63 of slot", DataType::unsigned32, 0,
               full_range(DataType::unsigned32), "bit j: joint 32 + j"),
    max_slots};

inline constexpr ObjectGroup measured{0x2009, ObjectCode::record, "Measured"};
inline constexpr Object measured_angle =
    in_unit(short_angle, read_only(measured.at(1), "Actual angle", DataType::integer16,
                                   "upper bits of 0x6064: 2^14 is 90 degrees; -32768: not measured"));
inline constexpr Object temperature =
    in_unit("degC", read_only(measured.at(2), "Temperature", DataType::integer8, "of the chip, in degrees Celsius"));
inline constexpr Object feedback_reading =
    read_only(measured.at(3), "Feedback reading", DataType::unsigned16,
              "of the potentiometer by the ADC, 0 to 4095, also if none is fitted; 65535: not read");
inline constexpr Object touch_sensors =
    read_only(measured.at(4), "Touch sensors", DataType::unsigned8,
              "as the pins are now, not debounced; bits 0-3 as in byte 6 of the state frame");

inline constexpr ObjectGroup over_current{0x200A, ObjectCode::record, "Over-current"};
inline constexpr Object current_limit =
    in_unit("mA", read_write(over_current.at(1), "Current limit", DataType::unsigned16, 2'000, {0, 0x7FFF},
                             "of the servo, in mA; 0: off"));
inline constexpr Object current_limit_time =
    in_unit("ms", read_write(over_current.at(2), "Time above the limit", DataType::unsigned16, 500,
                             full_range(DataType::unsigned16), "that leads to a fault, in ms"));

inline constexpr ObjectGroup bus_statistics{0x200B, ObjectCode::record, "Bus statistics"};
inline constexpr Object lost_frames = read_only(bus_statistics.at(1), "Lost frames", DataType::unsigned32,
                                                "received since the program started, but there was no room for them");

inline constexpr ObjectGroup gateway_statistics{0x200C, ObjectCode::record, "Gateway statistics"};
inline constexpr Object frames_not_written =
    read_only(gateway_statistics.at(1), "Frames not written", DataType::unsigned32,
              "to the host since power-on, because its serial line had no room for them");
inline constexpr Object frames_not_sent =
    read_only(gateway_statistics.at(2), "Frames not sent", DataType::unsigned32,
              "that the host had sent since power-on: channel closed, no room, bus-off, not of the protocol");
inline constexpr Object wrong_lines = read_only(gateway_statistics.at(3), "Wrong lines", DataType::unsigned32,
                                                "from the host since power-on, not understood or damaged");

inline constexpr ObjectGroup setpoint_checksum{0x200D, ObjectCode::record, "Set-point checksum"};
inline constexpr Object setpoint_ticks =
    read_write(setpoint_checksum.at(1), "Ticks", DataType::unsigned32, 0, {0, 0},
               "from tick 0 on that sub-index 2 counts; a write of 0 takes both as they are now; 0: not valid");
inline constexpr Object setpoint_crc = read_only(setpoint_checksum.at(2), "CRC of the set-points", DataType::unsigned32,
                                                 "CRC-32 of the int32 set-points of these ticks");

inline constexpr Object ramp_in_speed = in_unit(
    "deg/s",
    read_write({0x200E, 0}, "Ramp-in speed", DataType::unsigned16, 0, full_range(DataType::unsigned16),
               "from the measured angle to the start of the gait, in degrees a second, at most 0x6080; 0: off"));

inline constexpr ObjectGroup user_algorithms{0x200F, ObjectCode::array, "Users' algorithms"};
inline constexpr ObjectArray user_algorithm{
    read_only(user_algorithms.at(1), "Sources of user's algorithm", DataType::unsigned32,
              "with the id 95 + sub-index: the first 32 bits of their SHA-256; 0: the module does not have it"),
    max_user_algorithms};
static_assert(first_user_id == 96);
/// Address of the entry of a user's algorithm. id: of the algorithm.
[[nodiscard]] constexpr Address user_algorithm_address(std::uint8_t id) {
  return {user_algorithm.first.address.index, static_cast<std::uint8_t>(id - first_user_id + 1)};
}

inline constexpr ObjectGroup board{0x2020, ObjectCode::record, "Board"};
inline constexpr Object gateway_role = read_write(board.at(1), "Gateway role", DataType::unsigned8, 0, {0, 1},
                                                  "1: slcan on the serial line; in force when saved, after a reset");
inline constexpr Object has_feedback =
    read_write(board.at(2), "Feedback potentiometer", DataType::unsigned8, 0, {0, 1},
               "1: fitted; with sub-indices 3 and 4 in force when saved, after a reset");
inline constexpr Object feedback_at_minus_90 =
    read_write(board.at(3), "Feedback at -90 degrees", DataType::unsigned16, 0, {0, 4095}, "as the ADC reads it");
inline constexpr Object feedback_at_plus_90 =
    read_write(board.at(4), "Feedback at +90 degrees", DataType::unsigned16, 0, {0, 4095}, "as the ADC reads it");

// Entries of the state frames, by channel: 0 is the first broadcasting slot of a joint, 1 the second.

inline constexpr std::array own_frames{
    ObjectGroup{0x2010, ObjectCode::array, "Own state frame"},
    ObjectGroup{0x2011, ObjectCode::array, "Own second state frame"},
};
inline constexpr std::array<std::array<Object, 2>, max_channels> own_frame{{
    {read_only(own_frames[0].at(1), "Bytes 0-3", DataType::unsigned32, "as sent last"),
     read_only(own_frames[0].at(2), "Bytes 4-7", DataType::unsigned32, "byte 6: contacts and flags; byte 7: label")},
    {read_only(own_frames[1].at(1), "Bytes 0-3", DataType::unsigned32, "0 unless two slots of the joint broadcast"),
     read_only(own_frames[1].at(2), "Bytes 4-7", DataType::unsigned32, "as of the first one")},
}};

inline constexpr std::array received_frames{
    ObjectGroup{0x2100, ObjectCode::array, "Received state frame of joint", max_joints},
    ObjectGroup{0x2140, ObjectCode::array, "Received second state frame of joint", max_joints},
};
[[nodiscard]] constexpr JointObjects half_frame(unsigned channel, std::uint8_t sub, std::string_view name) {
  Object first = read_only(received_frames[channel].at(sub), name, DataType::unsigned32,
                           "last one received; only of joints on which this one depends");
  first.access = Access::by_pdo;
  return {first};
}
inline constexpr std::array<std::array<JointObjects, 2>, max_channels> received_frame{{
    {half_frame(0, 1, "Bytes 0-3"), half_frame(0, 2, "Bytes 4-7")},
    {half_frame(1, 1, "Bytes 0-3"), half_frame(1, 2, "Bytes 4-7")},
}};

// Entries of the process data objects. Their contents are fixed; their senders are set.

/// Transmission types (CiA 301, 7.5.2.35 and 7.5.2.37).
inline constexpr std::uint32_t at_every_sync = 1;
inline constexpr std::uint32_t on_event = 255;

inline constexpr ObjectGroup command_reception{0x1400, ObjectCode::record, "RPDO communication parameter, command"};
inline constexpr Object command_identifier =
    node_identifier(command_reception.at(1), "COB-ID used by RPDO", identifier::command);
inline constexpr Object command_transmission =
    constant(command_reception.at(2), "Transmission type", DataType::unsigned8, on_event, "acts at once");

inline constexpr std::array frame_receptions{
    ObjectGroup{0x1410, ObjectCode::record, "RPDO communication parameter, state frame of joint", max_joints},
    ObjectGroup{0x1450, ObjectCode::record, "RPDO communication parameter, second state frame of joint", max_joints},
};
[[nodiscard]] constexpr JointObjects frame_identifier(unsigned channel) {
  const std::uint32_t base = identifier::state_frames[channel];
  return {read_write(frame_receptions[channel].at(1), "COB-ID used by RPDO", DataType::unsigned32, pdo_off,
                     {base + min_node_id, base + max_node_id}, "0x80000000: off", pdo_off)};
}
/// Identifiers of the state frames that a module receives. The entry of its own joint is off.
inline constexpr std::array<JointObjects, max_channels> state_frame_identifier{
    frame_identifier(0),
    frame_identifier(1),
};
inline constexpr std::array<JointObjects, max_channels> state_frame_transmission{
    JointObjects{constant(frame_receptions[0].at(2), "Transmission type", DataType::unsigned8, at_every_sync,
                          "acts at the next SYNC")},
    JointObjects{constant(frame_receptions[1].at(2), "Transmission type", DataType::unsigned8, at_every_sync,
                          "acts at the next SYNC")},
};

// Entries of the drive (CiA 402).

inline constexpr std::uint32_t quick_stop_command = 3;
inline constexpr Object abort_connection_option = read_write(
    {0x6007, 0}, "Abort connection option code", DataType::integer16, quick_stop_command,
    {quick_stop_command, quick_stop_command}, "3: quick stop if the heartbeat of the host or SYNC is missing");
inline constexpr Object controlword =
    read_write({0x6040, 0}, "Controlword", DataType::unsigned16, 0, full_range(DataType::unsigned16),
               "6, 7, 15 in this order give the servo power, 0 takes it; bit 7 ends a fault and a quick stop");
inline constexpr Object statusword =
    read_only({0x6041, 0}, "Statusword", DataType::unsigned16,
              "state of the drive, CiA 402; bit 10: has ramped in (0x200E) to the start of the gait");
inline constexpr std::uint32_t ramp_and_stay = 6;
inline constexpr Object quick_stop_option =
    read_write({0x605A, 0}, "Quick stop option code", DataType::integer16, ramp_and_stay,
               {ramp_and_stay, ramp_and_stay}, "6: ramp to the safe pose, then stay in Quick stop active");
inline constexpr Object mode =
    read_write({0x6060, 0}, "Modes of operation", DataType::integer8, static_cast<std::uint32_t>(mode_gait),
               {static_cast<std::uint32_t>(mode_gait), static_cast<std::uint32_t>(mode_gait)},
               "-1: gait; 8: cyclic synchronous position", mode_direct_position);
inline constexpr Object mode_display =
    read_only({0x6061, 0}, "Modes of operation display", DataType::integer8, "the mode in force, as in 0x6060");
inline constexpr Object position_demand =
    in_unit(angle, read_only({0x6062, 0}, "Position demand value", DataType::integer32,
                             "set-point of the present tick; 2^30 is 90 degrees"));
inline constexpr Object actual_position =
    in_unit(angle, read_only({0x6064, 0}, "Position actual value", DataType::integer32,
                             "2^30 is 90 degrees; -2147483648: not measured"));
inline constexpr Object rated_current =
    in_unit("mA", constant({0x6075, 0}, "Motor rated current", DataType::unsigned32, 1'000,
                           "1,000 mA, the unit of 0x6078; not the rated current of the servo"));
inline constexpr Object actual_current = in_unit(
    "mA", read_only({0x6078, 0}, "Current actual value", DataType::integer16, "thousandths of 0x6075, which are mA"));
inline constexpr Object target_position = in_unit(angle, read_write({0x607A, 0}, "Target position", DataType::integer32,
                                                                    0, full_angle, "joint angle; 2^30 is 90 degrees"));
inline constexpr ObjectGroup position_limits{0x607D, ObjectCode::array, "Software position limit"};
inline constexpr Object lowest_position =
    in_unit(angle, read_write(position_limits.at(1), "Min position limit", DataType::integer32, full_angle.minimum,
                              {full_angle.minimum, 0}, "joint angle that the mechanics allow; 2^30 is 90 degrees"));
inline constexpr Object highest_position =
    in_unit(angle, read_write(position_limits.at(2), "Max position limit", DataType::integer32, full_angle.maximum,
                              {0, full_angle.maximum}, "joint angle that the mechanics allow; 2^30 is 90 degrees"));
inline constexpr Object command_speed =
    in_unit("deg/s", read_write({0x6080, 0}, "Max motor speed", DataType::unsigned32, default_command_speed,
                                {min_command_speed, max_command_speed},
                                "greatest speed of commanded angles of the joint, in degrees a second"));
inline constexpr Object supported_modes = constant({0x6502, 0}, "Supported drive modes", DataType::unsigned32,
                                                   0x00010080, "bit 7: cyclic synchronous position; bit 16: gait");

// The contents of the process data objects.

inline constexpr ObjectGroup command_mapping{0x1600, ObjectCode::record, "RPDO mapping parameter, command"};
inline constexpr std::array command_mapped{
    constant(command_mapping.at(1), "Controlword", DataType::unsigned32, mapping_of(controlword)),
    constant(command_mapping.at(2), "Target position", DataType::unsigned32, mapping_of(target_position)),
};
inline constexpr std::array frame_reception_mappings{
    ObjectGroup{0x1610, ObjectCode::record, "RPDO mapping parameter, state frame of joint", max_joints},
    ObjectGroup{0x1650, ObjectCode::record, "RPDO mapping parameter, second state frame of joint", max_joints},
};
[[nodiscard]] constexpr JointObjects received_mapping(unsigned channel, std::uint8_t sub) {
  const Object& half = received_frame[channel][sub - 1U].first;
  return {constant(frame_reception_mappings[channel].at(sub), half.name, DataType::unsigned32, mapping_of(half)),
          0x10000};
}
inline constexpr std::array<std::array<JointObjects, 2>, max_channels> received_mapped{{
    {received_mapping(0, 1), received_mapping(0, 2)},
    {received_mapping(1, 1), received_mapping(1, 2)},
}};

inline constexpr std::array frame_transmissions{
    ObjectGroup{0x1800, ObjectCode::record, "TPDO communication parameter, state frame"},
    ObjectGroup{0x1801, ObjectCode::record, "TPDO communication parameter, second state frame"},
};
inline constexpr std::array own_frame_identifier{
    node_identifier(frame_transmissions[0].at(1), "COB-ID used by TPDO",
                    no_remote_frames | identifier::state_frames[0]),
    node_identifier(frame_transmissions[1].at(1), "COB-ID used by TPDO", no_remote_frames | identifier::state_frames[1],
                    "sent if two slots of the joint broadcast"),
};
inline constexpr std::array own_frame_transmission{
    constant(frame_transmissions[0].at(2), "Transmission type", DataType::unsigned8, at_every_sync),
    constant(frame_transmissions[1].at(2), "Transmission type", DataType::unsigned8, at_every_sync),
};
inline constexpr ObjectGroup monitoring_transmission{0x1802, ObjectCode::record,
                                                     "TPDO communication parameter, monitoring"};
inline constexpr Object monitoring_identifier =
    node_identifier(monitoring_transmission.at(1), "COB-ID used by TPDO", no_remote_frames | identifier::monitoring);
inline constexpr Object monitoring_transmission_type =
    read_only(monitoring_transmission.at(2), "Transmission type", DataType::unsigned8,
              "number of SYNCs between two: 10, or 100 if the robot fills the bus", monitoring_periods[0]);
inline constexpr std::array frame_transmission_mappings{
    ObjectGroup{0x1A00, ObjectCode::record, "TPDO mapping parameter, state frame"},
    ObjectGroup{0x1A01, ObjectCode::record, "TPDO mapping parameter, second state frame"},
};
[[nodiscard]] constexpr Object own_mapping(unsigned channel, std::uint8_t sub) {
  const Object& half = own_frame[channel][sub - 1U];
  return constant(frame_transmission_mappings[channel].at(sub), half.name, DataType::unsigned32, mapping_of(half));
}
inline constexpr std::array<std::array<Object, 2>, max_channels> own_mapped{{
    {own_mapping(0, 1), own_mapping(0, 2)},
    {own_mapping(1, 1), own_mapping(1, 2)},
}};

inline constexpr ObjectGroup monitoring_mapping{0x1A02, ObjectCode::record, "TPDO mapping parameter, monitoring"};
inline constexpr std::array monitoring_mapped{
    constant(monitoring_mapping.at(1), "Actual angle", DataType::unsigned32, mapping_of(measured_angle)),
    constant(monitoring_mapping.at(2), "Current actual value", DataType::unsigned32, mapping_of(actual_current)),
    constant(monitoring_mapping.at(3), "Temperature", DataType::unsigned32, mapping_of(temperature)),
    constant(monitoring_mapping.at(4), "Error register", DataType::unsigned32, mapping_of(error_register)),
};

}  // namespace object

/// Shortest time for which a client waits for the answer to a write.
[[nodiscard]] constexpr Microseconds min_write_timeout_us(Address address) {
  return address == object::store_parameters.address || address == object::restore_parameters.address ? storing_time_us
                                                                                                      : 0;
}

}  // namespace proleg::canopen
