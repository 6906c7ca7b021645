// Prints what the models of the virtual chip say about its registers, a name and a value a line: the first address of
// each peripheral, offset and value after reset of each register, bits that gate the peripherals, and the memory map.

#include <cstdint>
#include <exception>
#include <functional>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/bus/bus.hpp"
#include "sim/mcu/peripherals/adc.hpp"
#include "sim/mcu/peripherals/bxcan.hpp"
#include "sim/mcu/peripherals/chip_identity.hpp"
#include "sim/mcu/peripherals/dma.hpp"
#include "sim/mcu/peripherals/exti.hpp"
#include "sim/mcu/peripherals/flash_interface.hpp"
#include "sim/mcu/peripherals/gpio.hpp"
#include "sim/mcu/peripherals/iwdg.hpp"
#include "sim/mcu/peripherals/peripheral_gates.hpp"
#include "sim/mcu/peripherals/pwr.hpp"
#include "sim/mcu/peripherals/rcc.hpp"
#include "sim/mcu/peripherals/syscfg.hpp"
#include "sim/mcu/peripherals/timer.hpp"
#include "sim/mcu/peripherals/usart.hpp"
#include "support/bench.hpp"

namespace proleg::sim {
namespace {

class NoCells final : public FlashMemory {
 public:
  void read(std::uint32_t /*address*/, std::span<std::uint8_t> /*bytes*/) override {}
  void write(std::uint32_t /*address*/, std::span<const std::uint8_t> /*bytes*/) override {}
};

/// All peripherals of the chip, after its reset.
class Models {
 public:
  Models() : all_{&iwdg_, &exti_, &pwr_, &flash_, &rcc_, &syscfg_, &dma_1_, &dma_2_, &usart_, &adc_, &can_} {
    for (const unsigned number : {2U, 3U, 5U}) {
      timers_.push_back(std::make_unique<Timer>(chip_, number));
      all_.push_back(timers_.back().get());
    }
    for (const char port : {'A', 'B', 'C', 'D', 'E', 'F', 'G', 'H', 'I'}) {
      ports_.push_back(std::make_unique<Gpio>(chip_, board_, port));
      all_.push_back(ports_.back().get());
    }
    chip_.clock_source = &rcc_.clocks();
    rcc_.note_start(ResetCause::power_on);
    for (Peripheral* const each : all_) {
      each->reset();
    }
  }

  [[nodiscard]] const std::vector<Peripheral*>& all() const { return all_; }

 private:
  test::BenchChip chip_;
  test::BenchBoard board_;
  NoCells cells_;
  Bus bus_{1'000'000};
  Iwdg iwdg_{chip_};
  Exti exti_{chip_};
  Pwr pwr_{chip_, &exti_};
  FlashInterface flash_{chip_, cells_};
  Rcc rcc_{chip_, flash_, pwr_, iwdg_};
  Syscfg syscfg_{chip_};
  Dma dma_1_{chip_, 1, {}};
  Dma dma_2_{chip_, 2, {}};
  Usart usart_{chip_, board_, &dma_1_};
  Adc adc_{chip_, board_, &dma_2_};
  BxCan can_{chip_, bus_, [](LocalTime time) { return static_cast<BusTime>(time); }};
  std::vector<std::unique_ptr<Timer>> timers_;
  std::vector<std::unique_ptr<Gpio>> ports_;
  std::vector<Peripheral*> all_;
};

void print(const std::string& name, std::uint32_t value) { std::cout << name << '\t' << hexadecimal(value) << '\n'; }

void print_registers(Peripheral& peripheral) {
  print(std::string(peripheral.name()) + " base", peripheral.base());
  for (std::uint32_t offset = 0; offset < peripheral.size(); offset += 4) {
    std::string text = peripheral.register_name(offset);
    if (text.find(" at offset ") != std::string::npos) {
      continue;
    }
    text.replace(text.find('_'), 1, ".");
    print(text + " offset", offset);
    try {
      print(text + " reset", peripheral.read(offset));
    } catch (const UnmodelledAccess&) {
      std::cout << text << " reset\trejected\n";
    }
  }
}

/// The bit that enables the clock of a peripheral, which is off after a reset.
void print_gate(const PeripheralGates& gates, const Peripheral& peripheral) {
  if (const auto obstacle = gates.obstacle(peripheral)) {
    print(std::string(peripheral.name()) + " gate register", obstacle->offset);
    print(std::string(peripheral.name()) + " gate", 1U << obstacle->bit);
  }
}

void print_memory_map() {
  constexpr std::uint32_t step = 0x400;
  struct Range {
    std::uint32_t start, end;
  };
  for (const Range& range : {Range{0x4000'0000, 0x4008'0000}, Range{0x5000'0000, 0x5006'1000},
                             Range{0xA000'0000, 0xA000'1000}, Range{0xE000'0000, 0xE010'0000}}) {
    for (std::uint32_t address = range.start; address < range.end; address += step) {
      const std::string text = describe_address(address);
      const std::size_t end = text.find(" at offset 0x0");
      if (end != std::string::npos && text.ends_with(" 0x0")) {
        print(text.substr(0, end) + " map", address);
      }
    }
  }
}

void print_all() {
  const Models models;
  PeripheralGates gates;
  gates.reset();
  for (Peripheral* const each : models.all()) {
    print_registers(*each);
    print_gate(gates, *each);
  }
  print_memory_map();
}

}  // namespace
}  // namespace proleg::sim

int main() {
  try {
    proleg::sim::print_all();
  } catch (const std::exception& error) {
    std::cerr << "chip_registers: " << error.what() << '\n';
    return 1;
  }
}
