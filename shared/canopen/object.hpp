#pragma once

// The entries of the object dictionary in general (CiA 301, section 7.4). declared_objects.hpp declares them.

#include <cstdint>
#include <optional>
#include <string_view>

#include "shared/fixed/unit.hpp"
#include "shared/gait/joint_mask.hpp"

namespace proleg::canopen {

/// Data types (CiA 301, table 44). Numbers fit into an expedited SDO; the last three are long types, with any number of
/// bytes.
enum class DataType : std::uint8_t {
  integer8 = 0x02,
  integer16 = 0x03,
  integer32 = 0x04,
  unsigned8 = 0x05,
  unsigned16 = 0x06,
  unsigned32 = 0x07,
  visible_string = 0x09,  ///< ASCII characters, 0x20 to 0x7E
  octet_string = 0x0A,
  domain = 0x0F,
};

/// Whether values of the type may have any number of bytes.
[[nodiscard]] constexpr bool is_long(DataType type) { return type > DataType::unsigned32; }

/// Size of a type: 1, 2 or 4 bytes; 0 for a long type.
[[nodiscard]] constexpr std::uint8_t size_of(DataType type) {
  switch (type) {
    case DataType::integer8:
    case DataType::unsigned8:
      return 1;
    case DataType::integer16:
    case DataType::unsigned16:
      return 2;
    case DataType::integer32:
    case DataType::unsigned32:
      return 4;
    default:
      return 0;
  }
}

[[nodiscard]] constexpr bool is_signed(DataType type) {
  return type == DataType::integer8 || type == DataType::integer16 || type == DataType::integer32;
}

/// The low bytes of a number, as many as the type has, as 32 bits; signed types are sign-extended. For a long type the
/// number is its size, and all of it is returned.
[[nodiscard]] constexpr std::uint32_t extend(DataType type, std::uint32_t value) {
  if (is_long(type)) {
    return value;
  }
  const unsigned unused = 32U - 8U * size_of(type);
  if (is_signed(type)) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(value << unused) >> unused);
  }
  return (value << unused) >> unused;
}

/// Least value of a type; for a long type, its least number of bytes.
[[nodiscard]] constexpr std::uint32_t min_value(DataType type) {
  return is_signed(type) ? extend(type, 1U << (8U * size_of(type) - 1U)) : 0;
}
[[nodiscard]] constexpr std::uint32_t max_value(DataType type) {
  return is_long(type) ? 0xFFFFFFFF : extend(type, ~min_value(type));
}

/// How SDO may access an entry. `by_pdo`: SDO reads it, and only a receive PDO writes it.
enum class Access : std::uint8_t { read_only, read_write, constant, by_pdo, write_only };

/// Object codes (CiA 301, table 42).
enum class ObjectCode : std::uint8_t { variable = 0x07, array = 0x08, record = 0x09 };

/// Address of an entry: index and sub-index.
struct Address {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  friend constexpr bool operator==(Address, Address) = default;
};

/// An entry without its texts, as a device needs it. Values are 32 bits; signed types are sign-extended.
struct Entry {
  Address address;
  DataType type;
  Access access;
  bool adds_node_id;            ///< the value is always default_value + node id (CiA 306, "$NODEID+")
  std::uint32_t default_value;  ///< of a constant: its value, to which the node id is added if adds_node_id is set
  std::uint32_t minimum;  ///< compared as signed numbers for signed types; for a long type it is a number of bytes
  std::uint32_t maximum;
  std::optional<std::uint32_t> also_allowed;  ///< an allowed value outside minimum to maximum, such as "off"
};

/// An entry with its texts, which only programs on a computer read. A module's image does not contain the texts.
struct Object : Entry {
  std::string_view name;
  std::string_view help;       ///< a short phrase: unit and meaning
  std::string_view text = {};  ///< the value of a constant string
  UnitScale scale = scale_of(Unit::count);
};

/// Gives an object the unit of its value.
[[nodiscard]] constexpr Object in_unit(UnitScale scale, Object object) {
  object.scale = scale;
  return object;
}
/// Gives an object a unit whose scale is 1.
[[nodiscard]] constexpr Object in_unit(const char* symbol, const Object& object) {
  return in_unit(UnitScale{symbol, 1, 1}, object);
}

/// Declares an entry that never changes.
[[nodiscard]] constexpr Object constant(Address address, std::string_view name, DataType type, std::uint32_t value,
                                        std::string_view help = {}) {
  return {{address, type, Access::constant, false, value, min_value(type), max_value(type), {}}, name, help};
}
/// Declares an entry that only the device changes. `usual_value` is 0 if it has none.
[[nodiscard]] constexpr Object read_only(Address address, std::string_view name, DataType type,
                                         std::string_view help = {}, std::uint32_t usual_value = 0) {
  return {{address, type, Access::read_only, false, usual_value, min_value(type), max_value(type), {}}, name, help};
}
/// Declares the identifier `base` + node id of a message of the predefined connection set.
[[nodiscard]] constexpr Object node_identifier(Address address, std::string_view name, std::uint32_t base,
                                               std::string_view help = {}) {
  constexpr DataType type = DataType::unsigned32;
  return {{address, type, Access::read_only, true, base, min_value(type), max_value(type), {}}, name, help};
}
/// Declares a string that never changes.
[[nodiscard]] constexpr Object constant_text(Address address, std::string_view name, std::string_view text,
                                             std::string_view help = {}) {
  Object object = constant(address, name, DataType::visible_string, 0, help);
  object.text = text;
  return object;
}
struct Range {
  std::uint32_t minimum;
  std::uint32_t maximum;
};
[[nodiscard]] constexpr Range full_range(DataType type) { return {min_value(type), max_value(type)}; }
[[nodiscard]] constexpr Object read_write(Address address, std::string_view name, DataType type,
                                          std::uint32_t default_value, Range range, std::string_view help = {},
                                          std::optional<std::uint32_t> also_allowed = std::nullopt) {
  return {{address, type, Access::read_write, false, default_value, range.minimum, range.maximum, also_allowed},
          name,
          help};
}

/// An index with sub-indices, or several such indices with equal entries. Sub-index 0, the highest sub-index supported,
/// follows from the entries; it is declared only where it means something else.
struct ObjectGroup {
  std::uint16_t index;
  ObjectCode code;  ///< array or record
  std::string_view name;
  std::uint8_t count = 1;  ///< number of indices: `index` and those that follow it, one for each joint

  [[nodiscard]] constexpr Address at(std::uint8_t sub) const { return {index, sub}; }
};

/// Equal entries at `count` consecutive sub-indices.
struct ObjectArray {
  Object first;
  std::uint8_t count;

  [[nodiscard]] constexpr Address address(unsigned position) const {
    return {first.address.index, static_cast<std::uint8_t>(first.address.sub + position)};
  }
};

/// Equal entries at 64 consecutive indices, one for each joint.
struct JointObjects {
  Object first;
  std::uint32_t default_step = 0;  ///< default value of an entry minus that of the entry before
  static constexpr std::uint8_t count = max_joints;

  [[nodiscard]] constexpr Address address(unsigned joint) const {
    return {static_cast<std::uint16_t>(first.address.index + joint), first.address.sub};
  }
};

/// Whether `value`, as 32 bits, is less than `other` in the order of the type.
[[nodiscard]] constexpr bool is_less(DataType type, std::uint32_t value, std::uint32_t other) {
  return is_signed(type) ? static_cast<std::int32_t>(value) < static_cast<std::int32_t>(other) : value < other;
}

/// The value of an entry that can have only one; nothing if it depends on the device's state, or for a long type.
[[nodiscard]] constexpr std::optional<std::uint32_t> fixed_value(const Entry& entry, std::uint8_t node) {
  if (entry.adds_node_id) {
    return entry.default_value + node;
  }
  if (entry.access == Access::constant && !is_long(entry.type)) {
    return entry.default_value;
  }
  return std::nullopt;
}

/// The SDO abort codes (CiA 301, table 22).
enum class AbortCode : std::uint32_t {
  none = 0,
  toggle_not_alternated = 0x05030000,
  timeout = 0x05040000,
  unknown_command = 0x05040001,
  invalid_block_size = 0x05040002,
  invalid_sequence_number = 0x05040003,
  crc_error = 0x05040004,
  out_of_memory = 0x05040005,
  unsupported_access = 0x06010000,
  write_only = 0x06010001,
  read_only = 0x06010002,
  no_such_object = 0x06020000,
  not_mappable = 0x06040041,
  pdo_too_long = 0x06040042,
  general_incompatibility = 0x06040043,
  internal_incompatibility = 0x06040047,
  hardware_error = 0x06060000,
  wrong_length = 0x06070010,
  too_long = 0x06070012,
  too_short = 0x06070013,
  no_such_sub_index = 0x06090011,
  out_of_range = 0x06090030,
  above_maximum = 0x06090031,
  below_minimum = 0x06090032,
  maximum_below_minimum = 0x06090036,
  no_connection = 0x060A0023,
  general_error = 0x08000000,
  refused_by_application = 0x08000020,
  refused_by_local_control = 0x08000021,
  refused_by_state = 0x08000022,  ///< abort code "because of the present device state"
  no_dictionary = 0x08000023,
  no_data = 0x08000024,
};

/// A short English phrase that describes the code, for messages; for an unknown code "unknown abort code".
[[nodiscard]] std::string_view describe(AbortCode code);

/// `none` if the declaration allows the value, as 32 bits; else the reason.
[[nodiscard]] constexpr AbortCode check_range(const Entry& entry, std::uint32_t value) {
  if (entry.also_allowed && value == *entry.also_allowed) {
    return AbortCode::none;
  }
  if (is_less(entry.type, value, entry.minimum)) {
    return AbortCode::below_minimum;
  }
  return is_less(entry.type, entry.maximum, value) ? AbortCode::above_maximum : AbortCode::none;
}

}  // namespace proleg::canopen
