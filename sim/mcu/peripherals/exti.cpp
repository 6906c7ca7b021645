#include "sim/mcu/peripherals/exti.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t imr = 0x00;
constexpr std::uint32_t emr = 0x04;
constexpr std::uint32_t rtsr = 0x08;
constexpr std::uint32_t ftsr = 0x0C;
constexpr std::uint32_t swier = 0x10;
constexpr std::uint32_t pr = 0x14;
constexpr RegisterName registers[] = {{imr, "IMR"},   {emr, "EMR"},     {rtsr, "RTSR"},
                                      {ftsr, "FTSR"}, {swier, "SWIER"}, {pr, "PR"}};

constexpr std::uint32_t line = 1U << Exti::detector_line;

}  // namespace

Exti::Exti(ChipServices& chip)
    : RegisterBlock(chip, "EXTI", 0x4001'3C00, 0x400, registers), interrupt_(chip, detector_interrupt) {}

void Exti::reset() {
  mask_ = 0;
  rising_ = 0;
  falling_ = 0;
  pending_ = 0;
  update_interrupt();
}

void Exti::set_detector(bool high) {
  if (high == is_high_) {
    return;
  }
  is_high_ = high;
  pending_ |= high ? rising_ : falling_;
  update_interrupt();
}

void Exti::update_interrupt() { interrupt_.set((pending_ & mask_) != 0); }

std::uint32_t Exti::read(std::uint32_t offset) {
  switch (offset) {
    case imr:
      return mask_;
    case emr:
    case swier:
      return 0;
    case rtsr:
      return rising_;
    case ftsr:
      return falling_;
    case pr:
      return pending_;
    default:
      reject_read(offset);
  }
}

void Exti::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == imr || offset == rtsr || offset == ftsr) {
    reject_bits(offset, value, ~line, "only line 16, the voltage detector, is modelled");
  }
  switch (offset) {
    case imr:
      mask_ = value;
      break;
    case rtsr:
      rising_ = value;
      break;
    case ftsr:
      falling_ = value;
      break;
    case emr:
    case swier:
      reject_bits(offset, value, ~0U, "events and interrupts by software are not modelled");
      break;
    case pr:
      pending_ &= ~value;
      break;
    default:
      reject_write(offset, value);
  }
  update_interrupt();
}

}  // namespace proleg::sim
