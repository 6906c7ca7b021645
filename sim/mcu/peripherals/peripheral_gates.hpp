#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/mcu/peripherals/peripheral.hpp"

namespace proleg::sim {

/// Reset and clock of each peripheral: the registers AHB1RSTR to APB2LPENR of RCC (RM0090, 7.3.5 to 7.3.19).
class PeripheralGates {
 public:
  /// The peripherals are known by their base(). They must outlive this.
  void attach(Peripheral& peripheral) { attached_.push_back(&peripheral); }
  [[nodiscard]] const std::vector<Peripheral*>& attached() const { return attached_; }

  /// Registers as after reset. The chip resets the attached peripherals.
  void reset();
  [[nodiscard]] static bool contains(std::uint32_t offset);
  /// Of a register that exists.
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) const;
  /// Nothing, or why it is rejected, and then nothing has changed.
  [[nodiscard]] std::optional<std::string> write(std::uint32_t offset, std::uint32_t value);

  [[nodiscard]] bool is_clocked(const Peripheral& peripheral) const;
  /// A bit that keeps the registers of a peripheral from answering.
  struct Obstacle {
    std::uint32_t offset;  ///< of its register
    unsigned bit;
    bool is_reset;  ///< held in reset; else without clock
  };
  /// Nothing if the registers answer. Those of peripherals without a gate (RCC, FLASH, IWDG) always do.
  [[nodiscard]] std::optional<Obstacle> obstacle(const Peripheral& peripheral) const;

 private:
  static constexpr std::size_t bus_count = 5;  ///< AHB1, AHB2, AHB3, APB1, APB2
  struct Gate;

  [[nodiscard]] static const Gate* gate_of(const Peripheral& peripheral);
  void write_resets(std::size_t bus, std::uint32_t value);
  [[nodiscard]] std::optional<std::string> write_enables(std::size_t bus, std::uint32_t value);
  [[nodiscard]] std::optional<std::string> write_sleep_enables(std::size_t bus, std::uint32_t value);

  std::vector<Peripheral*> attached_;
  std::array<std::uint32_t, bus_count> resets_{};
  std::array<std::uint32_t, bus_count> enables_{};
  std::array<std::uint32_t, bus_count> sleep_enables_{};
};

}  // namespace proleg::sim
