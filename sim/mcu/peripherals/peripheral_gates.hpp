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
  /// Adds a peripheral, known by its base(). It must outlive the gates.
  void attach(Peripheral& peripheral) { attached_.push_back(&peripheral); }
  [[nodiscard]] const std::vector<Peripheral*>& attached() const { return attached_; }

  /// Sets the registers as after a reset of the chip, which resets the attached peripherals itself.
  void reset();
  [[nodiscard]] static bool contains(std::uint32_t offset);
  /// Value of a register, which must exist.
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) const;
  /// Writes a register. Returns the reason if the write is rejected; then no register has changed.
  [[nodiscard]] std::optional<std::string> write(std::uint32_t offset, std::uint32_t value);

  [[nodiscard]] bool is_clocked(const Peripheral& peripheral) const;
  /// A bit that keeps the registers of a peripheral from answering.
  struct Obstacle {
    std::uint32_t offset;  ///< offset of its register
    unsigned bit;
    bool is_reset;  ///< the peripheral is held in reset; else it has no clock
  };
  /// The obstacle for a peripheral; nothing if its registers answer. Those of RCC, FLASH and IWDG always answer.
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
