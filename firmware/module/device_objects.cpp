#include "firmware/module/device_objects.hpp"

#include "shared/can/little_endian.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::firmware {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::Address;
using canopen::NmtState;
using canopen::ValueKind;

/// Index and sub-index as one number, for switch statements.
constexpr std::uint32_t key(Address address) { return std::uint32_t{address.index} << 8U | address.sub; }
constexpr std::uint32_t key(const canopen::Object& entry) { return key(entry.address); }

/// The joint of an address in the series; nothing if it is not in it.
std::optional<unsigned> joint_in(const canopen::JointObjects& series, Address address) {
  const unsigned joint = static_cast<unsigned>(address.index) - series.first.address.index;
  return joint < canopen::JointObjects::count && address.sub == series.first.address.sub ? std::optional(joint)
                                                                                         : std::nullopt;
}

constexpr std::array<std::uint16_t, max_channels> state_frame_base{canopen::identifier::state_frame,
                                                                   canopen::identifier::second_state};

}  // namespace

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
    case Status::bad_snapshot:
    case Status::no_room:
      break;
  }
  return AbortCode::general_error;
}

AbortCode DeviceObjects::answer(Status status) {
  if (status != Status::ok) {
    refusal_ = status;
  }
  return abort_code_of(status);
}

void DeviceObjects::serve(Microseconds now, const CanFrame& request) {
  now_ = now;
  if (const std::optional<CanFrame> reply = canopen::serve_sdo(parts_.board.node, request, *this)) {
    parts_.outbox.send(*reply);
  }
}

AbortCode DeviceObjects::read(const canopen::Object& entry, std::uint32_t& value) {
  const Address address = entry.address;
  if (const std::optional<canopen::ValueAddress> found = canopen::value_address(address)) {
    return read_value(*found, value);
  }
  for (unsigned channel = 0; channel < max_channels; ++channel) {
    if (const std::optional<unsigned> joint = joint_in(object::state_frame_identifier[channel], address)) {
      const std::uint8_t node = parts_.settings.nodes[channel][*joint];
      value = node == 0 ? canopen::pdo_off : std::uint32_t{state_frame_base[channel]} + node;
      return AbortCode::none;
    }
    for (const canopen::JointObjects& half : object::received_frame[channel]) {
      if (const std::optional<unsigned> joint = joint_in(half, address)) {
        value = read_frame(*joint, channel, address.sub);
        return AbortCode::none;
      }
    }
    if (address.index == object::own_frames[channel].index) {
      value = read_frame(parts_.joint.joint(), channel, address.sub);
      return AbortCode::none;
    }
  }
  value = address.index >= object::place.index && address.index < object::measured.index ? read_joint(address)
                                                                                         : read_device(address);
  return AbortCode::none;
}

std::uint32_t DeviceObjects::read_device(Address address) const {
  switch (key(address)) {
    case key(object::error_register):
      return parts_.emergencies.error_register();
    case key(object::sync_identifier):
      return canopen::identifier::sync | (parts_.producer.runs() ? canopen::produces_sync : 0U);
    case key(object::tick_period):
      return parts_.settings.tick_period_us;
    case key(object::host_heartbeat):
      return parts_.host.expected();
    case key(object::heartbeat_period):
      return parts_.network.heartbeat_period_ms();
    case key(object::product):
    case key(object::board_id):
      return parts_.board.board_id;
    case key(object::serial):
      return serial_number(parts_.board);
    case key(object::sync_counter_overflow):
      return object::sync_counter_overflow.default_value;
    case key(object::capabilities):
      return parts_.board.capabilities;
    case key(object::core_fingerprint):
      return parts_.board.core_fingerprint;
    case key(object::monitoring_transmission_type):
      return parts_.joint.active() ? parts_.joint.monitoring_period() : 0;
    case key(object::measured_angle):
      return static_cast<std::uint32_t>(std::int32_t{canopen::monitored_angle(parts_.monitor.angle())});
    case key(object::temperature):
      return static_cast<std::uint32_t>(std::int32_t{parts_.monitor.temperature_c()});
    case key(object::current_limit):
      return parts_.monitor.limit_ma();
    case key(object::current_limit_time):
      return parts_.monitor.limit_time_ms();
    case key(object::controlword):
      return parts_.drive.power().controlword();
    case key(object::statusword):
      return parts_.drive.power().statusword();
    case key(object::mode):
    case key(object::mode_display):
      return static_cast<std::uint32_t>(parts_.drive.mode());
    case key(object::target_position):
      return static_cast<std::uint32_t>(parts_.drive.target());
    case key(object::actual_position):
      return static_cast<std::uint32_t>(parts_.monitor.angle().value_or(canopen::position_not_measured));
    case key(object::actual_current):
      return parts_.monitor.current_ma();
    default:
      return 0;
  }
}

std::uint32_t DeviceObjects::read_joint(Address address) const {
  const Settings& settings = parts_.settings;
  const JointKernel& joint = parts_.joint;
  const std::size_t slot = address.sub - 1U;
  switch (address.index) {
    case object::unique_ids.index:
      return parts_.board.unique_id[slot];
    case object::slot_algorithms.index:
      return settings.algorithms[slot];
    case object::slot_groups_low.index:
      return static_cast<std::uint32_t>(settings.groups[slot]);
    case object::slot_groups_high.index:
      return static_cast<std::uint32_t>(settings.groups[slot] >> 32U);
    default:
      break;
  }
  switch (key(address)) {
    case key(object::joint_index):
      return settings.joint;
    case key(object::joint_count):
      return settings.joint_count;
    case key(object::front_node):
      return settings.front_node;
    case key(object::rear_node):
      return settings.rear_node;
    case key(object::robot_id):
      return settings.robot_id;
    case key(object::configuration_crc):
      return joint.active() ? joint.configuration_crc() : 0;
    case key(object::current_tick):
      return joint.active() ? joint.kernel().tick() : 0;
    case key(object::refusal):
      return static_cast<std::uint32_t>(refusal_);
    case key(object::transaction):
      return joint.active() ? joint.kernel().open_transaction() : 0;
    case key(object::staged_count):
      return joint.active() ? joint.kernel().staged_count() : 0;
    case key(object::seed_low):
      return static_cast<std::uint32_t>(settings.seed);
    case key(object::seed_high):
      return static_cast<std::uint32_t>(settings.seed >> 32U);
    case key(object::servo_period):
      return settings.servo_period_us;
    case key(object::lower_limit):
      return static_cast<std::uint32_t>(joint.limits().lower);
    case key(object::upper_limit):
      return static_cast<std::uint32_t>(joint.limits().upper);
    case key(object::activate):
      return joint.active() ? 1 : 0;
    default:
      return 0;
  }
}

std::uint32_t DeviceObjects::read_frame(unsigned joint, unsigned channel, std::uint8_t sub) const {
  if (!parts_.joint.active()) {
    return 0;
  }
  const StateFrame& frame = parts_.joint.kernel().frame(joint, channel);
  return read_little_endian({0, CanFrame::max_length, frame.bytes}, sub == 1 ? 0 : 4, 4);
}

AbortCode DeviceObjects::read_value(const canopen::ValueAddress& address, std::uint32_t& value) const {
  const JointKernel& joint = parts_.joint;
  if (!joint.active()) {
    return AbortCode::refused_by_state;
  }
  const ActuationModule* algorithm = joint.algorithm(address.slot);
  if (algorithm == nullptr || algorithm->declaration().id != address.algorithm) {
    return abort_code_of(Status::unknown_slot);
  }
  switch (address.kind) {
    case ValueKind::parameter:
      value = static_cast<std::uint32_t>(joint.kernel().parameter(address.slot, joint.joint(), address.number));
      break;
    case ValueKind::staged_parameter:
      value = static_cast<std::uint32_t>(joint.staged_parameter(address.slot, address.number));
      break;
    case ValueKind::internal_value:
      value = static_cast<std::uint32_t>(joint.kernel().internal_value(address.slot, joint.joint(), address.number));
      break;
  }
  return AbortCode::none;
}

AbortCode DeviceObjects::write(const canopen::Object& entry, std::uint32_t value) {
  const Address address = entry.address;
  if (const std::optional<canopen::ValueAddress> found = canopen::value_address(address)) {
    return write_value(*found, static_cast<std::int32_t>(value));
  }
  switch (key(address)) {
    case key(object::sync_identifier):
      return write_sync_identifier(value);
    case key(object::host_heartbeat):
      parts_.host.set(value);
      return AbortCode::none;
    case key(object::heartbeat_period):
      parts_.network.set_heartbeat_period(now_, static_cast<std::uint16_t>(value));
      return AbortCode::none;
    case key(object::sync_counter_overflow):
      return AbortCode::none;  // there is one value
    case key(object::current_limit):
      parts_.monitor.set_limit_ma(static_cast<std::uint16_t>(value));
      return AbortCode::none;
    case key(object::current_limit_time):
      parts_.monitor.set_limit_time_ms(static_cast<std::uint16_t>(value));
      return AbortCode::none;
    case key(object::controlword):
      parts_.drive.power().command(static_cast<std::uint16_t>(value));
      return AbortCode::none;
    case key(object::mode):
      parts_.drive.set_mode(static_cast<std::int8_t>(value));
      return AbortCode::none;
    case key(object::target_position):
      parts_.drive.set_target(static_cast<std::int32_t>(value));
      return AbortCode::none;
    case key(object::transaction):
      return parts_.joint.active() ? answer(parts_.joint.open(static_cast<std::uint16_t>(value)))
                                   : AbortCode::refused_by_state;
    default:
      break;
  }
  return parts_.network.state() == NmtState::pre_operational ? write_setting(address, value)
                                                             : AbortCode::refused_by_state;
}

AbortCode DeviceObjects::write_sync_identifier(std::uint32_t value) {
  if ((value & canopen::produces_sync) == 0) {
    parts_.producer.stop();
    return AbortCode::none;
  }
  if (!parts_.network.operational()) {
    return AbortCode::refused_by_state;
  }
  parts_.producer.start(now_, parts_.joint.kernel().configuration().tick_period_us, parts_.joint.configuration_crc());
  return AbortCode::none;
}

AbortCode DeviceObjects::write_setting(Address address, std::uint32_t value) {
  constexpr std::uint64_t low_half = 0xFFFFFFFF;
  Settings& settings = parts_.settings;
  for (unsigned channel = 0; channel < max_channels; ++channel) {
    if (const std::optional<unsigned> joint = joint_in(object::state_frame_identifier[channel], address)) {
      settings.nodes[channel][*joint] =
          value == canopen::pdo_off ? std::uint8_t{0} : static_cast<std::uint8_t>(value - state_frame_base[channel]);
      return AbortCode::none;
    }
  }
  const std::size_t slot = address.sub - 1U;
  switch (address.index) {
    case object::slot_algorithms.index:
      return write_algorithm(static_cast<unsigned>(slot), value);
    case object::slot_groups_low.index:
      settings.groups[slot] = (settings.groups[slot] & ~low_half) | value;
      return AbortCode::none;
    case object::slot_groups_high.index:
      settings.groups[slot] = (settings.groups[slot] & low_half) | std::uint64_t{value} << 32U;
      return AbortCode::none;
    default:
      break;
  }
  switch (key(address)) {
    case key(object::tick_period):
      settings.tick_period_us = value;
      break;
    case key(object::joint_index):
      settings.joint = static_cast<std::uint8_t>(value);
      break;
    case key(object::joint_count):
      settings.joint_count = static_cast<std::uint8_t>(value);
      break;
    case key(object::front_node):
      settings.front_node = static_cast<std::uint8_t>(value);
      break;
    case key(object::rear_node):
      settings.rear_node = static_cast<std::uint8_t>(value);
      break;
    case key(object::robot_id):
      settings.robot_id = static_cast<std::uint16_t>(value);
      break;
    case key(object::seed_low):
      settings.seed = (settings.seed & ~low_half) | value;
      break;
    case key(object::seed_high):
      settings.seed = (settings.seed & low_half) | std::uint64_t{value} << 32U;
      break;
    case key(object::servo_period):
      settings.servo_period_us = value;
      break;
    case key(object::activate):
      return activate(value == 1);
    case key(object::lower_limit):
      return write_limits({static_cast<std::int32_t>(value), parts_.joint.limits().upper});
    case key(object::upper_limit):
      return write_limits({parts_.joint.limits().lower, static_cast<std::int32_t>(value)});
    default:
      return AbortCode::unsupported_access;
  }
  return AbortCode::none;
}

AbortCode DeviceObjects::write_algorithm(unsigned slot, std::uint32_t id) {
  if (id != 0 && find_algorithm(static_cast<std::uint8_t>(id)) == nullptr) {
    return AbortCode::out_of_range;
  }
  parts_.settings.algorithms[slot] = static_cast<std::uint8_t>(id);
  return AbortCode::none;
}

AbortCode DeviceObjects::write_limits(const canopen::AngleLimits& limits) {
  return parts_.joint.active() ? answer(parts_.joint.set_limits(limits)) : AbortCode::refused_by_state;
}

AbortCode DeviceObjects::activate(bool active) {
  const Settings& settings = parts_.settings;
  parts_.joint.deactivate();
  parts_.neighbours.stop();
  if (!active) {
    return AbortCode::none;
  }
  if (!StateReceiver::accepts(settings, parts_.board.node)) {
    return AbortCode::general_incompatibility;
  }
  parts_.drive.configure({settings.servo_period_us, settings.tick_period_us});
  const Status status = parts_.joint.activate(settings, parts_.board.node);
  if (status == Status::ok) {
    parts_.neighbours.configure(settings);
  }
  return answer(status);
}

AbortCode DeviceObjects::write_value(const canopen::ValueAddress& address, std::int32_t value) {
  JointKernel& joint = parts_.joint;
  if (!joint.active()) {
    return AbortCode::refused_by_state;
  }
  const ActuationModule* algorithm = joint.algorithm(address.slot);
  if (algorithm == nullptr || algorithm->declaration().id != address.algorithm) {
    return answer(Status::unknown_slot);
  }
  if (address.kind == ValueKind::parameter) {
    return parts_.network.state() == NmtState::pre_operational
               ? answer(joint.set_parameter(address.slot, address.number, value))
               : AbortCode::refused_by_state;
  }
  if (!joint.has_open_transaction()) {
    return AbortCode::refused_by_state;
  }
  return answer(joint.stage(address.slot, address.number, address.kind == ValueKind::internal_value, value));
}

}  // namespace proleg::firmware
