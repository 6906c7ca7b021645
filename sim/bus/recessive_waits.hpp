#pragma once

#include <cstdint>
#include <vector>

#include "sim/bus/controller.hpp"

namespace proleg::sim {

/// Controllers that wait for sequences of 11 recessive bits: for one to join the bus, for 128 to leave bus-off. Each
/// frame and each error frame ends with 8 recessive bits, the interframe space and, if the bus is idle, more of them.
/// After 11 bits a sequence is complete, and the next bit starts a new one.
class RecessiveWaits {
 public:
  explicit RecessiveWaits(std::uint64_t bit_rate) : bit_rate_(bit_rate) {}

  [[nodiscard]] bool empty() const { return waits_.empty(); }
  /// No bit before `now` counts. No effect if the controller waits already.
  void add(Controller& controller, unsigned sequences, BusTime now);
  void remove(const Controller& controller);
  [[nodiscard]] bool contains(const Controller& controller) const;

  /// A frame or error frame ends. Need not be called while no controller waits.
  void begin_silence(BusTime end_of_frame);
  /// The bus is recessive from now on, after something that was no frame.
  void begin_idle(BusTime now) { recessive_since_ = now; }
  /// A frame begins. Need not be called while no controller waits.
  void end_silence(BusTime time);

  /// When the next wait ends if no frame begins before; never_on_bus if no controller waits.
  [[nodiscard]] BusTime next_end() const { return waits_.empty() ? never_on_bus : first_end(); }
  /// The controllers whose waits end at this time; remove() has not been called for them.
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
  BusTime recessive_since_ = 0;  ///< valid while no frame is on the wire
  std::vector<Wait> waits_;
};

}  // namespace proleg::sim
