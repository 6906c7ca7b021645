#pragma once

#include <cstdint>
#include <vector>

#include "sim/bus/controller.hpp"

namespace proleg::sim {

/// Controllers that wait for sequences of 11 recessive bits: for one to join the bus, for 128 to leave bus-off. Behind
/// each frame and each error frame there are 8 such bits and the interframe space; while the bus is idle they go on.
/// Whenever 11 have come they count, and the next one is the first of another sequence.
class RecessiveWaits {
 public:
  explicit RecessiveWaits(std::uint64_t bit_rate) : bit_rate_(bit_rate) {}

  [[nodiscard]] bool empty() const { return waits_.empty(); }
  /// No bit before `now` counts. Nothing for a controller that waits already.
  void add(Controller& controller, unsigned sequences, BusTime now);
  void remove(const Controller& controller);
  [[nodiscard]] bool contains(const Controller& controller) const;

  /// A frame or error frame ends. Need not be called while nobody waits.
  void begin_silence(BusTime end_of_frame);
  /// A frame begins. Need not be called while nobody waits.
  void end_silence(BusTime time);

  /// When the next wait ends if no frame begins before; never_on_bus if nobody waits.
  [[nodiscard]] BusTime next_end() const { return waits_.empty() ? never_on_bus : first_end(); }
  /// Whose waits end at this time; they are still among the waiting.
  [[nodiscard]] std::vector<Controller*> ending_at(BusTime time) const;

 private:
  struct Wait {
    Controller* controller;
    unsigned sequences;  ///< still to come
    BusTime since;       ///< no bit before this counts
  };

  [[nodiscard]] BusTime first_end() const;
  [[nodiscard]] BusTime end_of(const Wait& wait) const;

  std::uint64_t bit_rate_;
  BusTime recessive_since_ = 0;  ///< while no frame is on the wire
  std::vector<Wait> waits_;
};

}  // namespace proleg::sim
