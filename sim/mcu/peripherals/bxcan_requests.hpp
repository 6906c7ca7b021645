#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "sim/bus/controller.hpp"

namespace proleg::sim {

/// The requests of the program to bxCAN, in their order. A chip computes ahead of the bus: a request is pending until
/// the bus has reached its true time.
class BxCanRequests {
 public:
  enum class Kind : std::uint8_t { transmit, abort, control };
  struct Request {
    BusTime time;
    Kind kind;
    std::uint32_t value;  ///< number of the mailbox, or value of MCR
  };

  /// Adds a request. A request that is earlier than the last pending one is due together with that one.
  void add(BusTime time, Kind kind, std::uint32_t value);
  /// Puts a request that was taken back to the front, due at another time. Later requests wait for it.
  void postpone(const Request& request, BusTime time);
  /// Takes the next request if it is due.
  [[nodiscard]] std::optional<Request> take_due(BusTime now);
  void clear() { pending_.clear(); }

  [[nodiscard]] bool empty() const { return pending_.empty(); }
  /// True time of the next request; never_on_bus if none is pending.
  [[nodiscard]] BusTime next_time() const { return empty() ? never_on_bus : pending_.front().time; }

 private:
  std::deque<Request> pending_;
};

}  // namespace proleg::sim
