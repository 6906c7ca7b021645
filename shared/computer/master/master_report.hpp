#pragma once

// The reports of the master: why a robot does not run (Problem), and events on the way (Event); and their text of one
// line for a person, which the simulator's host node and the host programs print.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "shared/can/can_port.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/object.hpp"

namespace proleg::canopen {

enum class ProblemCode : std::uint8_t {
  none,
  // These problems are found before a frame is sent.
  bad_setup,      ///< two joints have the same node, a node is not in 1 to 126, or a span has not one element for each
                  ///< joint
  bus_too_small,  ///< the robot may take `found` thousandths of the bus, more than `expected`
  bad_change,     ///< `change` names a value that its joint does not have, has too many values, or is not later than
                  ///< the change before it
  // These problems end the start.
  missing_module,       ///< no boot-up message of `node` was received before the timeout
  duplicate_node,       ///< `node` booted twice, or reports that another module has its id
  unexpected_node,      ///< `node` is on the bus, but not in the set-up
  other_host,           ///< another host sends heartbeats on the bus
  lease_refused,        ///< `node` has given its lease (0x2002) to another host
  wrong_serial,         ///< the serial number is wrong; `found` and `expected` have values as for all wrong_ codes
  wrong_protocol,       ///< the version of docs/protocol.md is wrong
  wrong_fingerprint,    ///< the module computes with another core
  missing_algorithm,    ///< the module has no `algorithm`, or one of other sources; `found` and `expected` as 0x200F
  refused,              ///< the module refused `address` with `abort_code`
  no_answer,            ///< the module did not answer a request for `address`
  wrong_configuration,  ///< after set-up, the configuration CRC of the module is not the master's
  not_enabled,          ///< the drive of the module is not in Operation enabled; `found` and `expected` are statuswords
  not_ramped_in,        ///< the joint does not reach the start of the gait before the timeout
  not_operational,      ///< the heartbeat of the module does not report Operational before the timeout
  late_answers,         ///< half of the answers of the modules take longer than `found` ms, more than `expected` ms
  robot_silent,         ///< no module has sent a frame for 400 ms while they got power
  module_silent,        ///< the module has sent no heartbeat for 500 ms while the servos got power
  // These problems occur while the robot runs.
  commit_too_late,  ///< `change` for the tick `expected` could not be committed by the tick `found`; it is dropped
  change_refused,   ///< the module refused a value of `change` with `abort_code`; the change is dropped for all
  sync_lost,        ///< no SYNC is received, or `node`, which produces it, has restarted: the robot has stopped
  cannot_send,      ///< no frame of the master is sent on the bus
};

/// A short phrase that describes the problem, for messages.
[[nodiscard]] std::string_view describe(ProblemCode code);

struct Problem {
  static constexpr std::uint8_t no_joint = 0xFF;

  ProblemCode code = ProblemCode::none;
  std::uint8_t node = 0;  ///< node id; 0: no particular node
  std::uint8_t joint = no_joint;
  Address address = {};
  AbortCode abort_code = AbortCode::none;
  std::uint32_t found = 0;
  std::uint32_t expected = 0;
  std::size_t change = 0;      ///< position in the list of changes
  std::uint8_t algorithm = 0;  ///< id of the algorithm
};

enum class EventKind : std::uint8_t {
  emergency,           ///< EMCY with `code`, `error_register` and `detail`; code `none`: an error is over
  restarted,           ///< the node has booted while the robot runs; it is set up again. detail: number of restarts
  rejoined,            ///< a restarted node is set up and started
  rejoin_failed,       ///< a restarted node could not be set up; detail: ProblemCode
  silent,              ///< the node has sent no heartbeat for 500 ms; changes are made without it
  heartbeat_returned,  ///< a silent node has sent a heartbeat again
  not_reached,         ///< the node did not answer while values were staged; changes are made without it
  left_operational,    ///< the heartbeat reports another state; detail: NmtState
  unexpected_node,     ///< a node that is not in the set-up has booted
  change_dropped,      ///< a change was dropped, see Problem; detail: its tick
  not_stopped,         ///< the node did not confirm that its servo has no power
  other_host,          ///< another host sends heartbeats on the bus; reported once
};

/// A short phrase that describes the event, for messages.
[[nodiscard]] std::string_view describe(EventKind kind);

struct Event {
  Microseconds time;
  EventKind kind;
  std::uint8_t node = 0;
  std::uint8_t error_register = 0;
  EmergencyCode code = EmergencyCode::none;
  std::uint32_t detail = 0;
};

/// Events that are not taken yet, oldest first. When the log is full, it counts further events and drops them.
class EventLog {
 public:
  static constexpr std::size_t capacity = 64;

  void add(const Event& event);
  [[nodiscard]] std::optional<Event> take();
  /// Number of dropped events.
  [[nodiscard]] std::uint32_t overflow() const { return overflow_; }

 private:
  std::array<Event, capacity> events_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint32_t overflow_ = 0;
};

}  // namespace proleg::canopen

namespace proleg {

/// The name of a node in a message: "node 3 (J3)".
using NodeName = std::function<std::string(std::uint8_t node)>;

/// Text of the problem that ended the start, or of the first problem while the robot moves: the module, what was found
/// and what was expected. problem: with a code other than `none`.
[[nodiscard]] std::string problem_text(const canopen::Problem& problem, const NodeName& name);

/// Text of an event.
[[nodiscard]] std::string event_text(const canopen::Event& event, const NodeName& name);

}  // namespace proleg
