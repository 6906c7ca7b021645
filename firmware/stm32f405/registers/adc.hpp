#pragma once

// Analogue to digital converter ADC1: RM0090, section 13.13.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::adc1 {

inline constexpr std::uintptr_t base = 0x4001'2000;

inline constexpr Register sr{base + 0x00};  ///< a 0 clears, a 1 does nothing
inline constexpr std::uint32_t sr_eoc = 1U << 1U;
inline constexpr std::uint32_t sr_jeoc = 1U << 2U;
inline constexpr std::uint32_t sr_ovr = 1U << 5U;  ///< a result was lost: there are no triggers and no DMA (13.8.1)

inline constexpr Register cr1{base + 0x04};
inline constexpr std::uint32_t cr1_scan = 1U << 8U;

inline constexpr Register cr2{base + 0x08};
inline constexpr std::uint32_t cr2_adon = 1U << 0U;
inline constexpr std::uint32_t cr2_dma = 1U << 8U;
inline constexpr std::uint32_t cr2_dds = 1U << 9U;  ///< DMA requests continue after the end of the buffer
inline constexpr std::uint32_t cr2_jswstart = 1U << 22U;
inline constexpr std::uint32_t cr2_extsel_tim3_trgo = 8U << 24U;
inline constexpr std::uint32_t cr2_exten_rising = 1U << 28U;

/// Sampling times of channels 10 to 18, 3 bits for each channel.
inline constexpr Register smpr1{base + 0x0C};
inline constexpr std::uint32_t sampling_84_cycles = 4;
inline constexpr std::uint32_t sampling_480_cycles = 7;
[[nodiscard]] constexpr std::uint32_t smpr1_of(unsigned channel, std::uint32_t sampling) {
  return sampling << (3U * (channel - 10U));
}

/// The regular group: SQR1 = 0 is one conversion, SQR3 its channel.
inline constexpr Register sqr1{base + 0x2C};
inline constexpr Register sqr3{base + 0x34};
/// The injected group. With two conversions it begins with the third of the four places (13.3.9).
inline constexpr Register jsqr{base + 0x38};
[[nodiscard]] constexpr std::uint32_t jsqr_of(unsigned first, unsigned second) {
  constexpr std::uint32_t two_conversions = 1U << 20U;
  return two_conversions | first << 10U | second << 15U;
}
inline constexpr Register jdr1{base + 0x3C};  ///< result of the first conversion
inline constexpr Register jdr2{base + 0x40};
inline constexpr std::uint32_t jdr_mask = 0xFFF;

inline constexpr std::uintptr_t dr = base + 0x4C;  ///< result of the regular group; DMA reads it

/// Register that all ADCs share.
inline constexpr Register ccr{base + 0x304};
inline constexpr std::uint32_t ccr_adcpre_4 = 1U << 16U;
inline constexpr std::uint32_t ccr_tsvrefe = 1U << 23U;

}  // namespace proleg::stm32f405::adc1
