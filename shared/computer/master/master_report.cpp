#include "shared/computer/master/master_report.hpp"

#include "shared/canopen/object_name.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::canopen {

std::string_view describe(ProblemCode code) {
  switch (code) {
    case ProblemCode::none:
      return "no problem";
    case ProblemCode::bus_too_small:
      return "the state frames may fill the bus";
    case ProblemCode::bad_setup:
      return "the set-up needs one node and one pair of limits for each joint";
    case ProblemCode::bad_change:
      return "a change is not possible";
    case ProblemCode::missing_module:
      return "a module is missing";
    case ProblemCode::duplicate_node:
      return "two modules have one node id, or a module has restarted";
    case ProblemCode::unexpected_node:
      return "the node does not belong to the robot";
    case ProblemCode::other_host:
      return "another host uses the bus";
    case ProblemCode::lease_refused:
      return "another host drives this robot";
    case ProblemCode::wrong_serial:
      return "wrong serial number";
    case ProblemCode::wrong_protocol:
      return "wrong version of the protocol";
    case ProblemCode::wrong_fingerprint:
      return "wrong core fingerprint";
    case ProblemCode::missing_algorithm:
      return "the program of the module lacks an algorithm";
    case ProblemCode::refused:
      return "a module refuses its set-up";
    case ProblemCode::no_answer:
      return "a module does not answer";
    case ProblemCode::wrong_configuration:
      return "a module has the wrong configuration";
    case ProblemCode::not_enabled:
      return "a servo does not get power";
    case ProblemCode::not_ramped_in:
      return "a joint does not reach the angle at which the gait starts";
    case ProblemCode::not_operational:
      return "a module does not become operational";
    case ProblemCode::late_answers:
      return "the modules answer too late for a robot that must be stopped in time";
    case ProblemCode::robot_silent:
      return "nothing comes from the modules any more";
    case ProblemCode::module_silent:
      return "a module is silent";
    case ProblemCode::commit_too_late:
      return "a change came too late for its tick";
    case ProblemCode::change_refused:
      return "a module refuses a change";
    case ProblemCode::sync_lost:
      return "SYNC is lost";
    case ProblemCode::cannot_send:
      return "the master cannot send on the bus";
  }
  return "unknown problem";
}

std::string_view describe(EventKind kind) {
  switch (kind) {
    case EventKind::emergency:
      return "emergency message";
    case EventKind::restarted:
      return "module has restarted";
    case EventKind::rejoined:
      return "module is set up again";
    case EventKind::rejoin_failed:
      return "module could not be set up again";
    case EventKind::silent:
      return "module is silent";
    case EventKind::heartbeat_returned:
      return "heartbeat of the module is back";
    case EventKind::not_reached:
      return "module did not answer while a change was staged";
    case EventKind::left_operational:
      return "module is no longer operational";
    case EventKind::unexpected_node:
      return "node does not belong to the robot";
    case EventKind::change_dropped:
      return "change was dropped";
    case EventKind::not_stopped:
      return "module did not confirm that its servo has no power";
    case EventKind::other_host:
      return "another host uses the bus";
  }
  return "unknown event";
}

void EventLog::add(const Event& event) {
  if (size_ == capacity) {
    ++overflow_;
    return;
  }
  events_[(first_ + size_) % capacity] = event;
  ++size_;
}

std::optional<Event> EventLog::take() {
  if (size_ == 0) {
    return std::nullopt;
  }
  const Event event = events_[first_];
  first_ = (first_ + 1) % capacity;
  --size_;
  return event;
}

}  // namespace proleg::canopen

namespace proleg {
namespace {

std::string in_text(canopen::Address address) {
  return hexadecimal(address.index, 4) + ":" + std::to_string(address.sub);
}

std::string algorithm_text(const canopen::Problem& problem) {
  const ActuationModule* algorithm = find_algorithm(problem.algorithm);
  const std::string name =
      algorithm == nullptr ? "with id " + std::to_string(problem.algorithm) : in_quotes(algorithm->declaration().name);
  const std::string found =
      problem.found == 0 ? "none" : "one of other sources (" + hexadecimal(problem.found, 8) + ")";
  return ": found " + found + ", expected the algorithm " + name + " with sources " + hexadecimal(problem.expected, 8) +
         "; flash an image that is built with it (docs/user-algorithms.md)";
}

}  // namespace

std::string problem_text(const canopen::Problem& problem, const NodeName& name) {
  using canopen::ProblemCode;
  if (problem.code == ProblemCode::lease_refused) {
    return std::string(describe(problem.code)) + " (" + name(problem.node) + " has given it the lease)";
  }
  std::string text = problem.node == 0 ? "" : name(problem.node) + ": ";
  text += describe(problem.code);
  switch (problem.code) {
    case ProblemCode::wrong_serial:
    case ProblemCode::wrong_protocol:
    case ProblemCode::wrong_fingerprint:
    case ProblemCode::wrong_configuration:
    case ProblemCode::not_enabled:
      text += ": found " + hexadecimal(problem.found, 8) + ", expected " + hexadecimal(problem.expected, 8);
      break;
    case ProblemCode::missing_algorithm:
      text += algorithm_text(problem);
      break;
    case ProblemCode::refused:
    case ProblemCode::change_refused:
      text += ": object " + in_text(problem.address) + ", " + std::string(canopen::describe(problem.abort_code));
      break;
    case ProblemCode::bus_too_small:
      text += ": found up to " + std::to_string((problem.found + 9) / 10) + " % of it, expected at most " +
              std::to_string(problem.expected / 10) + " %: a longer tick helps";
      break;
    case ProblemCode::late_answers:
      text += ": found answers after " + std::to_string(problem.found) + " ms, expected at most " +
              std::to_string(problem.expected) + " ms; the servos get no power: check the connection";
      break;
    case ProblemCode::no_answer:
      text += ": object " + in_text(problem.address);
      break;
    case ProblemCode::commit_too_late:
      text += ": for tick " + std::to_string(problem.expected) + ", found at tick " + std::to_string(problem.found) +
              ", expected earlier";
      break;
    default:
      break;
  }
  return text;
}

std::string event_text(const canopen::Event& event, const NodeName& name) {
  using canopen::EventKind;
  std::string text(canopen::describe(event.kind));
  if (event.kind == EventKind::change_dropped) {
    return text + ": the one for tick " + std::to_string(event.detail);
  }
  text = name(event.node) + ": " + text;
  if (event.kind == EventKind::emergency) {
    text += " " + hexadecimal(static_cast<std::uint16_t>(event.code), 4) + ", " +
            std::string(canopen::describe(event.code)) + " (" + std::to_string(event.detail) + ")";
  }
  return text;
}

}  // namespace proleg
