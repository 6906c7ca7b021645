#pragma once

// The processor's own registers: PM0214, sections 4.3 (NVIC) and 4.4 (SCB). Positions of interrupts: RM0090, table 61.

#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405 {

namespace scb {

inline constexpr std::uintptr_t base = 0xE000'ED00;

inline constexpr Register icsr{base + 0x04};
inline constexpr std::uint32_t icsr_pendsvset = 1U << 28U;  ///< writing 0 does nothing

inline constexpr Register scr{base + 0x10};
inline constexpr std::uint32_t scr_sleeponexit = 1U << 1U;  ///< sleeps when an interrupt would return to thread mode
inline constexpr Register vtor{base + 0x08};
inline constexpr Register aircr{base + 0x0C};
inline constexpr std::uint32_t aircr_sysresetreq = 0x05FA'0004;  ///< the request, with the key that a write needs
inline constexpr Register shpr3{base + 0x20};
inline constexpr std::uint32_t shpr3_pendsv_position = 16;
inline constexpr Register cfsr{base + 0x28};
inline constexpr std::uint32_t cfsr_mmarvalid = 1U << 7U;
inline constexpr std::uint32_t cfsr_bfarvalid = 1U << 15U;
inline constexpr Register hfsr{base + 0x2C};
inline constexpr Register mmfar{base + 0x34};
inline constexpr Register bfar{base + 0x38};

}  // namespace scb

/// The memory protection unit: PM0214, section 4.2.
namespace mpu {

inline constexpr std::uintptr_t base = 0xE000'ED90;

inline constexpr Register ctrl{base + 0x04};
inline constexpr std::uint32_t ctrl_enable = 1U << 0U;
inline constexpr std::uint32_t ctrl_privdefena = 1U << 2U;  ///< outside of the regions everything is as without MPU

inline constexpr Register rbar{base + 0x0C};
inline constexpr std::uint32_t rbar_valid = 1U << 4U;  ///< the region is that of the lowest bits
/// AP = 0: no access.
inline constexpr Register rasr{base + 0x10};
inline constexpr std::uint32_t rasr_enable = 1U << 0U;
inline constexpr std::uint32_t rasr_size_4k = 11U << 1U;
inline constexpr std::uint32_t rasr_xn = 1U << 28U;

}  // namespace mpu

enum class Interrupt : std::uint8_t {
  pvd = 1,
  dma1_stream_5 = 16,
  dma1_stream_6 = 17,
  can1_tx = 19,
  can1_rx0 = 20,
  can1_sce = 22,
  usart2 = 38,
  timer_5 = 50,
};
inline constexpr unsigned interrupt_count = 82;

namespace nvic {

/// Sets the priority, 0 (first) to 15: only the upper four bits exist.
inline void set_priority(Interrupt interrupt, std::uint32_t priority) {
  const auto position = static_cast<std::uint32_t>(interrupt);
  const std::uint32_t shift = 8U * (position % 4U);
  Register(0xE000'E400 + position / 4U * 4U).change(0xFFU << shift, priority << (shift + 4U));
}

inline void enable(Interrupt interrupt) {
  const auto position = static_cast<std::uint32_t>(interrupt);
  Register(0xE000'E100 + position / 32U * 4U).write(1U << (position % 32U));
}

}  // namespace nvic
}  // namespace proleg::stm32f405
