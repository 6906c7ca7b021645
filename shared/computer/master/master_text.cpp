#include "shared/computer/master/master_text.hpp"

#include "shared/canopen/object_name.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"

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
