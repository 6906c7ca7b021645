#pragma once

// USART2: RM0090, section 30.6.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::usart2 {

inline constexpr std::uintptr_t base = 0x4000'4400;

inline constexpr Register sr{base + 0x00};
inline constexpr std::uint32_t sr_txe = 1U << 7U;
inline constexpr Register dr{base + 0x04};
/// The clock (PCLK1) divided by the baud rate, with 16 samples a bit.
inline constexpr Register brr{base + 0x08};
inline constexpr Register cr1{base + 0x0C};
inline constexpr std::uint32_t cr1_te = 1U << 3U;
inline constexpr std::uint32_t cr1_txeie = 1U << 7U;
inline constexpr std::uint32_t cr1_ue = 1U << 13U;

}  // namespace proleg::stm32f405::usart2
