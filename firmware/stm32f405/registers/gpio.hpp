#pragma once

// General-purpose inputs and outputs: RM0090, section 8.4.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405 {

/// One of the ports A to I.
class GpioPort {
 public:
  constexpr explicit GpioPort(char letter) : base_(0x4002'0000 + 0x400 * static_cast<std::uintptr_t>(letter - 'A')) {}

  [[nodiscard]] constexpr Register moder() const { return Register(base_ + 0x00); }    ///< 2 bits a pin: mode
  [[nodiscard]] constexpr Register ospeedr() const { return Register(base_ + 0x08); }  ///< 2 bits a pin: output speed
  [[nodiscard]] constexpr Register pupdr() const { return Register(base_ + 0x0C); }    ///< 2 bits a pin: pull
  [[nodiscard]] constexpr Register idr() const { return Register(base_ + 0x10); }      ///< a bit a pin: its level
  [[nodiscard]] constexpr Register bsrr() const { return Register(base_ + 0x18); }     ///< bits 0-15 set, 16-31 reset
  /// 4 bits a pin: alternate function; of pins 0-7, and of 8-15.
  [[nodiscard]] constexpr Register afr(unsigned pin) const { return Register(base_ + (pin < 8 ? 0x20 : 0x24)); }

 private:
  std::uintptr_t base_;
};

}  // namespace proleg::stm32f405
