#pragma once

#include "shared/can/can_port.hpp"

namespace proleg::firmware {

/// A wait that ends once. It does not run before start() is called.
class Timeout {
 public:
  /// Starts the wait, also again. duration_us: counted from now on.
  void start(Microseconds now, Microseconds duration_us) { ends_at_ = now + duration_us; }
  void stop() { ends_at_ = never; }
  [[nodiscard]] bool is_running() const { return ends_at_ != never; }
  /// True once when the duration has passed. Then the wait does not run any more.
  [[nodiscard]] bool poll(Microseconds now) {
    if (now < ends_at_) {
      return false;
    }
    ends_at_ = never;
    return true;
  }
  [[nodiscard]] Microseconds deadline() const { return ends_at_; }

 private:
  Microseconds ends_at_ = never;
};

}  // namespace proleg::firmware
