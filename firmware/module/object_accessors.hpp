#pragma once

// How SDO reads and writes the module. One row stands for a declared entry of the object dictionary (shared/canopen),
// or for a series of similar entries. An entry whose declaration gives its value (canopen::fixed_value) has no row.

#include <span>

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Position of an entry in its series: steps of index and sub-index from the first one; both 0 for a single entry. In a
/// range of values: the number of the parameter or internal value, and the slot.
struct Position {
  std::uint16_t index = 0;
  std::uint16_t sub = 0;
};

/// The states in which SDO may write an entry. In others the module rejects the write with `refused_by_state`.
enum class WritableIn : std::uint8_t {
  no_state,
  any_state,
  configured,  ///< after `activate`
  pre_operational,
  configured_and_pre_operational,
  open_transaction,
};

/// A write of a value that has passed the declared range.
struct ObjectWrite {
  Position position;
  std::uint32_t value = 0;  ///< signed types are sign-extended
  Microseconds now = 0;
};

/// A row of the table. The functions of a range are called only if the joint's slot has the algorithm.
struct ObjectAccessor {
  using Get = std::uint32_t (*)(const Parts& parts, Position position);
  using Set = canopen::AbortCode (*)(Parts& parts, const ObjectWrite& write);

  std::uint16_t index = 0;  ///< index of the first entry of the series
  std::uint8_t sub = 0;
  WritableIn writable_in = WritableIn::no_state;
  Get get = nullptr;
  Set set = nullptr;  ///< null: SDO does not write the entry

  [[nodiscard]] constexpr canopen::Address first() const { return {index, sub}; }
};

/// Address of the first entry of a range of values (shared/canopen/objects.hpp).
[[nodiscard]] constexpr canopen::Address first_of(canopen::ValueKind range) {
  return canopen::address_of({range, 0, 0, 0});
}

/// The table of all rows.
[[nodiscard]] std::span<const ObjectAccessor> object_accessors();

}  // namespace proleg::firmware
