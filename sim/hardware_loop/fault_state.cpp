#include "sim/hardware_loop/fault_state.hpp"

#include "shared/fixed/random.hpp"
#include "shared/gait/contact_debouncer.hpp"
#include "sim/scenario/random_streams.hpp"

namespace proleg::sim {
namespace {

// What a number is drawn for, beside the joints' numbers.
constexpr std::uint32_t for_bus = 0x100;
constexpr std::uint32_t for_touch = 0x200;

}  // namespace

FaultState::FaultState(const Scenario& scenario) : scenario_(scenario), modules_(scenario.modules.size()) {}

void FaultState::begin_tick(std::uint32_t tick) {
  tick_ = tick;
  attempts_.fill(0);
}

std::uint32_t FaultState::draw(std::uint32_t use, std::uint32_t detail) const {
  Pcg32 noise(scenario_.kernel.seed + (std::uint64_t{use} << 32U | tick_), random_stream::fault_effects + detail);
  return noise.next();
}

bool FaultState::destroys(const CanFrame& frame) {
  const std::uint32_t attempt = attempts_.at(frame.identifier)++;
  return corruption_ != 0 && draw(for_bus, attempt << 11U | frame.identifier) < corruption_;
}

bool FaultState::loses(const CanFrame& frame, std::size_t receiver) {
  if (receiver >= modules_.size() || modules_[receiver].loss == 0) {
    return false;
  }
  const std::uint32_t attempt = attempts_.at(frame.identifier);
  return draw(static_cast<std::uint32_t>(receiver), attempt << 11U | frame.identifier) < modules_[receiver].loss;
}

std::uint8_t FaultState::sensors(unsigned joint, std::uint8_t contacts) const {
  constexpr unsigned all = StateFrame::contact_bits;
  switch (modules_[joint].touch) {
    case TouchFault::none:
      break;
    case TouchFault::pressed:
      return static_cast<std::uint8_t>(contacts | all);
    case TouchFault::open:
      return static_cast<std::uint8_t>(contacts & ~all);
    case TouchFault::bouncing:
      return static_cast<std::uint8_t>((contacts & ~all) | (draw(for_touch | joint, 0) >> 28U & all));
  }
  return contacts;
}

}  // namespace proleg::sim
