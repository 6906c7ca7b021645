#pragma once

#include <cstdint>

#include "shared/gait/state_frame.hpp"

namespace proleg {

/// Debounces the touch sensors of a joint module: a sensor that bounces as it closes or opens counts once.
///
/// Each sensor is sampled once a tick, at SYNC. A change is accepted at the second equal sample in a row, for pressed
/// and released alike. So a steady change counts one tick late, and a change of a single tick does not count. At the
/// start nothing is pressed. The thesis debounces its sensors, too (section 5.1), but does not describe how.
class ContactDebouncer {
 public:
  /// raw: the present state of the sensors, in the bits of the state frame's byte 6 (StateFrame::contact_bits); other
  /// bits are ignored. Returns the accepted contacts in the same bits, the others 0.
  std::uint8_t sample(std::uint8_t raw) {
    const unsigned changed = raw ^ last_;
    accepted_ = static_cast<std::uint8_t>(((accepted_ & changed) | (raw & ~changed)) & StateFrame::contact_bits);
    last_ = raw;
    return accepted_;
  }

  /// Returns to the start, at which nothing is pressed.
  void reset() { *this = {}; }

 private:
  std::uint8_t last_ = 0;
  std::uint8_t accepted_ = 0;
};

}  // namespace proleg
