#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sim/mcu/cpu/cpu_surroundings.hpp"
#include "sim/mcu/peripherals/peripheral.hpp"

namespace proleg::sim {

/// The peripherals of a chip that act by themselves. Remembers when each acts next until this may have changed.
class TimedPeripherals {
 public:
  /// Whose events a write to a register of the peripheral may change.
  enum class Effect : std::uint8_t { on_itself, on_others };

  /// Adds a peripheral, which must outlive this. Of those that are due at a time, the first added acts first.
  void add(Peripheral& peripheral, Effect effect) { members_.push_back({&peripheral, effect}); }

  /// The earliest Peripheral::next_event() of all, and next_visible_event().
  [[nodiscard]] LocalTime next_event() const {
    ask();
    return next_;
  }
  [[nodiscard]] LocalTime next_visible_event() const {
    ask();
    return next_visible_;
  }

  /// To be called when their events may have changed.
  void forget() {
    is_known_ = false;
    for (Member& member : members_) {
      member.is_known = false;
    }
  }
  /// To be called after a write to a peripheral, which need not be one of these.
  void forget_after_write(const Peripheral& peripheral) {
    const auto found = std::ranges::find(members_, &peripheral, &Member::peripheral);
    if (found != members_.end() && found->effect == Effect::on_itself) {
      is_known_ = false;
      found->is_known = false;
    } else {
      forget();
    }
  }

  /// Calls act(peripheral) for those whose next event has come.
  template <typename Act>
  void for_due(LocalTime now, const Act& act) {
    for (const Member& member : members_) {
      if (member.peripheral->next_event() <= now) {
        act(*member.peripheral);
      }
    }
  }

 private:
  struct Member {
    Peripheral* peripheral;
    Effect effect;
    bool is_known = false;
    LocalTime next = never_on_chip;
    LocalTime next_visible = never_on_chip;
  };

  void ask() const {
    if (is_known_) {
      return;
    }
    next_ = never_on_chip;
    next_visible_ = never_on_chip;
    for (Member& member : members_) {
      if (!member.is_known) {
        member.next = member.peripheral->next_event();
        member.next_visible = member.peripheral->next_visible_event();
        member.is_known = true;
      }
      next_ = std::min(next_, member.next);
      next_visible_ = std::min(next_visible_, member.next_visible);
    }
    is_known_ = true;
  }

  mutable std::vector<Member> members_;
  mutable bool is_known_ = false;
  mutable LocalTime next_ = never_on_chip;
  mutable LocalTime next_visible_ = never_on_chip;
};

}  // namespace proleg::sim
