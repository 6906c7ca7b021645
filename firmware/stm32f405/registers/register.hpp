#pragma once

// Registers of the STM32F405, with the names of its manuals: RM0090 (reference manual, revision 18; each file names its
// sections) and PM0214 (programming manual of the Cortex-M4). Debian has no package with the vendor's headers, and the
// program uses only these few registers.

#include <cstdint>

namespace proleg::stm32f405 {

/// A register of 32 bits, always read and written as a whole word. It has no state: copies are the same register.
class Register {
 public:
  // Always inlined, because code that runs from RAM must not call a function in flash.
  [[gnu::always_inline]] constexpr explicit Register(std::uintptr_t address) : address_(address) {}
  [[nodiscard, gnu::always_inline]] std::uint32_t read() const { return *word(); }
  [[gnu::always_inline]] void write(std::uint32_t value) const { *word() = value; }

  // A read and a write: it may be used only for registers that a single priority writes.
  void set(std::uint32_t bits) const { write(read() | bits); }
  void clear(std::uint32_t bits) const { write(read() & ~bits); }
  /// Writes the bits of a mask; value and mask have their positions in the register.
  void change(std::uint32_t mask, std::uint32_t value) const { write((read() & ~mask) | value); }

  [[nodiscard]] bool has(std::uint32_t bits) const { return (read() & bits) == bits; }

 private:
  [[nodiscard, gnu::always_inline]] volatile std::uint32_t* word() const {
    return reinterpret_cast<volatile std::uint32_t*>(address_);
  }

  std::uintptr_t address_;
};

/// Reads until the bits are set (or clear), at most `reads` times. Returns whether they were.
[[nodiscard]] inline bool wait_until_set(Register reg, std::uint32_t bits, std::uint32_t reads) {
  while (reads != 0) {
    if (reg.has(bits)) {
      return true;
    }
    --reads;
  }
  return false;
}

[[nodiscard]] inline bool wait_until_clear(Register reg, std::uint32_t bits, std::uint32_t reads) {
  while (reads != 0) {
    if ((reg.read() & bits) == 0) {
      return true;
    }
    --reads;
  }
  return false;
}

}  // namespace proleg::stm32f405
