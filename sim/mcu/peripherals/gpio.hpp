#pragma once

// A port of general-purpose pins GPIOA to GPIOI (RM0090, section 8).

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Gpio final : public RegisterBlock {
 public:
  enum class Mode : std::uint8_t { input = 0, output = 1, alternate = 2, analog = 3 };
  static constexpr unsigned pin_count = 16;

  /// port: 'A' to 'I'; throws std::invalid_argument for another one.
  Gpio(ChipServices& chip, BoardSignals& board, char port);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

  // State of a pin, 0 to 15.
  [[nodiscard]] Mode mode(unsigned pin) const;
  /// Number of the selected alternate function, 0 to 15; it has effect in Mode::alternate.
  [[nodiscard]] unsigned alternate_function(unsigned pin) const;
  /// Output speed (OSPEEDR): 0 is low, with edges of up to 100 ns (DS8626, I/O AC characteristics).
  [[nodiscard]] unsigned output_speed(unsigned pin) const;
  /// Level that the port itself drives; nothing unless it is an output (open drain: only low is driven).
  [[nodiscard]] std::optional<bool> output(unsigned pin) const;
  /// Level that the program reads: what drives the pin (the chip before the board), else its pull resistor, else low.
  /// An analog pin reads low.
  [[nodiscard]] bool level(unsigned pin);

  /// Level that a peripheral drives at a pin in Mode::alternate; nothing if none does, or if it is not known.
  using AlternateOutput = std::function<std::optional<bool>(unsigned pin)>;
  void set_alternate_output(AlternateOutput output) { alternate_output_ = std::move(output); }

 private:
  BoardSignals* board_;
  AlternateOutput alternate_output_;
  char port_;
  std::uint32_t moder_ = 0;
  std::uint32_t otyper_ = 0;
  std::uint32_t ospeedr_ = 0;
  std::uint32_t pupdr_ = 0;
  std::uint32_t odr_ = 0;
  std::array<std::uint32_t, 2> afr_{};
};

}  // namespace proleg::sim
