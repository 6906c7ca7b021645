#include "sim/mcu/peripherals/peripheral_gates.hpp"

#include <algorithm>
#include <iterator>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {
namespace {

// First registers of the groups; a group has one for each bus. Then the bits that these registers have.
constexpr std::uint32_t first_rstr = 0x10;
constexpr std::uint32_t first_enr = 0x30;
constexpr std::uint32_t first_lpenr = 0x50;
constexpr std::array<std::uint32_t, 5> bus_offset = {0x00, 0x04, 0x08, 0x10, 0x14};
constexpr std::size_t ahb1 = 0;
constexpr std::size_t apb1 = 3;
constexpr std::size_t apb2 = 4;
constexpr std::array<std::uint32_t, 5> reset_bits = {0x2260'11FF, 0xF1, 0x1, 0x36FE'C9FF, 0x0007'5933};
constexpr std::array<std::uint32_t, 5> enable_bits = {0x7E74'11FF, 0xF1, 0x1, 0x36FE'C9FF, 0x0007'5F33};
constexpr std::array<std::uint32_t, 5> sleep_enable_bits = {0x7E67'91FF, 0xF1, 0x1, 0x36FE'C9FF, 0x0007'5F33};
constexpr std::uint32_t ahb1enr_reset = 0x0010'0000;  // core-coupled memory

/// Index of the bus whose register of a group lies at an offset.
std::optional<std::size_t> bus_of(std::uint32_t offset, std::uint32_t group) {
  for (std::size_t bus = 0; bus < bus_offset.size(); ++bus) {
    if (offset == group + bus_offset[bus]) {
      return bus;
    }
  }
  return std::nullopt;
}

}  // namespace

struct PeripheralGates::Gate {
  std::uint32_t base;
  std::size_t bus;
  unsigned bit;
};

const PeripheralGates::Gate* PeripheralGates::gate_of(const Peripheral& peripheral) {
  static constexpr Gate gates[] = {
      {0x4002'0000, ahb1, 0},   // GPIOA
      {0x4002'0400, ahb1, 1},   // GPIOB
      {0x4002'0800, ahb1, 2},   // GPIOC
      {0x4002'0C00, ahb1, 3},   // GPIOD
      {0x4002'1000, ahb1, 4},   // GPIOE
      {0x4002'1400, ahb1, 5},   // GPIOF
      {0x4002'1800, ahb1, 6},   // GPIOG
      {0x4002'1C00, ahb1, 7},   // GPIOH
      {0x4002'2000, ahb1, 8},   // GPIOI
      {0x4002'6000, ahb1, 21},  // DMA1
      {0x4002'6400, ahb1, 22},  // DMA2
      {0x4000'0000, apb1, 0},   // TIM2
      {0x4000'0400, apb1, 1},   // TIM3
      {0x4000'0C00, apb1, 3},   // TIM5
      {0x4000'4400, apb1, 17},  // USART2
      {0x4000'6400, apb1, 25},  // CAN1
      {0x4000'6800, apb1, 26},  // CAN2
      {0x4000'7000, apb1, 28},  // PWR
      {0x4001'2000, apb2, 8},   // ADC1
      {0x4001'3800, apb2, 14},  // SYSCFG
  };
  const auto* const found = std::ranges::find(gates, peripheral.base(), &Gate::base);
  return found != std::end(gates) ? found : nullptr;
}

void PeripheralGates::reset() {
  resets_ = {};
  enables_ = {};
  enables_[ahb1] = ahb1enr_reset;
  sleep_enables_ = sleep_enable_bits;
}

bool PeripheralGates::contains(std::uint32_t offset) {
  return bus_of(offset, first_rstr) || bus_of(offset, first_enr) || bus_of(offset, first_lpenr);
}

std::uint32_t PeripheralGates::read(std::uint32_t offset) const {
  if (const auto bus = bus_of(offset, first_rstr)) {
    return resets_[*bus];
  }
  if (const auto bus = bus_of(offset, first_enr)) {
    return enables_[*bus];
  }
  return sleep_enables_.at(*bus_of(offset, first_lpenr));
}

std::optional<std::string> PeripheralGates::write(std::uint32_t offset, std::uint32_t value) {
  if (const auto bus = bus_of(offset, first_rstr)) {
    write_resets(*bus, value & reset_bits[*bus]);
    return std::nullopt;
  }
  if (const auto bus = bus_of(offset, first_enr)) {
    return write_enables(*bus, value & enable_bits[*bus]);
  }
  const std::size_t bus = *bus_of(offset, first_lpenr);
  return write_sleep_enables(bus, value & sleep_enable_bits[bus]);
}

bool PeripheralGates::is_clocked(const Peripheral& peripheral) const {
  const Gate* gate = gate_of(peripheral);
  return gate == nullptr || bit(enables_[gate->bus], gate->bit);
}

std::optional<PeripheralGates::Obstacle> PeripheralGates::obstacle(const Peripheral& peripheral) const {
  const Gate* gate = gate_of(peripheral);
  if (gate == nullptr) {
    return std::nullopt;
  }
  if (!bit(enables_[gate->bus], gate->bit)) {
    return Obstacle{first_enr + bus_offset[gate->bus], gate->bit, false};
  }
  if (bit(resets_[gate->bus], gate->bit)) {
    return Obstacle{first_rstr + bus_offset[gate->bus], gate->bit, true};
  }
  return std::nullopt;
}

void PeripheralGates::write_resets(std::size_t bus, std::uint32_t value) {
  const std::uint32_t begun = value & ~resets_[bus];
  resets_[bus] = value;
  for (Peripheral* peripheral : attached_) {
    const Gate* gate = gate_of(*peripheral);
    if (gate != nullptr && gate->bus == bus && bit(begun, gate->bit)) {
      peripheral->reset();
    }
  }
}

std::optional<std::string> PeripheralGates::write_enables(std::size_t bus, std::uint32_t value) {
  const std::uint32_t ended = enables_[bus] & ~value;
  for (const Peripheral* peripheral : attached_) {
    const Gate* gate = gate_of(*peripheral);
    if (gate != nullptr && gate->bus == bus && bit(ended, gate->bit) && !peripheral->is_idle()) {
      return "the clock of " + std::string(peripheral->name()) + " goes off while it works, which is not modelled";
    }
  }
  enables_[bus] = value;
  return std::nullopt;
}

std::optional<std::string> PeripheralGates::write_sleep_enables(std::size_t bus, std::uint32_t value) {
  for (const Peripheral* peripheral : attached_) {
    const Gate* gate = gate_of(*peripheral);
    if (gate != nullptr && gate->bus == bus && !bit(value, gate->bit)) {
      return std::string(peripheral->name()) + " without clock in Sleep mode is not modelled";
    }
  }
  sleep_enables_[bus] = value;
  return std::nullopt;
}

}  // namespace proleg::sim
