#include "shared/gait/state_frame.hpp"

#include "shared/fixed/arithmetic.hpp"

namespace proleg {
namespace {

std::size_t position_of(const Declaration& declaration, std::size_t field) {
  std::size_t position = 0;
  for (std::size_t i = 0; i < field; ++i) {
    position += declaration.frame[i].bytes;
  }
  return position;
}

/// The bits of a value that go on the wire, right-aligned.
std::uint32_t to_wire(Unit unit, unsigned bits, std::int32_t value) {
  const unsigned dropped = 32U - bits;
  if (unit == Unit::count) {
    const std::uint32_t largest = 0xFFFFFFFFU >> dropped;
    const std::uint32_t positive = value < 0 ? 0 : static_cast<std::uint32_t>(value);
    return positive > largest ? largest : positive;
  }
  if (dropped == 0) {
    return static_cast<std::uint32_t>(value);
  }
  if (wraps(unit)) {
    return (static_cast<std::uint32_t>(value) + (1U << (dropped - 1))) >> dropped;
  }
  const std::int32_t largest = (1 << (bits - 1)) - 1;
  const auto rounded = static_cast<std::int32_t>(shift_right_rounding(value, dropped));
  return static_cast<std::uint32_t>(rounded > largest ? largest : rounded);
}

void write(StateFrame& frame, std::size_t position, unsigned count, std::uint32_t wire) {
  for (unsigned i = 0; i < count; ++i) {
    frame.bytes[position + i] = static_cast<std::uint8_t>(wire >> (8U * i));
  }
}

}  // namespace

void pack(const Declaration& declaration, const std::int32_t* internal_values, StateFrame& frame) {
  std::size_t position = 0;
  for (const FrameField& field : declaration.frame) {
    const Unit unit = declaration.internal_values[field.internal_value].unit;
    write(frame, position, field.bytes, to_wire(unit, field.bytes * 8U, internal_values[field.internal_value]));
    position += field.bytes;
  }
}

std::int32_t unpack(const Declaration& declaration, std::size_t field, const StateFrame& frame) {
  const FrameField& layout = declaration.frame[field];
  const std::size_t position = position_of(declaration, field);
  std::uint32_t wire = 0;
  for (unsigned i = 0; i < layout.bytes; ++i) {
    wire |= std::uint32_t{frame.bytes[position + i]} << (8U * i);
  }
  const bool low_bits = declaration.internal_values[layout.internal_value].unit == Unit::count;
  return static_cast<std::int32_t>(low_bits ? wire : wire << (32U - layout.bytes * 8U));
}

void repack(const Declaration& declaration, std::size_t field, std::int32_t value, StateFrame& frame) {
  const FrameField& layout = declaration.frame[field];
  const Unit unit = declaration.internal_values[layout.internal_value].unit;
  write(frame, position_of(declaration, field), layout.bytes, to_wire(unit, layout.bytes * 8U, value));
}

}  // namespace proleg
