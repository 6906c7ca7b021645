#pragma once

// USART2: RM0090, section 30.6.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::usart2 {

inline constexpr std::uintptr_t base = 0x4000'4400;

inline constexpr Register sr{base + 0x00};
inline constexpr std::uint32_t sr_fe = 1U << 1U;  ///< no stop bit
inline constexpr std::uint32_t sr_nf = 1U << 2U;  ///< noise
inline constexpr std::uint32_t sr_ore = 1U << 3U;
inline constexpr std::uint32_t sr_rxne = 1U << 5U;
inline constexpr std::uint32_t sr_tc = 1U << 6U;  ///< all is sent; writing 0 clears it
inline constexpr std::uint32_t sr_txe = 1U << 7U;
inline constexpr std::uintptr_t dr_address = base + 0x04;
inline constexpr Register dr{dr_address};
/// Clock (PCLK1) divided by the baud rate, with 16 samples a bit.
inline constexpr Register brr{base + 0x08};
inline constexpr Register cr1{base + 0x0C};
inline constexpr std::uint32_t cr1_re = 1U << 2U;
inline constexpr std::uint32_t cr1_te = 1U << 3U;
inline constexpr std::uint32_t cr1_idleie = 1U << 4U;
inline constexpr std::uint32_t cr1_txeie = 1U << 7U;
inline constexpr std::uint32_t cr1_ue = 1U << 13U;
inline constexpr Register cr3{base + 0x14};
inline constexpr std::uint32_t cr3_eie = 1U << 0U;  ///< with DMAR: enables an interrupt at FE, NF and ORE
inline constexpr std::uint32_t cr3_dmar = 1U << 6U;
inline constexpr std::uint32_t cr3_dmat = 1U << 7U;

}  // namespace proleg::stm32f405::usart2
