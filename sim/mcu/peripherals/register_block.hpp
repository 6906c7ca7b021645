#pragma once

// Common parts of the peripherals: names of registers, rejections, a line into the NVIC.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "shared/computer/text/text.hpp"
#include "sim/mcu/peripherals/peripheral.hpp"

namespace proleg::sim {

[[nodiscard]] constexpr bool bit(std::uint32_t value, unsigned number) { return ((value >> number) & 1U) != 0; }
/// Value of the `width` bits from bit `lowest` on.
[[nodiscard]] constexpr std::uint32_t field(std::uint32_t value, unsigned lowest, unsigned width) {
  return (value >> lowest) & ((std::uint32_t{1} << width) - 1);
}

struct RegisterName {
  std::uint32_t offset;
  std::string_view name;  ///< without the name of the peripheral: "BRR"
};

/// A peripheral with names for its registers.
class RegisterBlock : public Peripheral {
 public:
  [[nodiscard]] std::string_view name() const final { return name_; }
  [[nodiscard]] std::uint32_t base() const final { return base_; }
  [[nodiscard]] std::uint32_t size() const final { return size_; }
  [[nodiscard]] std::string register_name(std::uint32_t offset) const override;

 protected:
  /// registers must outlive the block. Constructors do not use the chip, which may be under construction.
  RegisterBlock(ChipServices& chip, std::string_view name, std::uint32_t base, std::uint32_t size,
                std::span<const RegisterName> registers)
      : chip_(&chip), name_(name), base_(base), size_(size), registers_(registers) {}

  [[nodiscard]] ChipServices& chip() const { return *chip_; }

  /// Both throw UnmodelledAccess: "USART2_CR3 = 0x40 at offset 0x14: DMA is not modelled".
  [[noreturn]] void reject_write(std::uint32_t offset, std::uint32_t value, std::string_view why) const;
  [[noreturn]] void reject_read(std::uint32_t offset, std::string_view why) const;
  /// Both throw UnmodelledAccess for an offset that read() or write() does not model.
  [[noreturn]] void reject_read(std::uint32_t offset) const;
  [[noreturn]] void reject_write(std::uint32_t offset, std::uint32_t value) const;
  /// Rejects a write that sets one of the bits of `mask`.
  void reject_bits(std::uint32_t offset, std::uint32_t value, std::uint32_t mask, std::string_view why) const;

 private:
  ChipServices* chip_;
  std::string_view name_;
  std::uint32_t base_;
  std::uint32_t size_;
  std::span<const RegisterName> registers_;
};

/// The line of a peripheral into the NVIC; it passes on only changes.
class InterruptLine {
 public:
  InterruptLine(ChipServices& chip, unsigned position) : chip_(&chip), position_(position) {}

  void set(bool high) {
    if (high != high_) {
      high_ = high;
      chip_->set_interrupt(position_, high);
    }
  }

 private:
  ChipServices* chip_;
  unsigned position_;
  bool high_ = false;
};

}  // namespace proleg::sim
