#pragma once

// General-purpose timers, of which TIM2 and TIM5 count 32 bits, TIM3 16: RM0090, section 18.4.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405 {

class Timer {
 public:
  constexpr explicit Timer(std::uintptr_t base) : base_(base) {}

  [[nodiscard]] constexpr Register cr1() const { return Register(base_ + 0x00); }
  static constexpr std::uint32_t cr1_cen = 1U << 0U;
  static constexpr std::uint32_t cr1_urs = 1U << 2U;  ///< UG sets no flag
  static constexpr std::uint32_t cr1_arpe = 1U << 7U;

  [[nodiscard]] constexpr Register cr2() const { return Register(base_ + 0x04); }
  static constexpr std::uint32_t cr2_mms_update = 2U << 4U;  ///< TRGO with each update

  [[nodiscard]] constexpr Register dier() const { return Register(base_ + 0x0C); }
  static constexpr std::uint32_t dier_cc1ie = 1U << 1U;

  /// Flags. Writing 0 clears a flag, writing 1 does nothing.
  [[nodiscard]] constexpr Register sr() const { return Register(base_ + 0x10); }
  static constexpr std::uint32_t sr_uif = 1U << 0U;
  static constexpr std::uint32_t sr_cc1if = 1U << 1U;

  [[nodiscard]] constexpr Register egr() const { return Register(base_ + 0x14); }
  static constexpr std::uint32_t egr_ug = 1U << 0U;

  [[nodiscard]] constexpr Register ccmr1() const { return Register(base_ + 0x18); }
  static constexpr std::uint32_t ccmr1_oc1pe = 1U << 3U;
  static constexpr std::uint32_t ccmr1_oc1m_pwm1 = 6U << 4U;

  [[nodiscard]] constexpr Register ccer() const { return Register(base_ + 0x20); }
  static constexpr std::uint32_t ccer_cc1e = 1U << 0U;

  /// Always inlined, because code that runs from RAM uses it.
  [[nodiscard, gnu::always_inline]] constexpr Register cnt() const { return Register(base_ + 0x24); }
  [[nodiscard]] constexpr Register psc() const { return Register(base_ + 0x28); }  ///< divides by its value + 1
  [[nodiscard]] constexpr Register arr() const { return Register(base_ + 0x2C); }  ///< the last count before it wraps
  [[nodiscard]] constexpr Register ccr1() const { return Register(base_ + 0x34); }

 private:
  std::uintptr_t base_;
};

inline constexpr Timer tim2{0x4000'0000};
inline constexpr Timer tim3{0x4000'0400};
inline constexpr Timer tim5{0x4000'0C00};

}  // namespace proleg::stm32f405
