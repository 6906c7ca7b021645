#include "firmware/module/device_objects.hpp"

#include <type_traits>

#include "firmware/module/board_control.hpp"
#include "shared/fixed/little_endian.hpp"
#include "shared/gait/registry.hpp"
#include "shared/kernel/kernel_configuration.hpp"

namespace proleg::firmware {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::ValueKind;

// Kinds of rows. `Read` is a function of the parts, and of the position in a series; its result may have any integer
// type. `Write` returns an abort code, or nothing if it cannot fail.

template <typename Read>
std::uint32_t get(const Parts& parts, Position position) {
  if constexpr (std::is_invocable_v<Read, const Parts&, Position>) {
    return static_cast<std::uint32_t>(Read{}(parts, position));
  } else {
    return static_cast<std::uint32_t>(Read{}(parts));
  }
}
template <typename Write>
AbortCode set(Parts& parts, const ObjectWrite& write) {
  if constexpr (std::is_void_v<std::invoke_result_t<Write, Parts&, const ObjectWrite&>>) {
    Write{}(parts, write);
    return AbortCode::none;
  } else {
    return Write{}(parts, write);
  }
}

template <typename Read>
constexpr ObjectAccessor read_only(canopen::Address first, Read /*read*/) {
  return {first.index, first.sub, WritableIn::no_state, get<Read>, nullptr};
}
template <typename Read, typename Write>
constexpr ObjectAccessor read_write(canopen::Address first, WritableIn state, Read /*read*/, Write /*write*/) {
  return {first.index, first.sub, state, get<Read>, set<Write>};
}

/// Accesses a member of ModuleSettings.
template <auto member>
constexpr ObjectAccessor setting(const canopen::Object& entry) {
  return read_write(
      entry.address, WritableIn::pre_operational, [](const Parts& parts) { return parts.settings.*member; },
      [](Parts& parts, const ObjectWrite& write) {
        auto& value = parts.settings.*member;
        value = static_cast<std::remove_reference_t<decltype(value)>>(write.value);
      });
}

/// Accesses an entry that may be written, but whose range has one value only.
template <const canopen::Object& entry>
constexpr ObjectAccessor only_value_row() {
  static_assert(entry.minimum == entry.maximum && entry.default_value == entry.minimum);
  return read_write(
      entry.address, WritableIn::any_state, [](const Parts& /*parts*/) { return entry.default_value; },
      [](Parts& /*parts*/, const ObjectWrite& /*write*/) {});
}

/// Accesses a member of BoardRecord.
template <auto member>
constexpr ObjectAccessor board_setting(const canopen::Object& entry) {
  return read_write(
      entry.address, WritableIn::pre_operational, [](const Parts& parts) { return parts.board.in_force.*member; },
      [](Parts& parts, const ObjectWrite& write) {
        auto& value = parts.board.in_force.*member;
        value = static_cast<std::remove_reference_t<decltype(value)>>(write.value);
      });
}

/// Accesses a member of BoardRecord that is a limit of the joint. A configured joint has taken it over already.
template <auto member>
constexpr ObjectAccessor position_limit(const canopen::Object& entry) {
  return read_write(
      entry.address, WritableIn::pre_operational, [](const Parts& parts) { return parts.board.in_force.*member; },
      [](Parts& parts, const ObjectWrite& write) {
        if (parts.joint.active()) {
          return AbortCode::refused_by_state;
        }
        parts.board.in_force.*member = static_cast<std::int32_t>(write.value);
        return AbortCode::none;
      });
}

constexpr std::uint64_t with_lower_half(std::uint64_t value, std::uint32_t half) { return value >> 32U << 32U | half; }
constexpr std::uint64_t with_upper_half(std::uint64_t value, std::uint32_t half) {
  return std::uint64_t{half} << 32U | static_cast<std::uint32_t>(value);
}

[[gnu::noinline]] std::uint32_t half_frame(const JointKernel& joint, unsigned sender, unsigned channel, unsigned half) {
  if (!joint.active()) {
    return 0;
  }
  return read_little_endian(joint.kernel().frame(sender, channel).bytes, 4 * half, 4);
}
template <unsigned channel, unsigned half>
constexpr ObjectAccessor own_frame() {
  return read_only(object::own_frame[channel][half].address,
                   [](const Parts& parts) { return half_frame(parts.joint, parts.joint.joint(), channel, half); });
}
template <unsigned channel, unsigned half>
constexpr ObjectAccessor received_frame() {
  return read_only(object::received_frame[channel][half].first.address, [](const Parts& parts, Position position) {
    return half_frame(parts.joint, position.index, channel, half);
  });
}

template <unsigned channel>
constexpr ObjectAccessor state_frame_identifier() {
  constexpr std::uint32_t base = channel == 0 ? canopen::identifier::state_frame : canopen::identifier::second_state;
  return read_write(
      object::state_frame_identifier[channel].first.address, WritableIn::pre_operational,
      [](const Parts& parts, Position position) {
        const std::uint8_t node = parts.settings.nodes[channel][position.index];
        return node == 0 ? canopen::pdo_off : base + node;
      },
      [](Parts& parts, const ObjectWrite& write) {
        parts.settings.nodes[channel][write.position.index] =
            static_cast<std::uint8_t>(write.value == canopen::pdo_off ? 0 : write.value - base);
      });
}

// Writes that do more than keep a value.

/// Keeps the status if the kernel has rejected a request. This function and others here are not inlined: each has
/// several callers, and SDO need not be fast.
[[gnu::noinline]] AbortCode answer(Parts& parts, Status status) {
  if (status != Status::ok) {
    parts.joint.keep_refusal(status);
  }
  return abort_code_of(status);
}

/// Sets both limits. limit: the one of them that was written.
[[gnu::noinline]] AbortCode set_limits(Parts& parts, const AngleLimits& limits, std::int32_t limit) {
  if (limit < parts.board.in_force.lowest_angle) {
    return AbortCode::below_minimum;
  }
  if (limit > parts.board.in_force.highest_angle) {
    return AbortCode::above_maximum;
  }
  return answer(parts, parts.joint.set_limits(limits));
}

AbortCode write_sync_identifier(Parts& parts, const ObjectWrite& write) {
  if ((write.value & canopen::produces_sync) == 0) {
    parts.producer.stop();
    return AbortCode::none;
  }
  if (!parts.network.operational()) {
    return AbortCode::refused_by_state;
  }
  parts.producer.start(write.now, parts.joint.kernel().configuration().tick_period_us, parts.joint.configuration_crc());
  return AbortCode::none;
}

AbortCode write_algorithm(Parts& parts, const ObjectWrite& write) {
  const auto id = static_cast<std::uint8_t>(write.value);
  if (id != 0 && find_algorithm(id) == nullptr) {
    return AbortCode::out_of_range;
  }
  parts.settings.algorithms[write.position.sub] = id;
  return AbortCode::none;
}

AbortCode write_activate(Parts& parts, const ObjectWrite& write) {
  const ModuleSettings& settings = parts.settings;
  parts.joint.deactivate();
  parts.neighbours.stop();
  if (write.value == 0) {
    return AbortCode::none;
  }
  if (!StateReceiver::accepts(settings, parts.identity.node)) {
    return AbortCode::general_incompatibility;
  }
  parts.drive.configure({settings.servo_period_us, settings.tick_period_us});
  const Status status = parts.joint.activate(settings, parts.identity.node);
  if (status == Status::ok) {
    const BoardRecord& board = parts.board.in_force;
    static_cast<void>(parts.joint.set_limits({board.lowest_angle, board.highest_angle}));
    parts.neighbours.configure(settings);
    parts.must_restore_communication = false;
  }
  return answer(parts, status);
}

[[gnu::noinline]] AbortCode stage(Parts& parts, const ObjectWrite& write, bool internal) {
  return answer(parts, parts.joint.stage(write.position.sub, write.position.index, internal,
                                         static_cast<std::int32_t>(write.value)));
}

constexpr ObjectAccessor accessors[] = {
    read_only(object::error_register.address, [](const Parts& parts) { return parts.emergencies.error_register(); }),
    read_write(
        object::error_count.address, WritableIn::any_state,
        [](const Parts& parts) { return parts.emergencies.history().size(); },
        [](Parts& parts, const ObjectWrite& write) {
          if (write.value != 0) {
            return AbortCode::out_of_range;
          }
          parts.emergencies.clear_history();
          return AbortCode::none;
        }),
    read_only(object::recent_error.first.address,
              [](const Parts& parts, Position position) { return parts.emergencies.history()[position.sub]; }),
    read_write(
        object::sync_identifier.address, WritableIn::any_state,
        [](const Parts& parts) {
          return canopen::identifier::sync | (parts.producer.runs() ? canopen::produces_sync : 0U);
        },
        [](Parts& parts, const ObjectWrite& write) { return write_sync_identifier(parts, write); }),
    setting<&ModuleSettings::tick_period_us>(object::tick_period),
    read_write(
        object::store_parameters.address, WritableIn::pre_operational,
        [](const Parts& /*parts*/) { return object::store_parameters.default_value; },
        [](Parts& parts, const ObjectWrite& write) { return save_parameters(parts, write.value); }),
    read_write(
        object::restore_parameters.address, WritableIn::pre_operational,
        [](const Parts& /*parts*/) { return object::restore_parameters.default_value; },
        [](Parts& parts, const ObjectWrite& write) { return restore_parameters(parts, write.value); }),
    read_write(
        object::host_heartbeat.address, WritableIn::any_state, [](const Parts& parts) { return parts.host.expected(); },
        [](Parts& parts, const ObjectWrite& write) { parts.expect_heartbeat(write.value); }),
    read_write(
        object::heartbeat_period.address, WritableIn::any_state,
        [](const Parts& parts) { return parts.network.heartbeat_period_ms(); },
        [](Parts& parts, const ObjectWrite& write) {
          parts.network.set_heartbeat_period(write.now, static_cast<std::uint16_t>(write.value));
        }),
    read_only(object::product.address, [](const Parts& parts) { return parts.identity.board_id; }),
    read_only(object::serial.address, [](const Parts& parts) { return serial_number(parts.identity); }),
    only_value_row<object::sync_counter_overflow>(),
    state_frame_identifier<0>(),
    state_frame_identifier<1>(),
    read_only(object::monitoring_transmission_type.address,
              [](const Parts& parts) { return parts.joint.active() ? parts.joint.monitoring_period() : 0U; }),

    read_only(object::core_fingerprint.address, [](const Parts& parts) { return parts.identity.core_fingerprint; }),
    read_only(object::board_id.address, [](const Parts& parts) { return parts.identity.board_id; }),
    read_only(object::capabilities.address, [](const Parts& parts) { return parts.identity.capabilities; }),
    read_only(object::update_key.address, [](const Parts& parts) { return parts.update.key_id(); }),
    setting<&ModuleSettings::joint>(object::joint_index),
    setting<&ModuleSettings::joint_count>(object::joint_count),
    setting<&ModuleSettings::front_node>(object::front_node),
    setting<&ModuleSettings::rear_node>(object::rear_node),
    setting<&ModuleSettings::robot_id>(object::robot_id),
    read_only(object::configuration_crc.address,
              [](const Parts& parts) { return parts.joint.active() ? parts.joint.configuration_crc() : 0U; }),
    read_only(object::current_tick.address,
              [](const Parts& parts) { return parts.joint.active() ? parts.joint.kernel().tick() : 0U; }),
    read_only(object::refusal.address, [](const Parts& parts) { return parts.joint.last_refusal(); }),
    read_write(
        object::session_token.address, WritableIn::any_state, [](const Parts& parts) { return parts.lease.token(); },
        [](Parts& parts, const ObjectWrite& write) {
          return parts.lease.take(write.now, write.value) ? AbortCode::none : AbortCode::refused_by_state;
        }),
    read_only(object::unique_id.first.address,
              [](const Parts& parts, Position position) { return parts.identity.unique_id[position.sub]; }),
    read_write(
        object::transaction.address, WritableIn::configured,
        [](const Parts& parts) { return parts.joint.active() ? parts.joint.kernel().open_transaction() : 0U; },
        [](Parts& parts, const ObjectWrite& write) {
          return answer(parts, parts.joint.open(static_cast<std::uint16_t>(write.value)));
        }),
    read_only(object::staged_count.address,
              [](const Parts& parts) { return parts.joint.active() ? parts.joint.kernel().staged_count() : 0U; }),
    read_write(
        object::seed_low.address, WritableIn::pre_operational, [](const Parts& parts) { return parts.settings.seed; },
        [](Parts& parts, const ObjectWrite& write) {
          parts.settings.seed = with_lower_half(parts.settings.seed, write.value);
        }),
    read_write(
        object::seed_high.address, WritableIn::pre_operational,
        [](const Parts& parts) { return parts.settings.seed >> 32U; },
        [](Parts& parts, const ObjectWrite& write) {
          parts.settings.seed = with_upper_half(parts.settings.seed, write.value);
        }),
    setting<&ModuleSettings::servo_period_us>(object::servo_period),
    read_write(
        object::lower_limit.address, WritableIn::configured_and_pre_operational,
        [](const Parts& parts) { return parts.joint.limits().lower; },
        [](Parts& parts, const ObjectWrite& write) {
          const auto lower = static_cast<std::int32_t>(write.value);
          return set_limits(parts, {lower, parts.joint.limits().upper}, lower);
        }),
    read_write(
        object::upper_limit.address, WritableIn::configured_and_pre_operational,
        [](const Parts& parts) { return parts.joint.limits().upper; },
        [](Parts& parts, const ObjectWrite& write) {
          const auto upper = static_cast<std::int32_t>(write.value);
          return set_limits(parts, {parts.joint.limits().lower, upper}, upper);
        }),
    read_write(
        object::activate.address, WritableIn::pre_operational, [](const Parts& parts) { return parts.joint.active(); },
        [](Parts& parts, const ObjectWrite& write) { return write_activate(parts, write); }),
    read_write(
        object::slot_algorithm.first.address, WritableIn::pre_operational,
        [](const Parts& parts, Position position) { return parts.settings.algorithms[position.sub]; },
        [](Parts& parts, const ObjectWrite& write) { return write_algorithm(parts, write); }),
    read_write(
        object::slot_group_low.first.address, WritableIn::pre_operational,
        [](const Parts& parts, Position position) { return parts.settings.groups[position.sub]; },
        [](Parts& parts, const ObjectWrite& write) {
          std::uint64_t& group = parts.settings.groups[write.position.sub];
          group = with_lower_half(group, write.value);
        }),
    read_write(
        object::slot_group_high.first.address, WritableIn::pre_operational,
        [](const Parts& parts, Position position) { return parts.settings.groups[position.sub] >> 32U; },
        [](Parts& parts, const ObjectWrite& write) {
          std::uint64_t& group = parts.settings.groups[write.position.sub];
          group = with_upper_half(group, write.value);
        }),
    read_only(object::measured_angle.address,
              [](const Parts& parts) { return canopen::monitored_angle(parts.monitor.angle()); }),
    read_only(object::temperature.address, [](const Parts& parts) { return parts.monitor.temperature_c(); }),
    read_only(object::feedback_reading.address,
              [](const Parts& parts) { return parts.monitor.feedback_reading().value_or(canopen::feedback_not_read); }),
    read_only(object::touch_sensors.address, [](const Parts& parts) { return parts.contacts.read_contacts(); }),
    read_write(
        object::current_limit.address, WritableIn::any_state,
        [](const Parts& parts) { return parts.monitor.limit_ma(); },
        [](Parts& parts, const ObjectWrite& write) {
          parts.monitor.set_limit_ma(static_cast<std::uint16_t>(write.value));
        }),
    read_write(
        object::current_limit_time.address, WritableIn::any_state,
        [](const Parts& parts) { return parts.monitor.limit_time_ms(); },
        [](Parts& parts, const ObjectWrite& write) {
          parts.monitor.set_limit_time_ms(static_cast<std::uint16_t>(write.value));
        }),
    read_only(object::lost_frames.address, [](const Parts& parts) { return parts.losses.count(); }),
    read_only(object::frames_not_written.address,
              [](const Parts& parts) { return parts.gateway.frames_not_written(); }),
    read_only(object::frames_not_sent.address, [](const Parts& parts) { return parts.gateway.frames_not_sent(); }),
    read_only(object::wrong_lines.address, [](const Parts& parts) { return parts.gateway.wrong_lines(); }),
    read_write(
        object::setpoint_ticks.address, WritableIn::any_state,
        [](const Parts& parts) { return parts.joint.checksum().taken().ticks; },
        [](Parts& parts, const ObjectWrite& /*write*/) { parts.joint.checksum().take(); }),
    read_only(object::setpoint_crc.address, [](const Parts& parts) { return parts.joint.checksum().taken().crc; }),
    read_write(
        object::ramp_in_speed.address, WritableIn::any_state,
        [](const Parts& parts) { return parts.drive.ramp_in_speed(); },
        [](Parts& parts, const ObjectWrite& write) { parts.drive.set_ramp_in_speed(write.value); }),
    read_only(object::user_algorithm.first.address,
              [](const Parts& /*parts*/, Position position) {
                const ActuationModule* algorithm =
                    find_algorithm(static_cast<std::uint8_t>(first_user_id + position.sub));
                return algorithm == nullptr ? 0U : algorithm->declaration().sources;
              }),
    own_frame<0, 0>(),
    own_frame<0, 1>(),
    own_frame<1, 0>(),
    own_frame<1, 1>(),
    board_setting<&BoardRecord::is_gateway>(object::gateway_role),
    board_setting<&BoardRecord::has_feedback>(object::has_feedback),
    board_setting<&BoardRecord::feedback_at_minus_90>(object::feedback_at_minus_90),
    board_setting<&BoardRecord::feedback_at_plus_90>(object::feedback_at_plus_90),
    received_frame<0, 0>(),
    received_frame<0, 1>(),
    received_frame<1, 0>(),
    received_frame<1, 1>(),

    read_write(
        first_of(ValueKind::parameter), WritableIn::configured_and_pre_operational,
        [](const Parts& parts, Position position) {
          return parts.joint.kernel().parameter(position.sub, parts.joint.joint(), position.index);
        },
        [](Parts& parts, const ObjectWrite& write) {
          return answer(parts, parts.joint.set_parameter(write.position.sub, write.position.index,
                                                         static_cast<std::int32_t>(write.value)));
        }),
    read_write(
        first_of(ValueKind::staged_parameter), WritableIn::open_transaction,
        [](const Parts& parts, Position position) {
          return parts.joint.staged_parameter(position.sub, position.index);
        },
        [](Parts& parts, const ObjectWrite& write) { return stage(parts, write, false); }),
    read_write(
        first_of(ValueKind::internal_value), WritableIn::open_transaction,
        [](const Parts& parts, Position position) {
          return parts.joint.kernel().internal_value(position.sub, parts.joint.joint(), position.index);
        },
        [](Parts& parts, const ObjectWrite& write) { return stage(parts, write, true); }),

    only_value_row<object::abort_connection_option>(),
    read_write(
        object::controlword.address, WritableIn::any_state,
        [](const Parts& parts) { return parts.drive.power().controlword(); },
        [](Parts& parts, const ObjectWrite& write) {
          parts.drive.power().command(static_cast<std::uint16_t>(write.value));
        }),
    read_only(object::statusword.address, [](const Parts& parts) { return parts.drive.statusword(); }),
    only_value_row<object::quick_stop_option>(),
    read_write(
        object::mode.address, WritableIn::any_state, [](const Parts& parts) { return parts.drive.mode(); },
        [](Parts& parts, const ObjectWrite& write) { parts.drive.set_mode(static_cast<std::int8_t>(write.value)); }),
    read_only(object::mode_display.address, [](const Parts& parts) { return parts.drive.mode(); }),
    read_only(object::position_demand.address, [](const Parts& parts) { return parts.drive.setpoint(); }),
    read_only(object::actual_position.address,
              [](const Parts& parts) { return parts.monitor.angle().value_or(canopen::position_not_measured); }),
    read_only(object::actual_current.address, [](const Parts& parts) { return parts.monitor.current_ma(); }),
    read_write(
        object::target_position.address, WritableIn::any_state, [](const Parts& parts) { return parts.drive.target(); },
        [](Parts& parts, const ObjectWrite& write) { parts.drive.set_target(static_cast<std::int32_t>(write.value)); }),
    position_limit<&BoardRecord::lowest_angle>(object::lowest_position),
    position_limit<&BoardRecord::highest_angle>(object::highest_position),
    read_write(
        object::command_speed.address, WritableIn::pre_operational,
        [](const Parts& parts) { return parts.drive.command_speed(); },
        [](Parts& parts, const ObjectWrite& write) { parts.drive.set_command_speed(write.value); }),
};

}  // namespace

std::span<const ObjectAccessor> object_accessors() { return accessors; }

}  // namespace proleg::firmware
