#pragma once

// Controller area network, CAN1: RM0090, section 32.9.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::can1 {

inline constexpr std::uintptr_t base = 0x4000'6400;

inline constexpr Register mcr{base + 0x000};
inline constexpr std::uint32_t mcr_inrq = 1U << 0U;
inline constexpr std::uint32_t mcr_dbf = 1U << 16U;  ///< stops while a debugger halts the CPU; set at reset

inline constexpr Register msr{base + 0x004};
inline constexpr std::uint32_t msr_inak = 1U << 0U;
inline constexpr std::uint32_t msr_erri = 1U << 2U;  ///< writing 1 clears it

// Bits of mailbox 0; those of mailbox m are 8 * m bits further on. Writing 1 clears RQCP (with TXOK, ALST and TERR) and
// sets ABRQ.
inline constexpr Register tsr{base + 0x008};
inline constexpr std::uint32_t tsr_rqcp0 = 1U << 0U;
inline constexpr std::uint32_t tsr_txok0 = 1U << 1U;
inline constexpr std::uint32_t tsr_abrq0 = 1U << 7U;

inline constexpr Register rf0r{base + 0x00C};
inline constexpr std::uint32_t rf0r_fmp = 3U << 0U;   ///< number of frames in the FIFO
inline constexpr std::uint32_t rf0r_fovr = 1U << 4U;  ///< writing 1 clears it
/// Writing 1 releases the oldest frame; it reads 0 when that is done.
inline constexpr std::uint32_t rf0r_rfom = 1U << 5U;

inline constexpr Register ier{base + 0x014};
inline constexpr std::uint32_t ier_tmeie = 1U << 0U;
inline constexpr std::uint32_t ier_fmpie0 = 1U << 1U;
inline constexpr std::uint32_t ier_fovie0 = 1U << 3U;
inline constexpr std::uint32_t ier_bofie = 1U << 10U;
inline constexpr std::uint32_t ier_errie = 1U << 15U;

inline constexpr Register esr{base + 0x018};
inline constexpr std::uint32_t esr_ewgf = 1U << 0U;
inline constexpr std::uint32_t esr_epvf = 1U << 1U;
inline constexpr std::uint32_t esr_boff = 1U << 2U;
/// Kind of the last error, three bits, the only ones that can be written.
inline constexpr std::uint32_t esr_lec_position = 4;
inline constexpr std::uint32_t esr_lec_unchanged = 7;
inline constexpr std::uint32_t esr_tec_position = 16;  ///< transmit error counter, 8 bits
inline constexpr std::uint32_t esr_rec_position = 24;  ///< receive error counter, 8 bits

inline constexpr Register btr{base + 0x01C};
/// A bit is 1 + segment_1 + segment_2 time quanta, each prescaler periods of PCLK1; the sample is taken between the
/// segments.
[[nodiscard]] constexpr std::uint32_t btr_of(std::uint32_t prescaler, std::uint32_t segment_1, std::uint32_t segment_2,
                                             std::uint32_t jump_width) {
  return (prescaler - 1U) | (segment_1 - 1U) << 16U | (segment_2 - 1U) << 20U | (jump_width - 1U) << 24U;
}

/// Transmit mailbox 0 to 2, with its four words: TIxR, TDTxR, TDLxR, TDHxR.
struct TransmitMailbox {
  Register identifier, length, low, high;

  constexpr explicit TransmitMailbox(unsigned number)
      : identifier(base + 0x180 + 0x10 * number),
        length(base + 0x184 + 0x10 * number),
        low(base + 0x188 + 0x10 * number),
        high(base + 0x18C + 0x10 * number) {}
};
inline constexpr std::uint32_t tir_txrq = 1U << 0U;
inline constexpr std::uint32_t ir_stid_position = 21;  ///< position of an 11-bit identifier in TIxR and RIxR
inline constexpr std::uint32_t dtr_dlc = 15U;

// Words of the oldest frame in FIFO 0.
inline constexpr Register ri0r{base + 0x1B0};
inline constexpr Register rdt0r{base + 0x1B4};
inline constexpr Register rdl0r{base + 0x1B8};
inline constexpr Register rdh0r{base + 0x1BC};

// Filters: one bit for each bank, except in FMR.
inline constexpr Register fmr{base + 0x200};
inline constexpr std::uint32_t fmr_finit = 1U << 0U;
/// Bits of FMR by which the banks from this number on belong to CAN2.
[[nodiscard]] constexpr std::uint32_t fmr_can2sb_of(unsigned bank) { return bank << 8U; }
inline constexpr std::uint32_t fmr_mask = fmr_finit | 0x3FU << 8U;  ///< the other bits keep the values of the reset
inline constexpr Register fm1r{base + 0x204};                       ///< 0: identifier and mask
inline constexpr Register fs1r{base + 0x20C};                       ///< 1: 32 bits, 0: 16 bits
inline constexpr Register ffa1r{base + 0x214};                      ///< 0: into FIFO 0
inline constexpr Register fa1r{base + 0x21C};                       ///< 1: in use
/// The two words of a bank, 0 to 27. In 16-bit scale each holds two identifiers, or an identifier and, in the upper
/// half, its mask (1: the bit must be equal).
struct FilterBank {
  Register first, second;

  constexpr explicit FilterBank(unsigned number)
      : first(base + 0x240 + 8 * number), second(base + 0x244 + 8 * number) {}
};
inline constexpr unsigned filter_banks = 28;
inline constexpr std::uint32_t filter_stid_position = 5;  ///< position of an 11-bit identifier in 16-bit scale
inline constexpr std::uint32_t filter_rtr = 1U << 4U;
inline constexpr std::uint32_t filter_ide = 1U << 3U;

}  // namespace proleg::stm32f405::can1
