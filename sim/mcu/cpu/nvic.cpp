#include "sim/mcu/cpu/nvic.hpp"

#include <algorithm>

namespace proleg::sim {

void Nvic::reset() {
  pending_ = {};
  enabled_ = {};
  active_ = {};
  for (const unsigned always : {exception::nmi, exception::hard_fault, exception::supervisor_call,
                                exception::pending_supervisor, exception::system_tick}) {
    enabled_.set(always, true);
  }
  lines_.for_each([&](unsigned number) { pending_.set(number, true); });
  priorities_ = {};
  priority_group_ = 0;
  find_next();
  find_active();
}

void Nvic::set_exception_line(unsigned number, bool high) {
  if (lines_.has(number) == high) {
    return;
  }
  lines_.set(number, high);
  if (high) {
    set_pending(number, true);
  }
}

void Nvic::set_pending(unsigned number, bool pending) {
  // A line that is high pends again at once.
  pending_.set(number, pending || lines_.has(number));
  find_next();
}

void Nvic::set_enabled(unsigned number, bool enabled) {
  enabled_.set(number, enabled);
  find_next();
}

void Nvic::set_priority(unsigned number, std::uint8_t priority) {
  priorities_[number] = priority & implemented_priority;
  find_next();
  find_active();
}

void Nvic::set_priority_group(std::uint8_t group) {
  priority_group_ = group & 7U;
  find_next();
  find_active();
}

void Nvic::activate(unsigned number) {
  pending_.set(number, false);
  active_.set(number, true);
  find_next();
  active_priority_ = std::min(active_priority_, group_priority(number));
}

void Nvic::deactivate(unsigned number) {
  active_.set(number, false);
  if (lines_.has(number)) {
    pending_.set(number, true);
  }
  find_next();
  find_active();
}

int Nvic::priority(unsigned number) const {
  switch (number) {
    case exception::reset:
      return -3;
    case exception::nmi:
      return -2;
    case exception::hard_fault:
      return -1;
    default:
      return priorities_[number];
  }
}

int Nvic::group_priority(unsigned number) const {
  const int own = priority(number);
  return own < 0 ? own : own & ~((2 << priority_group_) - 1);
}

int Nvic::execution_priority(const ExceptionMasks& masks) const {
  int boosted = no_priority;
  const int basepri = static_cast<int>(masks.basepri & implemented_priority);
  if (basepri != 0) {
    boosted = basepri & ~((2 << priority_group_) - 1);
  }
  if ((masks.primask & 1U) != 0) {
    boosted = 0;
  }
  if ((masks.faultmask & 1U) != 0) {
    boosted = -1;
  }
  return std::min(boosted, active_priority_);
}

bool Nvic::any_interrupt_pending() const {
  bool found = false;
  pending_.for_each([&](unsigned number) { found = found || number >= exception::first_interrupt; });
  return found;
}

void Nvic::find_next() {
  // Of equal priority, the lowest number comes first.
  int best = no_priority;
  next_ = 0;
  (pending_ & enabled_).for_each([&](unsigned number) {
    if (priority(number) < best) {
      best = priority(number);
      next_ = number;
    }
  });
  next_priority_ = next_ == 0 ? no_priority : group_priority(next_);
}

void Nvic::find_active() {
  active_priority_ = no_priority;
  active_.for_each([&](unsigned number) { active_priority_ = std::min(active_priority_, group_priority(number)); });
}

}  // namespace proleg::sim
