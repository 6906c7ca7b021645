#pragma once

#include <cstdint>

#include "shared/computer/durations/durations.hpp"
#include "shared/kernel/kernel.hpp"
#include "shared/kernel/servo_schedule.hpp"
#include "sim/bus/bus.hpp"

namespace proleg::sim {

/// How long after SYNC the modules give their servos the first pulse width that belongs to it. Ticks count in which a
/// servo interval starts with SYNC: at other ticks the program waits for the interval.
class CommandLatency {
 public:
  CommandLatency(const ServoSchedule& schedule, unsigned joints) : schedule_(schedule), joints_(joints) {}

  /// At the SYNC of a tick, before the modules receive it.
  void begin_tick(std::uint32_t tick, BusTime sync) {
    sync_ = sync;
    awaited_ = schedule_.first_start_us(tick) == 0 ? JointMask::first(joints_) : JointMask();
  }
  /// The module of a joint gives its servo a pulse width.
  void note_command(unsigned joint, BusTime time) {
    if (awaited_.contains(joint) && time >= sync_) {
      awaited_.erase(joint);
      nanoseconds_.add(time - sync_);
    }
  }

  /// In ns, of all joints and ticks so far.
  [[nodiscard]] const Durations& nanoseconds() const { return nanoseconds_; }

 private:
  ServoSchedule schedule_;
  unsigned joints_;
  BusTime sync_ = 0;
  JointMask awaited_;
  Durations nanoseconds_;
};

}  // namespace proleg::sim
