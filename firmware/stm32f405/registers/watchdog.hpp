#pragma once

// Independent watchdog: RM0090, section 21.4.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::iwdg {

inline constexpr std::uintptr_t base = 0x4000'3000;

inline constexpr Register kr{base + 0x00};
inline constexpr std::uint32_t kr_start = 0xCCCC;
inline constexpr std::uint32_t kr_unlock = 0x5555;
inline constexpr std::uint32_t kr_feed = 0xAAAA;
inline constexpr Register pr{base + 0x04};
inline constexpr std::uint32_t pr_16 = 2;  ///< LSI / 16
inline constexpr Register rlr{base + 0x08};
inline constexpr Register sr{base + 0x0C};
inline constexpr std::uint32_t sr_updating = 3;  ///< PR or RLR is being loaded

}  // namespace proleg::stm32f405::iwdg
