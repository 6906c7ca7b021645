#include "shared/canopen/objects.hpp"

#include <array>
#include <iterator>

#include "shared/gait/registry.hpp"

namespace proleg::canopen {
namespace {

constexpr ObjectRow row(const Object& object) { return {&object, 1, 1, 0}; }
constexpr ObjectRow row(const ObjectArray& array) { return {&array.first, 1, array.count, 0}; }
constexpr ObjectRow row(const JointObjects& series) {
  return {&series.first, JointObjects::count, 1, series.default_step};
}

constexpr ObjectRow declared_rows[] = {
    row(object::device_type),
    row(object::error_register),
    row(object::error_count),
    row(object::recent_error),
    row(object::sync_identifier),
    row(object::tick_period),
    row(object::device_name),
    row(object::hardware_version),
    row(object::software_version),
    row(object::store_parameters),
    row(object::restore_parameters),
    row(object::emergency_identifier),
    row(object::host_heartbeat),
    row(object::heartbeat_period),
    row(object::vendor),
    row(object::product),
    row(object::revision),
    row(object::serial),
    row(object::sync_counter_overflow),
    row(object::sdo_request_identifier),
    row(object::sdo_answer_identifier),
    row(object::command_identifier),
    row(object::command_transmission),
    row(object::state_frame_identifier[0]),
    row(object::state_frame_transmission[0]),
    row(object::state_frame_identifier[1]),
    row(object::state_frame_transmission[1]),
    row(object::command_mapped[0]),
    row(object::command_mapped[1]),
    row(object::received_mapped[0][0]),
    row(object::received_mapped[0][1]),
    row(object::received_mapped[1][0]),
    row(object::received_mapped[1][1]),
    row(object::own_frame_identifier[0]),
    row(object::own_frame_transmission[0]),
    row(object::own_frame_identifier[1]),
    row(object::own_frame_transmission[1]),
    row(object::monitoring_identifier),
    row(object::monitoring_transmission_type),
    row(object::own_mapped[0][0]),
    row(object::own_mapped[0][1]),
    row(object::own_mapped[1][0]),
    row(object::own_mapped[1][1]),
    row(object::monitoring_mapped[0]),
    row(object::monitoring_mapped[1]),
    row(object::monitoring_mapped[2]),
    row(object::monitoring_mapped[3]),
    row(object::version),
    row(object::frame_layout),
    row(object::core_fingerprint),
    row(object::board_id),
    row(object::capabilities),
    row(object::update_key),
    row(object::joint_index),
    row(object::joint_count),
    row(object::front_node),
    row(object::rear_node),
    row(object::robot_id),
    row(object::configuration_crc),
    row(object::current_tick),
    row(object::refusal),
    row(object::session_token),
    row(object::unique_id),
    row(object::transaction),
    row(object::staged_count),
    row(object::seed_low),
    row(object::seed_high),
    row(object::servo_period),
    row(object::lower_limit),
    row(object::upper_limit),
    row(object::activate),
    row(object::slot_algorithm),
    row(object::slot_group_low),
    row(object::slot_group_high),
    row(object::measured_angle),
    row(object::temperature),
    row(object::feedback_reading),
    row(object::touch_sensors),
    row(object::current_limit),
    row(object::current_limit_time),
    row(object::lost_frames),
    row(object::frames_not_written),
    row(object::frames_not_sent),
    row(object::wrong_lines),
    row(object::setpoint_ticks),
    row(object::setpoint_crc),
    row(object::ramp_in_speed),
    row(object::user_algorithm),
    row(object::own_frame[0][0]),
    row(object::own_frame[0][1]),
    row(object::own_frame[1][0]),
    row(object::own_frame[1][1]),
    row(object::gateway_role),
    row(object::has_feedback),
    row(object::feedback_at_minus_90),
    row(object::feedback_at_plus_90),
    row(object::received_frame[0][0]),
    row(object::received_frame[0][1]),
    row(object::received_frame[1][0]),
    row(object::received_frame[1][1]),
    row(object::abort_connection_option),
    row(object::controlword),
    row(object::statusword),
    row(object::quick_stop_option),
    row(object::mode),
    row(object::mode_display),
    row(object::position_demand),
    row(object::actual_position),
    row(object::rated_current),
    row(object::actual_current),
    row(object::target_position),
    row(object::lowest_position),
    row(object::highest_position),
    row(object::command_speed),
    row(object::supported_modes),
};

constexpr const ObjectGroup* declared_groups[] = {
    &object::error_history,
    &object::storing,
    &object::restoring,
    &object::consumer_heartbeat,
    &object::identity,
    &object::sdo_server,
    &object::command_reception,
    &object::frame_receptions[0],
    &object::frame_receptions[1],
    &object::command_mapping,
    &object::frame_reception_mappings[0],
    &object::frame_reception_mappings[1],
    &object::frame_transmissions[0],
    &object::frame_transmissions[1],
    &object::frame_transmission_mappings[0],
    &object::frame_transmission_mappings[1],
    &object::monitoring_transmission,
    &object::monitoring_mapping,
    &object::device,
    &object::place,
    &object::unique_ids,
    &object::staging,
    &object::kernel,
    &object::slot_algorithms,
    &object::slot_groups_low,
    &object::slot_groups_high,
    &object::measured,
    &object::over_current,
    &object::bus_statistics,
    &object::gateway_statistics,
    &object::setpoint_checksum,
    &object::user_algorithms,
    &object::own_frames[0],
    &object::own_frames[1],
    &object::board,
    &object::received_frames[0],
    &object::received_frames[1],
    &object::position_limits,
};

// The image of a module contains the following tables, and nothing that is above this line.

struct Limits {
  std::uint32_t minimum;
  std::uint32_t maximum;
  std::uint32_t also_allowed;  ///< equal to the minimum if no other value is allowed

  friend constexpr bool operator==(const Limits&, const Limits&) = default;
};
constexpr Limits limits_of(const Object& object) {
  return {object.minimum, object.maximum, object.also_allowed.value_or(object.minimum)};
}

constexpr bool has_limits(const ObjectRow& row) {
  const Object& object = *row.first;
  return object.minimum != min_value(object.type) || object.maximum != max_value(object.type) || object.also_allowed;
}

/// The limits of all rows that have some; each pair is in the table once.
struct LimitsTable {
  std::array<Limits, std::size(declared_rows)> ranges{};
  std::size_t count = 0;

  [[nodiscard]] constexpr std::size_t find(const Limits& wanted) const {
    std::size_t position = 0;
    while (position < count && !(ranges[position] == wanted)) {
      ++position;
    }
    return position;
  }
};
constexpr LimitsTable all_limits = [] {
  LimitsTable table;
  for (const ObjectRow& row : declared_rows) {
    const Limits wanted = limits_of(*row.first);
    if (has_limits(row) && table.find(wanted) == table.count) {
      table.ranges[table.count++] = wanted;
    }
  }
  return table;
}();
static_assert(all_limits.count < EntryRow::no_limits);

constexpr std::array limits = [] {
  std::array<Limits, all_limits.count> found{};
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i] = all_limits.ranges[i];
  }
  return found;
}();

constexpr std::array rows = [] {
  std::array<EntryRow, std::size(declared_rows)> packed{};
  for (std::size_t i = 0; i < packed.size(); ++i) {
    const ObjectRow& row = declared_rows[i];
    const Object& first = *row.first;
    packed[i] = {first.address,
                 first.type,
                 first.access,
                 first.adds_node_id,
                 row.indices,
                 row.subs,
                 has_limits(row) ? static_cast<std::uint8_t>(all_limits.find(limits_of(first))) : EntryRow::no_limits,
                 static_cast<std::uint16_t>(row.default_step >> 16U),
                 first.default_value};
  }
  return packed;
}();

struct Group {
  std::uint16_t index;
  ObjectCode code;
  std::uint8_t count;
};
constexpr std::array groups = [] {
  std::array<Group, std::size(declared_groups)> without_texts{};
  for (std::size_t i = 0; i < without_texts.size(); ++i) {
    const ObjectGroup& group = *declared_groups[i];
    without_texts[i] = {group.index, group.code, group.count};
  }
  return without_texts;
}();

constexpr std::uint16_t last_index = rows.back().first.index;

template <typename AnyGroup>
constexpr bool covers(const AnyGroup& group, std::uint16_t index) {
  return index >= group.index && index - group.index < group.count;
}

/// Whether the table is ascending, and has sub-indices only where a group describes the index. A group may declare its
/// sub-index 0.
constexpr bool well_formed() {
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const EntryRow& row = rows[i];
    const ObjectRow& declared = declared_rows[i];
    const Address address = row.first;
    const std::uint32_t position = std::uint32_t{address.index} << 8U | address.sub;
    bool grouped = false;
    for (const Group& group : groups) {
      grouped = grouped || (covers(group, address.index) && group.count == row.indices);
    }
    if (position <= before || (!grouped && address.sub > 0) || (declared.default_step & 0xFFFFU) != 0) {
      return false;
    }
    before = position;
  }
  return true;
}
static_assert(well_formed());

constexpr DataType value_type = DataType::integer32;

/// An entry of one of the ranges that follow from the algorithms' declarations.
Entry value_entry(Address address, const ValueAddress& value) {
  Range range = full_range(value_type);
  std::uint32_t default_value = 0;
  if (value.kind != ValueKind::internal_value) {
    const Parameter& parameter = find_algorithm(value.algorithm)->declaration().parameters[value.number];
    default_value = static_cast<std::uint32_t>(parameter.default_value);
    range = {static_cast<std::uint32_t>(parameter.minimum), static_cast<std::uint32_t>(parameter.maximum)};
  }
  return {address, value_type, Access::read_write, false, default_value, range.minimum, range.maximum, {}};
}

}  // namespace

std::optional<ValueAddress> value_address(Address address) {
  constexpr unsigned first = 0x3000;
  constexpr unsigned range = 0x1000;
  if (address.index < first || address.index >= first + value_kinds * range || address.sub < 1 ||
      address.sub > max_slots) {
    return std::nullopt;
  }
  const ValueAddress value{static_cast<ValueKind>((address.index - first) / range),
                           static_cast<std::uint8_t>(address.index % range / 32U),
                           static_cast<std::uint8_t>(address.index % 32U), static_cast<std::uint8_t>(address.sub - 1)};
  const ActuationModule* algorithm = find_algorithm(value.algorithm);
  if (algorithm == nullptr) {
    return std::nullopt;
  }
  const Declaration& declaration = algorithm->declaration();
  const std::size_t declared =
      value.kind == ValueKind::internal_value ? declaration.internal_values.size() : declaration.parameters.size();
  return value.number < declared ? std::optional(value) : std::nullopt;
}

std::optional<Entry> find_entry(Address address) {
  if (const EntryRow* row = find_row(address)) {
    const std::uint32_t step = std::uint32_t{row->default_step} << 16U;
    Entry entry{address,
                row->type,
                row->access,
                row->adds_node_id,
                row->default_value + step * (std::uint32_t{address.index} - row->first.index),
                min_value(row->type),
                max_value(row->type),
                {}};
    if (row->limits != EntryRow::no_limits) {
      const Limits& found = limits[row->limits];
      entry.minimum = found.minimum;
      entry.maximum = found.maximum;
      if (found.also_allowed != found.minimum) {
        entry.also_allowed = found.also_allowed;
      }
    }
    return entry;
  }
  if (const std::optional<ValueAddress> value = value_address(address)) {
    return value_entry(address, *value);
  }
  if (address.sub == 0) {
    if (const std::optional<IndexInfo> info = find_index(address.index)) {
      return constant(address, {}, DataType::unsigned8, info->max_sub);
    }
  }
  return std::nullopt;
}

AbortCode find_entry(Address address, Entry& entry) {
  if (const std::optional<Entry> found = find_entry(address)) {
    entry = *found;
    return AbortCode::none;
  }
  return index_exists(address.index) ? AbortCode::no_such_sub_index : AbortCode::no_such_object;
}

std::optional<IndexInfo> find_index(std::uint16_t index) {
  for (const Group& group : groups) {
    if (covers(group, index)) {
      std::uint8_t highest = 0;
      while (find_row({index, static_cast<std::uint8_t>(highest + 1)}) != nullptr) {
        ++highest;
      }
      return IndexInfo{group.code, highest};
    }
  }
  if (find_row({index, 0}) != nullptr) {
    return IndexInfo{ObjectCode::variable, 0};
  }
  if (value_address({index, 1})) {
    return IndexInfo{ObjectCode::array, max_slots};
  }
  return std::nullopt;
}

const EntryRow* find_row(Address address) {
  for (const EntryRow& row : rows) {
    if (row.covers(address)) {
      return &row;
    }
  }
  return nullptr;
}

std::span<const ObjectRow> object_rows() { return declared_rows; }

const ObjectGroup* find_group(std::uint16_t index) {
  for (const ObjectGroup* group : declared_groups) {
    if (covers(*group, index)) {
      return group;
    }
  }
  return nullptr;
}

std::optional<Object> find_object(Address address) {
  const std::optional<Entry> entry = find_entry(address);
  if (!entry) {
    return std::nullopt;
  }
  if (const EntryRow* row = find_row(address)) {
    const Object& declared = *declared_rows[row - rows.data()].first;
    return Object{*entry, declared.name, declared.help, declared.text, declared.scale};
  }
  if (const std::optional<ValueAddress> value = value_address(address)) {
    const Declaration& declaration = find_algorithm(value->algorithm)->declaration();
    if (value->kind == ValueKind::internal_value) {
      const InternalValue& internal = declaration.internal_values[value->number];
      return in_unit(scale_of(internal.unit), Object{*entry, internal.name, internal.help});
    }
    const Parameter& parameter = declaration.parameters[value->number];
    return in_unit(scale_of(parameter.unit), Object{*entry, parameter.name, parameter.help});
  }
  return Object{*entry, "Highest sub-index supported", {}};
}

std::optional<Object> next_object(Address address) {
  if (const std::optional<IndexInfo> info = find_index(address.index); info && address.sub < info->max_sub) {
    return find_object({address.index, static_cast<std::uint8_t>(address.sub + 1)});
  }
  for (unsigned index = address.index + 1U; index <= last_index; ++index) {
    if (index_exists(static_cast<std::uint16_t>(index))) {
      return find_object({static_cast<std::uint16_t>(index), 0});
    }
  }
  return std::nullopt;
}

}  // namespace proleg::canopen
