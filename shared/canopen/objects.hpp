#pragma once

// The object dictionary of a joint module, declared once: the module's SDO server, the host's names, the EDS and
// docs/objects.md are made from it.
//
// The entries with fixed addresses are the constants of namespace `object` (declared_objects.hpp). Three ranges follow
// from the algorithms' declarations (shared/gait). Index 0x3000 + 32 * algorithm id + parameter number, sub-index =
// slot 1 to 4, is the value of a parameter in force; 0x4000 + ... is the staged value. 0x5000 + 32 * algorithm id +
// number is an internal value; a write stages a distortion.

#include <optional>
#include <span>

#include "shared/canopen/declared_objects.hpp"

namespace proleg::canopen {

/// The kinds of values in these three ranges.
enum class ValueKind : std::uint8_t { parameter, staged_parameter, internal_value };
inline constexpr unsigned value_kinds = 3;
struct ValueAddress {
  ValueKind kind;
  std::uint8_t algorithm;  ///< id of the algorithm
  std::uint8_t number;     ///< number of the parameter or internal value
  std::uint8_t slot;       ///< 0 to 3

  friend constexpr bool operator==(const ValueAddress&, const ValueAddress&) = default;
};
[[nodiscard]] constexpr Address address_of(const ValueAddress& value) {
  const auto base = static_cast<std::uint16_t>(0x3000 + 0x1000 * static_cast<unsigned>(value.kind));
  return {static_cast<std::uint16_t>(base + 32U * value.algorithm + value.number),
          static_cast<std::uint8_t>(value.slot + 1)};
}
/// Finds the value at an address. Nothing for an address outside the ranges, of an algorithm that is not in the
/// registry or a number that the algorithm does not declare, or for sub-index 0 or above 4.
[[nodiscard]] std::optional<ValueAddress> value_address(Address address);

/// The entry at an address, also in the ranges; nothing if it is absent.
[[nodiscard]] std::optional<Entry> find_entry(Address address);
/// Finds the entry at an address; `no_such_object` or `no_such_sub_index` if it is absent.
[[nodiscard]] AbortCode find_entry(Address address, Entry& entry);

/// Description of an index.
struct IndexInfo {
  ObjectCode code;
  std::uint8_t max_sub;  ///< 0 for a variable; else all sub-indices up to it exist
};
[[nodiscard]] std::optional<IndexInfo> find_index(std::uint16_t index);
/// Whether any sub-index of the index exists.
[[nodiscard]] inline bool index_exists(std::uint16_t index) { return find_index(index).has_value(); }

/// Equal entries at `indices` consecutive indices and `subs` consecutive sub-indices. This is the form in a module's
/// flash, with 16 bytes for each row. find_entry() unpacks them.
struct EntryRow {
  Address first;
  DataType type;
  Access access;
  bool adds_node_id;
  std::uint8_t indices;
  std::uint8_t subs;
  std::uint8_t limits;         ///< position in the table of limits; `no_limits`: the limits are those of the type
  std::uint16_t default_step;  ///< default value at an index minus that at the index before, in units of 0x10000
  std::uint32_t default_value;

  static constexpr std::uint8_t no_limits = 0xFF;

  [[nodiscard]] constexpr bool covers(Address address) const {
    return address.index >= first.index && address.index - first.index < indices && address.sub >= first.sub &&
           address.sub - first.sub < subs;
  }
};
/// The row with the address; null if it is absent, as for sub-index 0 of a group and for the ranges.
[[nodiscard]] const EntryRow* find_row(Address address);

// Entries with texts, for programs on a computer.

/// Entries of namespace `object` as they are declared, in ascending order of their first index and sub-index.
struct ObjectRow {
  const Object* first;
  std::uint8_t indices;
  std::uint8_t subs;
  std::uint32_t default_step;
};
[[nodiscard]] std::span<const ObjectRow> object_rows();
/// The group with the index; null for a variable and in the ranges.
[[nodiscard]] const ObjectGroup* find_group(std::uint16_t index);
/// The entry at an address with its texts; nothing if it is absent.
[[nodiscard]] std::optional<Object> find_object(Address address);

/// The entry with the next address, in the order of index and sub-index; nothing after the last. It searches.
[[nodiscard]] std::optional<Object> next_object(Address address);

/// Calls visit(object) for every entry, ascending by index and sub-index.
template <typename Visitor>
void for_each_object(Visitor&& visit) {
  for (std::optional<Object> object = find_object(object::device_type.address); object;
       object = next_object(object->address)) {
    visit(*object);
  }
}

}  // namespace proleg::canopen
