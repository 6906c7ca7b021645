#include "shared/gait/state_frame.hpp"

#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg {
namespace {

std::size_t position_of(const Declaration& declaration, std::size_t field) {
  std::size_t position = 0;
  for (std::size_t i = 0; i < field; ++i) {
    position += declaration.frame[i].bytes;
  }
  return position;
}

/// The bits of a value that are sent, right-aligned.
std::uint32_t to_wire(Unit unit, unsigned bits, std::int32_t value) {
  const unsigned dropped = 32U - bits;
  if (unit == Unit::count) {
    const std::uint32_t max_count = 0xFFFFFFFFU >> dropped;
    return std::min(static_cast<std::uint32_t>(std::max<std::int32_t>(value, 0)), max_count);
  }
  if (dropped == 0) {
    return static_cast<std::uint32_t>(value);
  }
  if (wraps(unit)) {
    return (static_cast<std::uint32_t>(value) + (1U << (dropped - 1))) >> dropped;
  }
  const std::int32_t max_angle = (1 << (bits - 1)) - 1;
  return static_cast<std::uint32_t>(
      std::min(static_cast<std::int32_t>(shift_right_rounding(value, dropped)), max_angle));
}

}  // namespace

void pack(const Declaration& declaration, const std::int32_t* internal_values, StateFrame& frame) {
  std::size_t position = 0;
  for (const FrameField& field : declaration.frame) {
    const Unit unit = declaration.internal_values[field.internal_value].unit;
    write_little_endian(frame.bytes, position, field.bytes,
                        to_wire(unit, field.bytes * 8U, internal_values[field.internal_value]));
    position += field.bytes;
  }
}

std::int32_t unpack(const Declaration& declaration, std::size_t field, const StateFrame& frame) {
  const FrameField& layout = declaration.frame[field];
  const std::size_t position = position_of(declaration, field);
  const std::uint32_t wire = read_little_endian(frame.bytes, position, layout.bytes);
  const bool low_bits = declaration.internal_values[layout.internal_value].unit == Unit::count;
  return static_cast<std::int32_t>(low_bits ? wire : wire << (32U - layout.bytes * 8U));
}

void repack(const Declaration& declaration, std::size_t field, std::int32_t value, StateFrame& frame) {
  const FrameField& layout = declaration.frame[field];
  const Unit unit = declaration.internal_values[layout.internal_value].unit;
  write_little_endian(frame.bytes, position_of(declaration, field), layout.bytes,
                      to_wire(unit, layout.bytes * 8U, value));
}

}  // namespace proleg
