#pragma once

// Flash interface: RM0090, section 3.9.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::flash_interface {

inline constexpr std::uintptr_t base = 0x4002'3C00;

inline constexpr Register acr{base + 0x00};
inline constexpr std::uint32_t acr_latency_mask = 7U;
inline constexpr std::uint32_t acr_prften = 1U << 8U;
inline constexpr std::uint32_t acr_icen = 1U << 9U;
inline constexpr std::uint32_t acr_dcen = 1U << 10U;
inline constexpr std::uint32_t acr_icrst = 1U << 11U;  ///< may be set only while ICEN = 0
inline constexpr std::uint32_t acr_dcrst = 1U << 12U;  ///< may be set only while DCEN = 0

inline constexpr Register keyr{base + 0x04};
inline constexpr std::uint32_t keyr_key1 = 0x4567'0123;
inline constexpr std::uint32_t keyr_key2 = 0xCDEF'89AB;

inline constexpr Register sr{base + 0x0C};  ///< writing 1 clears a flag
inline constexpr std::uint32_t sr_eop = 1U << 0U;
inline constexpr std::uint32_t sr_operr = 1U << 1U;
inline constexpr std::uint32_t sr_wrperr = 1U << 4U;
inline constexpr std::uint32_t sr_pgaerr = 1U << 5U;
inline constexpr std::uint32_t sr_pgperr = 1U << 6U;
inline constexpr std::uint32_t sr_pgserr = 1U << 7U;
inline constexpr std::uint32_t sr_errors = sr_operr | sr_wrperr | sr_pgaerr | sr_pgperr | sr_pgserr;
inline constexpr std::uint32_t sr_bsy = 1U << 16U;

inline constexpr Register cr{base + 0x10};
inline constexpr std::uint32_t cr_pg = 1U << 0U;
inline constexpr std::uint32_t cr_ser = 1U << 1U;
inline constexpr std::uint32_t cr_snb_position = 3;
inline constexpr std::uint32_t cr_psize_32 = 2U << 8U;  ///< for 2.7 to 3.6 V
inline constexpr std::uint32_t cr_strt = 1U << 16U;
inline constexpr std::uint32_t cr_lock = 1U << 31U;

/// The option bytes, as the chip has read them at its start.
inline constexpr Register optcr{base + 0x14};
inline constexpr std::uint32_t optcr_bor_lev_mask = 3U << 2U;  ///< 0: brown-out reset of level 3, the highest; 3: off

}  // namespace proleg::stm32f405::flash_interface
