#include "sim/mcu/peripherals/pwr.hpp"

#include <string>

namespace proleg::sim {
namespace {

constexpr std::uint32_t cr = 0x00;
constexpr std::uint32_t csr = 0x04;
constexpr RegisterName registers[] = {{cr, "CR"}, {csr, "CSR"}};

constexpr std::uint32_t cr_pvde = 1U << 4U;
constexpr std::uint32_t cr_vos = 1U << 14U;
constexpr std::uint32_t cr_kept = 0x43F3;  // VOS, FPDS, DBP, PLS, PVDE, PDDS, LPDS
constexpr std::uint32_t csr_pvdo = 1U << 2U;
constexpr std::uint32_t csr_ewup = 1U << 8U;
constexpr std::uint32_t csr_bre = 1U << 9U;
constexpr std::uint32_t csr_vosrdy = 1U << 14U;

constexpr std::uint32_t scale_1_mhz = 168;
constexpr std::uint32_t scale_2_mhz = 144;

/// Typical thresholds VPVD for each PLS (DS8626, embedded reset and power control block).
struct Threshold {
  std::uint32_t falling_mv;
  std::uint32_t rising_mv;
};
constexpr Threshold thresholds[] = {{2'040, 2'140}, {2'190, 2'300}, {2'350, 2'450}, {2'510, 2'600},
                                    {2'660, 2'760}, {2'820, 2'930}, {2'930, 3'030}, {3'030, 3'140}};

}  // namespace

Pwr::Pwr(ChipServices& chip, Exti* exti) : RegisterBlock(chip, "PWR", 0x4000'7000, 0x400, registers), exti_(exti) {
  cr_ = cr_vos;
}

void Pwr::reset() {
  cr_ = cr_vos;
  detect();
}

void Pwr::set_supply(std::uint32_t mv) {
  supply_mv_ = mv;
  detect();
}

void Pwr::detect() {
  const Threshold& threshold = thresholds[field(cr_, 5, 3)];
  is_low_ = (cr_ & cr_pvde) != 0 && supply_mv_ < (is_low_ ? threshold.rising_mv : threshold.falling_mv);
  if (exti_ != nullptr) {
    exti_->set_detector(is_low_);
  }
}

std::uint32_t Pwr::max_core_mhz() const { return (cr_ & cr_vos) != 0 ? scale_1_mhz : scale_2_mhz; }

std::uint32_t Pwr::read(std::uint32_t offset) {
  switch (offset) {
    case cr:
      return cr_;
    case csr:
      return csr_vosrdy | (is_low_ ? csr_pvdo : 0);
    default:
      reject_read(offset);
  }
}

void Pwr::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case cr:
      if ((value & cr_vos) == 0 && chip().clocks().core * scale_2_mhz < local_time_per_us) {
        reject_write(offset, value,
                     "scale 2 allows " + std::to_string(scale_2_mhz) + " MHz, HCLK is " +
                         std::to_string(local_time_per_us / chip().clocks().core) + " MHz");
      }
      cr_ = value & cr_kept;
      detect();
      break;
    case csr:
      reject_bits(offset, value, csr_ewup | csr_bre, "wake-up pin and backup regulator are not modelled");
      break;
    default:
      reject_write(offset, value);
  }
}

}  // namespace proleg::sim
