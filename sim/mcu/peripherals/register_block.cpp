#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

std::string RegisterBlock::register_name(std::uint32_t offset) const {
  for (const RegisterName& candidate : registers_) {
    if (candidate.offset == offset) {
      return std::string(name_) + "_" + std::string(candidate.name);
    }
  }
  return Peripheral::register_name(offset);
}

namespace {

/// Text of the offset behind the name of a register; the name of an offset without a register contains it already.
std::string place(const std::string& name, std::uint32_t offset) {
  return name.find(" at offset ") == std::string::npos ? " at offset " + hexadecimal(offset) : std::string();
}

}  // namespace

void RegisterBlock::reject_write(std::uint32_t offset, std::uint32_t value, std::string_view why) const {
  const std::string register_ = register_name(offset);
  throw UnmodelledAccess(register_ + " = " + hexadecimal(value) + place(register_, offset) + ": " + std::string(why));
}

void RegisterBlock::reject_read(std::uint32_t offset, std::string_view why) const {
  const std::string register_ = register_name(offset);
  throw UnmodelledAccess(register_ + place(register_, offset) + ": " + std::string(why));
}

void RegisterBlock::reject_read(std::uint32_t offset) const { reject_read(offset, "reading it is not modelled"); }

void RegisterBlock::reject_write(std::uint32_t offset, std::uint32_t value) const {
  reject_write(offset, value, "writing it is not modelled");
}

void RegisterBlock::reject_bits(std::uint32_t offset, std::uint32_t value, std::uint32_t mask,
                                std::string_view why) const {
  if ((value & mask) != 0) {
    reject_write(offset, value, why);
  }
}

}  // namespace proleg::sim
