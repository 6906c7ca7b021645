#include "sim/bus/recessive_waits.hpp"

#include <algorithm>

namespace proleg::sim {
namespace {

constexpr std::uint64_t second = 1'000'000'000;
constexpr std::uint64_t sequence_bits = 11;
constexpr std::uint64_t tail_bits = 8;  // ACK delimiter and end of frame, or error delimiter

}  // namespace

void RecessiveWaits::add(Controller& controller, unsigned sequences, BusTime now) {
  if (!contains(controller)) {
    waits_.push_back({&controller, sequences, now});
  }
}

void RecessiveWaits::remove(const Controller& controller) {
  std::erase_if(waits_, [&](const Wait& wait) { return wait.controller == &controller; });
}

bool RecessiveWaits::contains(const Controller& controller) const {
  return std::ranges::find(waits_, &controller, &Wait::controller) != waits_.end();
}

void RecessiveWaits::begin_silence(BusTime end_of_frame) {
  recessive_since_ = end_of_frame - std::min(end_of_frame, tail_bits * second / bit_rate_);
}

void RecessiveWaits::end_silence(BusTime time) {
  for (Wait& wait : waits_) {
    const BusTime since = std::min(time, std::max(recessive_since_, wait.since));
    // Rounded to the nearest, because durations are truncated.
    const std::uint64_t bits = ((time - since) * bit_rate_ + second / 2) / second;
    // A wait that ends now is left to ending_at().
    wait.sequences -= static_cast<unsigned>(std::min<std::uint64_t>(bits / sequence_bits, wait.sequences - 1));
  }
}

BusTime RecessiveWaits::first_end() const {
  BusTime next = never_on_bus;
  for (const Wait& wait : waits_) {
    next = std::min(next, end_of(wait));
  }
  return next;
}

std::vector<Controller*> RecessiveWaits::ending_at(BusTime time) const {
  std::vector<Controller*> result;
  for (const Wait& wait : waits_) {
    if (end_of(wait) == time) {
      result.push_back(wait.controller);
    }
  }
  return result;
}

BusTime RecessiveWaits::end_of(const Wait& wait) const {
  return std::max(recessive_since_, wait.since) + sequence_bits * wait.sequences * second / bit_rate_;
}

}  // namespace proleg::sim
