#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "sim/mcu/cpu/cpu_surroundings.hpp"
#include "sim/mcu/peripherals/peripheral.hpp"

namespace proleg::sim {

/// The peripherals of a chip that act by themselves. Remembers when the next one acts until this may have changed.
class TimedPeripherals {
 public:
  /// Adds a peripheral, which must outlive this. Of those that are due at a time, the first added acts first.
  void add(Peripheral& peripheral) { members_.push_back(&peripheral); }

  /// The earliest Peripheral::next_event() of all, and next_visible_event().
  [[nodiscard]] LocalTime next_event() const {
    if (!next_) {
      next_ = earliest(&Peripheral::next_event);
    }
    return *next_;
  }
  [[nodiscard]] LocalTime next_visible_event() const {
    if (!next_visible_) {
      next_visible_ = earliest(&Peripheral::next_visible_event);
    }
    return *next_visible_;
  }
  /// To be called when their events may have changed.
  void forget() {
    next_.reset();
    next_visible_.reset();
  }

  /// Calls act(peripheral) for those whose next event has come.
  template <typename Act>
  void for_due(LocalTime now, const Act& act) {
    for (Peripheral* const member : members_) {
      if (member->next_event() <= now) {
        act(*member);
      }
    }
  }

 private:
  [[nodiscard]] LocalTime earliest(LocalTime (Peripheral::*event)() const) const {
    LocalTime next = never_on_chip;
    for (const Peripheral* const member : members_) {
      next = std::min(next, (member->*event)());
    }
    return next;
  }

  std::vector<Peripheral*> members_;
  mutable std::optional<LocalTime> next_;
  mutable std::optional<LocalTime> next_visible_;
};

}  // namespace proleg::sim
