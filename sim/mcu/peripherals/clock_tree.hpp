#pragma once

// The clocks of core and buses, from the oscillators (RM0090, figure 21 and 7.3.2 to 7.3.3), and the settings that the
// manual forbids. All numbers are whole.

#include <cstdint>
#include <optional>
#include <string>

#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {

// Frequencies of HSI, and of HSE on a board whose crystal is not given.
inline constexpr std::uint32_t hsi_hz = 16'000'000;
inline constexpr std::uint32_t hse_hz = 8'000'000;
inline constexpr LocalTime hsi_period = local_time_per_us / 16;

/// Sources of the system clock, with their values in RCC_CFGR.SW.
enum class ClockSource : std::uint8_t { hsi = 0, hse = 1, pll = 2 };

/// Whether HSE is the input of the PLL (RCC_PLLCFGR.PLLSRC); else it is HSI.
[[nodiscard]] constexpr bool pll_from_hse(std::uint32_t pllcfgr) { return ((pllcfgr >> 22U) & 1U) != 0; }

/// Why the PLL must not run with this RCC_PLLCFGR: "VCO of 99 MHz: expected 100 to 432 MHz (RM0090, 7.3.2)". crystal:
/// the frequency of HSE in Hz.
[[nodiscard]] std::optional<std::string> pll_fault(std::uint32_t pllcfgr, std::uint32_t crystal = hse_hz);

struct ClockSettings {
  ClockSource source = ClockSource::hsi;
  std::uint32_t pllcfgr = 0;       ///< one without pll_fault(), if the source is the PLL
  std::uint32_t cfgr = 0;          ///< the prescalers
  std::uint32_t crystal = hse_hz;  ///< frequency of HSE in Hz
};
/// Limits that the rest of the chip sets to the clocks.
struct ClockLimits {
  std::uint32_t core_mhz;  ///< highest HCLK at the core voltage
  unsigned wait_states;    ///< of the flash
};
struct ClockOutcome {
  Clocks clocks;
  std::optional<std::string> fault;  ///< why the chip must not have these clocks; then `clocks` are those at reset
};
[[nodiscard]] ClockOutcome clocks_of(const ClockSettings& settings, const ClockLimits& limits);

}  // namespace proleg::sim
