#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/mcu/peripherals/gpio.hpp"
#include "sim/mcu/peripherals/timer.hpp"

namespace proleg::sim {

/// The pins of the chip, and which peripherals reach them by their alternate functions (DS8626, table 9): TIM2 and
/// CAN1.
class Pins {
 public:
  /// The arguments must outlive the pins.
  Pins(ChipServices& chip, BoardSignals& board, Timer& timer_2);
  Pins(const Pins&) = delete;  // the ports refer to it
  Pins& operator=(const Pins&) = delete;

  [[nodiscard]] const std::vector<std::unique_ptr<Gpio>>& ports() const { return ports_; }

  /// Whether a pair of pins, receive and transmit, is CAN1's.
  [[nodiscard]] bool connect_can() const;
  /// Whether the edges of the transmit pin are too slow for a bit of 1 us.
  [[nodiscard]] bool has_slow_can_edges() const;
  /// Timer::high_time() of an output of TIM2 (1 to 4); nothing if the output reaches no pin or is always low.
  [[nodiscard]] std::optional<LocalTime> pulse_time(unsigned channel);

  /// Called when the level of the watched pin changes, with the time of the edge. The pin is a plain input or output,
  /// or an output of TIM2; a pin that another peripheral drives counts as low.
  using Watch = std::function<void(LocalTime edge, bool high)>;
  void watch(char port, unsigned number, Watch watch);
  /// To be called at next_edge(), and before and after each write of a register: two edges are never due at once.
  void look();
  /// Time at which the watched pin may change by itself; never_on_chip if no pin is watched.
  [[nodiscard]] LocalTime next_edge() const { return watched_ ? watched_->next_edge : never_on_chip; }
  /// To be called after a reset of the chip: time and timers start from 0.
  void reset();

 private:
  struct Pin {
    unsigned port;
    unsigned number;
    friend bool operator==(const Pin&, const Pin&) = default;
  };
  static constexpr std::array<std::array<Pin, 2>, 3> can_places{{{{{0, 11}, {0, 12}}},  // PA11, PA12
                                                                 {{{1, 8}, {1, 9}}},    // PB8, PB9
                                                                 {{{3, 0}, {3, 1}}}}};  // PD0, PD1
  struct Watched {
    Pin pin;
    Watch watch;
    bool high = false;
    LocalTime next_edge = never_on_chip;  ///< time of the edge, or to look again, if no register is written before
  };

  [[nodiscard]] static std::span<const Pin> timer_2_pins(unsigned channel);
  [[nodiscard]] bool has_function(const Pin& pin, unsigned function) const;
  [[nodiscard]] unsigned timer_output_at(const Pin& pin) const;
  /// Level of a pin that an output of TIM2 drives.
  [[nodiscard]] std::optional<bool> timer_level(const Pin& pin);
  [[nodiscard]] bool level(const Pin& pin);

  ChipServices* chip_;
  Timer* timer_2_;
  std::vector<std::unique_ptr<Gpio>> ports_;
  std::optional<Watched> watched_;
};

}  // namespace proleg::sim
