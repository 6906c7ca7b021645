#include "sim/mcu/peripherals/pwr.hpp"

#include <string>

namespace proleg::sim {
namespace {

constexpr std::uint32_t cr = 0x00;
constexpr std::uint32_t csr = 0x04;
constexpr RegisterName registers[] = {{cr, "CR"}, {csr, "CSR"}};

constexpr std::uint32_t cr_pvde = 1U << 4U;
constexpr std::uint32_t cr_vos = 1U << 14U;
constexpr std::uint32_t cr_kept = 0x43E3;  // VOS, FPDS, DBP, PLS, PDDS, LPDS
constexpr std::uint32_t csr_ewup = 1U << 8U;
constexpr std::uint32_t csr_bre = 1U << 9U;
constexpr std::uint32_t csr_vosrdy = 1U << 14U;

constexpr std::uint32_t scale_1_mhz = 168;
constexpr std::uint32_t scale_2_mhz = 144;

}  // namespace

Pwr::Pwr(ChipServices& chip) : RegisterBlock(chip, "PWR", 0x4000'7000, 0x400, registers) { reset(); }

void Pwr::reset() { cr_ = cr_vos; }

std::uint32_t Pwr::max_core_mhz() const { return (cr_ & cr_vos) != 0 ? scale_1_mhz : scale_2_mhz; }

std::uint32_t Pwr::read(std::uint32_t offset) {
  switch (offset) {
    case cr:
      return cr_;
    case csr:
      return csr_vosrdy;
    default:
      reject_read(offset);
  }
}

void Pwr::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case cr:
      reject_bits(offset, value, cr_pvde, "the voltage detector is not modelled");
      if ((value & cr_vos) == 0 && chip().clocks().core * scale_2_mhz < local_time_per_us) {
        reject_write(offset, value,
                     "scale 2 allows " + std::to_string(scale_2_mhz) + " MHz, HCLK is " +
                         std::to_string(local_time_per_us / chip().clocks().core) + " MHz");
      }
      cr_ = value & cr_kept;
      break;
    case csr:
      reject_bits(offset, value, csr_ewup | csr_bre, "wake-up pin and backup regulator are not modelled");
      break;
    default:
      reject_write(offset, value);
  }
}

}  // namespace proleg::sim
