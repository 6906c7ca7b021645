#pragma once

// What the master has to tell people: why a robot does not run (Problem), and what happened on the way (Event).

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "shared/can/can_port.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/object.hpp"

namespace proleg::canopen {

enum class ProblemCode : std::uint8_t {
  none,
  // Found before anything is sent.
  bad_setup,      ///< a joint without a node of its own (1 to 126), spans of other lengths than the joint count
  bus_too_small,  ///< the robot may take `found` thousandths of the bus, more than `expected`
  bad_change,     ///< `change` names a value that its joint does not have, too many values, or is not behind the one
                  ///< before
  // The start ends with these.
  missing_module,       ///< no boot-up message of `node` came in time
  duplicate_node,       ///< `node` booted twice, or says that another module has its id
  unexpected_node,      ///< `node` is on the bus, but not in the set-up
  wrong_serial,         ///< `found` and `expected`, as for all that follow
  foreign_protocol,     ///< version of docs/protocol.md
  foreign_fingerprint,  ///< the module computes with another core
  refused,              ///< the module refused `address` with `abort_code`
  no_answer,            ///< the module did not answer a request for `address`
  wrong_configuration,  ///< after set-up the module has another configuration CRC than the master
  not_operational,      ///< the module does not say in time that it is Operational; `found`: its last state
  // In flight.
  commit_too_late,  ///< `change` for the tick `expected` could not be committed by the tick `found`; it is dropped
  change_refused,   ///< the module refused a value of `change` with `abort_code`; the change is dropped for all
  sync_lost,        ///< no SYNC is heard, or `node`, which produces it, has restarted: the robot has stopped
  cannot_send,      ///< no frame of the master gets onto the bus
};

/// The same in one short phrase.
[[nodiscard]] std::string_view describe(ProblemCode code);

struct Problem {
  static constexpr std::uint8_t no_joint = 0xFF;

  ProblemCode code = ProblemCode::none;
  std::uint8_t node = 0;  ///< 0: no one in particular
  std::uint8_t joint = no_joint;
  Address address = {};
  AbortCode abort_code = AbortCode::none;
  std::uint32_t found = 0;
  std::uint32_t expected = 0;
  std::size_t change = 0;  ///< position in the list of changes
};

enum class EventKind : std::uint8_t {
  emergency,      ///< EMCY with `code`, `error_register` and `detail`; code `none`: an error is over
  restarted,      ///< the node has booted while the robot runs; it is set up again. detail: number of restarts so far
  rejoined,       ///< a restarted node is set up and started
  rejoin_failed,  ///< it could not be set up again; detail: ProblemCode
  silent,         ///< no heartbeat for 500 ms; changes are made without the node
  heard_again,    ///< its heartbeat is back
  not_reached,    ///< it did not answer while values were staged; changes are made without it
  left_operational,  ///< its heartbeat says another state; detail: NmtState
  unexpected_node,   ///< a node that is not in the set-up has booted
  change_dropped,    ///< detail: tick of the change; see Problem
};

/// The same in one short phrase.
[[nodiscard]] std::string_view describe(EventKind kind);

struct Event {
  Microseconds time;
  EventKind kind;
  std::uint8_t node = 0;
  std::uint8_t error_register = 0;
  EmergencyCode code = EmergencyCode::none;
  std::uint32_t detail = 0;
};

/// The first events that nobody has fetched yet, oldest first; later ones are counted.
class EventLog {
 public:
  static constexpr std::size_t capacity = 64;

  void add(const Event& event);
  [[nodiscard]] std::optional<Event> take();
  /// Events that found no room.
  [[nodiscard]] std::uint32_t overflow() const { return overflow_; }

 private:
  std::array<Event, capacity> events_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint32_t overflow_ = 0;
};

}  // namespace proleg::canopen
