#pragma once

// Reset and clock control: RM0090, section 7.3.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::rcc {

inline constexpr std::uintptr_t base = 0x4002'3800;

inline constexpr Register cr{base + 0x00};
inline constexpr std::uint32_t cr_hseon = 1U << 16U;
inline constexpr std::uint32_t cr_hserdy = 1U << 17U;
inline constexpr std::uint32_t cr_csson = 1U << 19U;  ///< clock security system (7.2.7)
inline constexpr std::uint32_t cr_pllon = 1U << 24U;
inline constexpr std::uint32_t cr_pllrdy = 1U << 25U;

/// Factors of the PLL: f(VCO) = f(HSE) / M * N, f(SYSCLK) = f(VCO) / P, f(48 MHz) = f(VCO) / Q.
inline constexpr Register pllcfgr{base + 0x04};
inline constexpr std::uint32_t pllcfgr_pllsrc_hse = 1U << 22U;
/// Fields M, N, P, source and Q; the bits between are reserved and must not change.
inline constexpr std::uint32_t pllcfgr_mask = 0x0F43'7FFF;
[[nodiscard]] constexpr std::uint32_t pllcfgr_of(std::uint32_t m, std::uint32_t n, std::uint32_t p, std::uint32_t q) {
  return m | n << 6U | (p / 2U - 1U) << 16U | q << 24U;
}

inline constexpr Register cfgr{base + 0x08};
inline constexpr std::uint32_t cfgr_sw_mask = 3U;
inline constexpr std::uint32_t cfgr_sw_hsi = 0U;
inline constexpr std::uint32_t cfgr_sw_pll = 2U;
inline constexpr std::uint32_t cfgr_sws_mask = 3U << 2U;
inline constexpr std::uint32_t cfgr_sws_pll = 2U << 2U;
inline constexpr std::uint32_t cfgr_prescalers_mask = 0x0000'FCF0;
inline constexpr std::uint32_t cfgr_hpre_1 = 0U << 4U;
inline constexpr std::uint32_t cfgr_ppre1_4 = 5U << 10U;
inline constexpr std::uint32_t cfgr_ppre2_2 = 4U << 13U;

inline constexpr Register cir{base + 0x0C};
/// The clock security system has detected that the crystal has stopped.
inline constexpr std::uint32_t cir_cssf = 1U << 7U;

inline constexpr Register ahb1enr{base + 0x30};
inline constexpr std::uint32_t ahb1enr_gpioa = 1U << 0U;
inline constexpr std::uint32_t ahb1enr_gpiob = 1U << 1U;
inline constexpr std::uint32_t ahb1enr_gpioc = 1U << 2U;
inline constexpr std::uint32_t ahb1enr_dma1 = 1U << 21U;
inline constexpr std::uint32_t ahb1enr_dma2 = 1U << 22U;

inline constexpr Register apb1enr{base + 0x40};
inline constexpr std::uint32_t apb1enr_tim2 = 1U << 0U;
inline constexpr std::uint32_t apb1enr_tim3 = 1U << 1U;
inline constexpr std::uint32_t apb1enr_tim5 = 1U << 3U;
inline constexpr std::uint32_t apb1enr_usart2 = 1U << 17U;
inline constexpr std::uint32_t apb1enr_can1 = 1U << 25U;
inline constexpr std::uint32_t apb1enr_pwr = 1U << 28U;

inline constexpr Register apb2enr{base + 0x44};
inline constexpr std::uint32_t apb2enr_adc1 = 1U << 8U;

/// Flags of the causes of resets; they accumulate until RMVF clears them.
inline constexpr Register csr{base + 0x74};
inline constexpr std::uint32_t csr_rmvf = 1U << 24U;
inline constexpr std::uint32_t csr_borrstf = 1U << 25U;
inline constexpr std::uint32_t csr_pinrstf = 1U << 26U;
inline constexpr std::uint32_t csr_porrstf = 1U << 27U;
inline constexpr std::uint32_t csr_sftrstf = 1U << 28U;
inline constexpr std::uint32_t csr_iwdgrstf = 1U << 29U;

}  // namespace proleg::stm32f405::rcc
