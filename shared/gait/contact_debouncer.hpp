#pragma once

#include <cstdint>

#include "shared/gait/state_frame.hpp"

namespace proleg {

/// Debounces the touch sensors of a joint module: a sensor that bounces as it closes or opens counts once.
///
/// Sampled once a tick, at SYNC. A sensor's change is accepted at its second equal sample in a row, pressed and
/// released alike and each sensor for itself; so a steady change counts one tick late, and a change of a single tick
/// does not count. At the start nothing is pressed. The thesis's sensors are debounced too (section 5.1); it does not
/// say how.
class ContactDebouncer {
 public:
  /// raw: the sensors as they are now, in the bits of the state frame's byte 6 (StateFrame::contact_bits); other bits
  /// are ignored. Returns the accepted contacts in the same bits, the others 0.
  std::uint8_t sample(std::uint8_t raw) {
    const unsigned changed = raw ^ last_;
    accepted_ = static_cast<std::uint8_t>(((accepted_ & changed) | (raw & ~changed)) & StateFrame::contact_bits);
    last_ = raw;
    return accepted_;
  }

  /// Back to the start: nothing was ever pressed.
  void reset() { *this = {}; }

 private:
  std::uint8_t last_ = 0;
  std::uint8_t accepted_ = 0;
};

}  // namespace proleg
