#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shared/gait/state_frame.hpp"

namespace proleg {

/// The two touch sensors under each link.
enum class TouchSensor : std::uint8_t {
  rear,   ///< nearer to the tail
  front,  ///< nearer to the head
};

/// The contacts of all links at one tick, as the joints' state frames report them. Link 0 is the head; link j + 1 lies
/// behind joint j. A link is not pressed until the first frame of its joint is received.
class Contacts {
 public:
  /// frames: the latest state frame of every joint, in kernel order. If it is empty, nothing is pressed.
  explicit Contacts(std::span<const StateFrame> frames) : frames_(frames) {}

  [[nodiscard]] unsigned link_count() const { return static_cast<unsigned>(frames_.size()) + 1; }

  [[nodiscard]] bool pressed(unsigned link, TouchSensor sensor) const {
    if (link >= link_count() || frames_.empty()) {
      return false;
    }
    const std::uint8_t flags = frames_[link == 0 ? 0 : link - 1].flags();
    const unsigned first_bit = link == 0 ? 2 : 0;
    return ((flags >> (first_bit + static_cast<unsigned>(sensor))) & 1U) != 0;
  }

  /// Whether either sensor of the link is pressed.
  [[nodiscard]] bool pressed(unsigned link) const {
    return pressed(link, TouchSensor::rear) || pressed(link, TouchSensor::front);
  }

 private:
  std::span<const StateFrame> frames_;
};

}  // namespace proleg
