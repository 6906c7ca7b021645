#pragma once

// Analogue to digital converter ADC1: RM0090, section 13.13.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::adc1 {

inline constexpr std::uintptr_t base = 0x4001'2000;

inline constexpr Register sr{base + 0x00};  ///< a 0 clears, a 1 does nothing
inline constexpr std::uint32_t sr_jeoc = 1U << 2U;

inline constexpr Register cr1{base + 0x04};
inline constexpr std::uint32_t cr1_scan = 1U << 8U;

inline constexpr Register cr2{base + 0x08};
inline constexpr std::uint32_t cr2_adon = 1U << 0U;
inline constexpr std::uint32_t cr2_jswstart = 1U << 22U;

/// 3 bits a channel: its sampling time; channels 10 to 18.
inline constexpr Register smpr1{base + 0x0C};
inline constexpr std::uint32_t sampling_84_cycles = 4;
inline constexpr std::uint32_t sampling_480_cycles = 7;
[[nodiscard]] constexpr std::uint32_t smpr1_of(unsigned channel, std::uint32_t sampling) {
  return sampling << (3U * (channel - 10U));
}

/// The injected group; with three conversions it begins with the second of the four places (13.3.9).
inline constexpr Register jsqr{base + 0x38};
[[nodiscard]] constexpr std::uint32_t jsqr_of(unsigned first, unsigned second, unsigned third) {
  constexpr std::uint32_t three_conversions = 2U << 20U;
  return three_conversions | first << 5U | second << 10U | third << 15U;
}
inline constexpr Register jdr1{base + 0x3C};  ///< result of the first conversion
inline constexpr Register jdr2{base + 0x40};
inline constexpr Register jdr3{base + 0x44};
inline constexpr std::uint32_t jdr_mask = 0xFFF;

/// Common to all ADCs.
inline constexpr Register ccr{base + 0x304};
inline constexpr std::uint32_t ccr_adcpre_4 = 1U << 16U;
inline constexpr std::uint32_t ccr_tsvrefe = 1U << 23U;

}  // namespace proleg::stm32f405::adc1
