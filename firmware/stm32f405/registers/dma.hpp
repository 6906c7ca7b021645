#pragma once

// Direct memory access, DMA2, stream 0: RM0090, section 10.5. Channel 0 of it is ADC1 (table 43).

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::dma2 {

inline constexpr std::uintptr_t base = 0x4002'6400;

inline constexpr Register s0cr{base + 0x10};
inline constexpr std::uint32_t cr_en = 1U << 0U;
inline constexpr std::uint32_t cr_circ = 1U << 8U;
inline constexpr std::uint32_t cr_minc = 1U << 10U;
inline constexpr std::uint32_t cr_psize_16 = 1U << 11U;
inline constexpr std::uint32_t cr_msize_16 = 1U << 13U;
inline constexpr Register s0ndtr{base + 0x14};  ///< transfers until the end of the buffer
inline constexpr Register s0par{base + 0x18};
inline constexpr Register s0m0ar{base + 0x1C};

}  // namespace proleg::stm32f405::dma2
