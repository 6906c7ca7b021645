#pragma once

// Power controller: RM0090, section 5.4. External interrupts: section 12.3.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405 {

namespace pwr {

inline constexpr std::uintptr_t base = 0x4000'7000;

inline constexpr Register cr{base + 0x00};
inline constexpr std::uint32_t cr_pvde = 1U << 4U;
inline constexpr std::uint32_t cr_pls_mask = 7U << 5U;
inline constexpr std::uint32_t cr_pls_2v5 = 3U << 5U;
inline constexpr std::uint32_t cr_pls_2v8 = 6U << 5U;
inline constexpr std::uint32_t cr_pls_2v9 = 7U << 5U;

inline constexpr Register csr{base + 0x04};
inline constexpr std::uint32_t csr_pvdo = 1U << 2U;  ///< the supply is below the threshold

}  // namespace pwr

namespace exti {

inline constexpr std::uintptr_t base = 0x4001'3C00;
inline constexpr std::uint32_t line_pvd = 1U << 16U;

inline constexpr Register imr{base + 0x00};
inline constexpr Register rtsr{base + 0x08};
inline constexpr Register ftsr{base + 0x0C};
inline constexpr Register pr{base + 0x14};  ///< writing 1 clears a flag

}  // namespace exti
}  // namespace proleg::stm32f405
