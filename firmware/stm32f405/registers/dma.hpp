#pragma once

// Direct memory access: RM0090, section 10.5. Streams and channels: tables 42 (DMA1) and 43 (DMA2).

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::dma {

inline constexpr std::uintptr_t dma1 = 0x4002'6000;
inline constexpr std::uintptr_t dma2 = 0x4002'6400;

/// A stream, 0 to 7, of a controller.
struct Stream {
  Register cr, ndtr, par, m0ar;
  Register flags;          ///< LISR or HISR
  Register clear;          ///< LIFCR or HIFCR: writing 1 clears the flag
  std::uint32_t position;  ///< position of the stream's flags in these registers

  constexpr Stream(std::uintptr_t controller, unsigned number)
      : cr(controller + 0x10 + 0x18 * number),
        ndtr(controller + 0x14 + 0x18 * number),
        par(controller + 0x18 + 0x18 * number),
        m0ar(controller + 0x1C + 0x18 * number),
        flags(controller + (number < 4 ? 0x00 : 0x04)),
        clear(controller + (number < 4 ? 0x08 : 0x0C)),
        position(6U * (number % 2U) + 16U * (number % 4U / 2U)) {}

  [[nodiscard]] bool has(std::uint32_t flag) const { return flags.has(flag << position); }
  void clear_flags(std::uint32_t mask) const { clear.write(mask << position); }
};

inline constexpr std::uint32_t cr_en = 1U << 0U;
inline constexpr std::uint32_t cr_htie = 1U << 3U;
inline constexpr std::uint32_t cr_tcie = 1U << 4U;
inline constexpr std::uint32_t cr_to_peripheral = 1U << 6U;
inline constexpr std::uint32_t cr_circ = 1U << 8U;
inline constexpr std::uint32_t cr_minc = 1U << 10U;
inline constexpr std::uint32_t cr_psize_16 = 1U << 11U;
inline constexpr std::uint32_t cr_msize_16 = 1U << 13U;
[[nodiscard]] constexpr std::uint32_t cr_channel(unsigned channel) { return channel << 25U; }

inline constexpr std::uint32_t flag_half = 1U << 4U;      ///< half of the buffer is done
inline constexpr std::uint32_t flag_complete = 1U << 5U;  ///< all of the buffer is done
inline constexpr std::uint32_t all_flags = 0x3D;

}  // namespace proleg::stm32f405::dma
