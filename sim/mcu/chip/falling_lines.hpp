#pragma once

// Lines of interrupts that a write to a peripheral has made low, as long as the write is on its way over a slow bus.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {

class FallingLines {
 public:
  /// The line of the interrupt falls at this time.
  void add(unsigned position, LocalTime time) {
    remove(position);
    positions_.push_back(position);
    next_ = std::max(next_ == never_on_chip ? 0 : next_, time);
  }
  /// The line does not fall, or is low.
  void remove(unsigned position) {
    std::erase(positions_, position);
    next_ = positions_.empty() ? never_on_chip : next_;
  }
  /// Time at which all lines have fallen; never_on_chip if none falls.
  [[nodiscard]] LocalTime next() const { return next_; }
  /// Calls a function with each line, which is low from now on.
  template <typename Fall>
  void finish(Fall fall) {
    for (const unsigned position : positions_) {
      fall(position);
    }
    positions_.clear();
    next_ = never_on_chip;
  }

 private:
  std::vector<unsigned> positions_;
  LocalTime next_ = never_on_chip;
};

}  // namespace proleg::sim
