#include "sim/mcu/peripherals/clock_tree.hpp"

#include "sim/mcu/peripherals/flash_interface.hpp"
#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint64_t local_time_hz = local_time_per_us * 1'000'000;
constexpr std::uint32_t one_mhz = 1'000'000;

/// A frequency as text: "168 MHz", "171.428 MHz".
std::string mhz(std::uint64_t hz) {
  std::string text = std::to_string(hz / one_mhz);
  const std::uint64_t khz = hz / 1000 % 1000;
  if (khz != 0) {
    std::string digits = std::to_string(1000 + khz).substr(1);
    digits.erase(digits.find_last_not_of('0') + 1);
    text += "." + digits;
  }
  return text + " MHz";
}

unsigned ahb_divisor(std::uint32_t cfgr) {
  constexpr unsigned divisors[] = {2, 4, 8, 16, 64, 128, 256, 512};
  const unsigned hpre = field(cfgr, 4, 4);
  return hpre < 8 ? 1 : divisors[hpre - 8];
}

/// Divisor of an APB bus. lowest: first bit of PPRE1 (10) or PPRE2 (13).
unsigned apb_divisor(std::uint32_t cfgr, unsigned lowest) {
  const unsigned ppre = field(cfgr, lowest, 3);
  return ppre < 4 ? 1 : 2U << (ppre - 4);
}

struct Pll {
  Pll(std::uint32_t pllcfgr, std::uint32_t crystal)
      : m(field(pllcfgr, 0, 6)),
        n(field(pllcfgr, 6, 9)),
        p(2 * (field(pllcfgr, 16, 2) + 1)),
        q(field(pllcfgr, 24, 4)),
        input_hz(pll_from_hse(pllcfgr) ? crystal : hsi_hz) {}

  std::uint64_t m;
  std::uint64_t n;
  std::uint64_t p;
  std::uint64_t q;
  std::uint64_t input_hz;
};

/// Period of the system clock, as a fraction of local time.
struct Period {
  std::uint64_t numerator;
  std::uint64_t denominator;
};

Period system_period(const ClockSettings& settings) {
  switch (settings.source) {
    case ClockSource::hse:
      return {local_time_hz, settings.crystal};
    case ClockSource::pll: {
      const Pll pll(settings.pllcfgr, settings.crystal);
      return {local_time_hz * pll.m * pll.p, pll.input_hz * pll.n};
    }
    case ClockSource::hsi:
      break;
  }
  return {hsi_period, 1};
}

}  // namespace

std::optional<std::string> pll_fault(std::uint32_t pllcfgr, std::uint32_t crystal) {
  const Pll pll(pllcfgr, crystal);
  const auto fault = [](const std::string& what, const char* expected) {
    return what + ": expected " + expected + " (RM0090, 7.3.2)";
  };
  if (pll.m < 2) {
    return fault("PLLM = " + std::to_string(pll.m), "2 to 63");
  }
  if (pll.n < 50 || pll.n > 432) {
    return fault("PLLN = " + std::to_string(pll.n), "50 to 432");
  }
  if (pll.q < 2) {
    return fault("PLLQ = " + std::to_string(pll.q), "2 to 15");
  }
  if (pll.input_hz < pll.m * one_mhz || pll.input_hz > pll.m * 2 * one_mhz) {
    return fault("VCO input of " + mhz(pll.input_hz / pll.m), "1 to 2 MHz");
  }
  const std::uint64_t vco_times_m = pll.input_hz * pll.n;
  if (vco_times_m < pll.m * 100 * one_mhz || vco_times_m > pll.m * 432 * one_mhz) {
    return fault("VCO of " + mhz(vco_times_m / pll.m), "100 to 432 MHz");
  }
  if (vco_times_m > pll.m * pll.p * 168 * one_mhz) {
    return fault("output of " + mhz(vco_times_m / (pll.m * pll.p)), "at most 168 MHz");
  }
  return std::nullopt;
}

ClockOutcome clocks_of(const ClockSettings& settings, const ClockLimits& limits) {
  const Period system = system_period(settings);
  const std::uint64_t core = system.numerator * ahb_divisor(settings.cfgr);
  const unsigned apb1_divisor = apb_divisor(settings.cfgr, 10);
  const unsigned apb2_divisor = apb_divisor(settings.cfgr, 13);
  if (core % system.denominator != 0) {
    return {{},
            "HCLK of " + mhz(local_time_hz * system.denominator / core) +
                " does not divide 1008 MHz, in which the model counts time"};
  }

  Clocks next;
  next.core = core / system.denominator;
  next.apb1 = next.core * apb1_divisor;
  next.apb2 = next.core * apb2_divisor;
  // Timers count with the clock of their bus, or with twice this clock if it is divided.
  next.apb1_timers = apb1_divisor == 1 ? next.apb1 : next.apb1 / 2;
  next.apb2_timers = apb2_divisor == 1 ? next.apb2 : next.apb2 / 2;

  struct Limit {
    const char* clock;
    LocalTime period;
    std::uint32_t max_mhz;
    const char* why;
  };
  for (const Limit& limit :
       {Limit{"PCLK1", next.apb1, 42, "(RM0090, 7.3.3)"}, Limit{"PCLK2", next.apb2, 84, "(RM0090, 7.3.3)"},
        Limit{"HCLK", next.core, limits.core_mhz, "at this core voltage (PWR_CR.VOS)"}}) {
    if (limit.period * limit.max_mhz < local_time_per_us) {
      return {{},
              std::string(limit.clock) + " of " + mhz(local_time_hz / limit.period) + ": at most " +
                  std::to_string(limit.max_mhz) + " MHz " + limit.why};
    }
  }
  const unsigned needed = flash_wait_states(next.core);
  if (limits.wait_states < needed) {
    return {{},
            "HCLK of " + mhz(local_time_hz / next.core) + " needs " + std::to_string(needed) +
                " wait states, FLASH_ACR has " + std::to_string(limits.wait_states) + " (RM0090, table 10)"};
  }
  return {next, std::nullopt};
}

}  // namespace proleg::sim
