#include "sim/mcu/chip/pins.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace proleg::sim {
namespace {

constexpr unsigned timer_2_function = 1;
constexpr unsigned can_function = 9;
constexpr unsigned port_a = 0;
constexpr unsigned port_b = 1;

}  // namespace

Pins::Pins(ChipServices& chip, BoardSignals& board, Timer& timer_2) : chip_(&chip), timer_2_(&timer_2) {
  for (const char port : {'A', 'B', 'C', 'D', 'E', 'F', 'G', 'H', 'I'}) {
    const auto index = static_cast<unsigned>(ports_.size());
    ports_.push_back(std::make_unique<Gpio>(chip, board, port));
    ports_.back()->set_alternate_output([this, index](unsigned number) { return timer_level(Pin{index, number}); });
  }
}

/// The pins that an output of TIM2 can reach.
std::span<const Pins::Pin> Pins::timer_2_pins(unsigned channel) {
  static constexpr std::array<Pin, 3> first{{{port_a, 0}, {port_a, 5}, {port_a, 15}}};
  static constexpr std::array<Pin, 2> second{{{port_a, 1}, {port_b, 3}}};
  static constexpr std::array<Pin, 2> third{{{port_a, 2}, {port_b, 10}}};
  static constexpr std::array<Pin, 2> fourth{{{port_a, 3}, {port_b, 11}}};
  switch (channel) {
    case 1:
      return first;
    case 2:
      return second;
    case 3:
      return third;
    default:
      return fourth;
  }
}

bool Pins::has_function(const Pin& pin, unsigned function) const {
  const Gpio& port = *ports_[pin.port];
  return port.mode(pin.number) == Gpio::Mode::alternate && port.alternate_function(pin.number) == function;
}

bool Pins::has_slow_can_edges() const {
  return std::ranges::any_of(can_places, [this](const auto& pins) {
    return has_function(pins[1], can_function) && ports_[pins[1].port]->output_speed(pins[1].number) == 0;
  });
}

bool Pins::connect_can() const {
  return std::ranges::any_of(can_places, [this](const auto& pins) {
    return std::ranges::all_of(pins, [this](const Pin& pin) { return has_function(pin, can_function); });
  });
}

std::optional<LocalTime> Pins::pulse_time(unsigned channel) {
  const bool reaches_pin = std::ranges::any_of(timer_2_pins(channel),
                                               [this](const Pin& pin) { return has_function(pin, timer_2_function); });
  const std::optional<LocalTime> time = reaches_pin ? timer_2_->high_time(channel) : std::nullopt;
  return time == LocalTime{0} ? std::nullopt : time;
}

/// The output of TIM2, 1 to 4, that drives a pin; 0: none.
unsigned Pins::timer_output_at(const Pin& pin) const {
  for (unsigned channel = 1; channel <= Timer::channel_count && has_function(pin, timer_2_function); ++channel) {
    const std::span<const Pin> pins = timer_2_pins(channel);
    if (std::ranges::find(pins, pin) != pins.end()) {
      return channel;
    }
  }
  return 0;
}

std::optional<bool> Pins::timer_level(const Pin& pin) {
  const unsigned channel = timer_output_at(pin);
  return channel != 0 ? std::optional(timer_2_->output(channel).high) : std::nullopt;
}

bool Pins::level(const Pin& pin) {
  if (const std::optional<bool> driven = timer_level(pin)) {
    return *driven;
  }
  Gpio& port = *ports_[pin.port];
  return port.mode(pin.number) != Gpio::Mode::alternate && port.level(pin.number);
}

void Pins::watch(char port, unsigned number, Watch watch) {
  watched_ = Watched{{static_cast<unsigned>(port - 'A'), number}, std::move(watch)};
  watched_->high = level(watched_->pin);
}

void Pins::look() {
  if (!watched_) {
    return;
  }
  const bool high = level(watched_->pin);
  if (high != watched_->high) {
    watched_->high = high;
    watched_->watch(std::min(watched_->next_edge, chip_->now()), high);
  }
  const unsigned channel = timer_output_at(watched_->pin);
  watched_->next_edge = channel != 0 ? timer_2_->next_edge(channel) : never_on_chip;
}

void Pins::reset() {
  if (watched_) {
    watched_->next_edge = never_on_chip;  // the time is one of the clock before the reset
  }
  look();
}

}  // namespace proleg::sim
