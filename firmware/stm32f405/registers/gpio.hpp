#pragma once

// General-purpose inputs and outputs: RM0090, section 8.4.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405 {

/// One of the ports A to I.
class GpioPort {
 public:
  constexpr explicit GpioPort(char letter) : base_(0x4002'0000 + 0x400 * static_cast<std::uintptr_t>(letter - 'A')) {}

  [[nodiscard]] constexpr Register moder() const { return Register(base_ + 0x00); }    ///< mode, 2 bits for each pin
  [[nodiscard]] constexpr Register ospeedr() const { return Register(base_ + 0x08); }  ///< output speed, 2 bits a pin
  [[nodiscard]] constexpr Register pupdr() const { return Register(base_ + 0x0C); }    ///< pull, 2 bits for each pin
  [[nodiscard]] constexpr Register idr() const { return Register(base_ + 0x10); }      ///< level, a bit for each pin
  [[nodiscard]] constexpr Register bsrr() const { return Register(base_ + 0x18); }     ///< bits 0-15 set, 16-31 reset
  /// Alternate function, 4 bits for each pin: one register for pins 0-7, another for pins 8-15.
  [[nodiscard]] constexpr Register afr(unsigned pin) const { return Register(base_ + (pin < 8 ? 0x20 : 0x24)); }

 private:
  std::uintptr_t base_;
};

}  // namespace proleg::stm32f405
