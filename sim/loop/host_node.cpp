#include "sim/loop/host_node.hpp"

#include <utility>

#include "shared/canopen/object_name.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/fingerprint.hpp"

namespace proleg::sim {
namespace {

std::string in_text(canopen::Address address) {
  return hexadecimal(address.index, 4) + ":" + std::to_string(address.sub);
}

}  // namespace

MasterInput::MasterInput(const Scenario& scenario) {
  for (const ModulePlace& module : scenario.modules) {
    nodes_.push_back(module.node);
    serials.push_back(module.serial.value_or(0));
  }
  for (const JointLimits& limits : scenario.joint_limits) {
    limits_.push_back({limits.lower, limits.upper});
  }
  for (const Setting& setting : scenario.settings) {
    start_values_.push_back({setting.slot, setting.joint, setting.index, setting.value});
  }
  for (const Change& change : scenario.changes) {
    std::vector<canopen::ChangedValue>& values = changed_values_.emplace_back();
    for (const Setting& setting : change.settings) {
      values.push_back({setting.slot, setting.joint, setting.index, setting.internal, setting.value});
    }
  }
  for (std::size_t i = 0; i < scenario.changes.size(); ++i) {
    changes.push_back({scenario.changes[i].tick, changed_values_[i]});
  }
  setup.kernel = scenario.kernel;
  setup.servo_period_us = scenario.robot.servo.period_us;
  setup.command_speed = scenario.robot.servo.command_speed;
  setup.nodes = nodes_;
  setup.limits = limits_;
  setup.start_values = start_values_;
}

HostNode::HostNode(Bus& bus, const Scenario& scenario, unsigned sync_producer)
    : scenario_(scenario),
      input_(scenario),
      controller_(bus.attach(*this)),
      master_(controller_, input_.setup,
              {.core_fingerprint = core_fingerprint,
               .serials = input_.serials,
               .sync_producer = static_cast<std::uint8_t>(sync_producer)},
              input_.changes) {}

void HostNode::start(BusTime now) {
  master_.start(clock_.at(now));
  update_deadline();
}

void HostNode::advance_to(BusTime now) {
  master_.poll(clock_.at(now));
  update_deadline();
}

void HostNode::resume(BusTime now) {
  if (is_dead_) {
    return;
  }
  is_stalled_ = false;
  for (const Missed& missed : std::exchange(missed_, {})) {
    missed.was_sent ? transmitted(now, missed.frame) : received(now, missed.frame);
  }
  advance_to(now);
}

void HostNode::die() {
  controller_.switch_off();
  is_stalled_ = is_dead_ = true;
  update_deadline();
}

void HostNode::received(BusTime time, const CanFrame& frame) {
  if (is_stalled_) {
    missed_.push_back({frame, false});
    return;
  }
  master_.receive(clock_.at(time), frame);
  update_deadline();
}

void HostNode::transmitted(BusTime time, const CanFrame& frame) {
  if (is_stalled_) {
    missed_.push_back({frame, true});
    return;
  }
  master_.transmitted(clock_.at(time), frame);
  update_deadline();
}

std::string HostNode::name_of(std::uint8_t node) const {
  for (std::size_t joint = 0; joint < scenario_.modules.size(); ++joint) {
    if (scenario_.modules[joint].node == node) {
      return "node " + std::to_string(node) + " (" + scenario_.robot.joints[joint].name + ")";
    }
  }
  return "node " + std::to_string(node);
}

std::optional<std::string> HostNode::take_problem() {
  using canopen::ProblemCode;
  const canopen::Problem& problem = master_.problem();
  if (problem.code == ProblemCode::none || problem_taken_) {
    return std::nullopt;
  }
  problem_taken_ = true;
  std::string text = problem.node == 0 ? "" : name_of(problem.node) + ": ";
  text += describe(problem.code);
  switch (problem.code) {
    case ProblemCode::wrong_serial:
    case ProblemCode::wrong_protocol:
    case ProblemCode::wrong_fingerprint:
    case ProblemCode::wrong_configuration:
      text += ": found " + hexadecimal(problem.found, 8) + ", expected " + hexadecimal(problem.expected, 8);
      break;
    case ProblemCode::refused:
    case ProblemCode::change_refused:
      text += ": object " + in_text(problem.address) + ", " + std::string(canopen::describe(problem.abort_code));
      break;
    case ProblemCode::no_answer:
      text += ": object " + in_text(problem.address);
      break;
    case ProblemCode::commit_too_late:
      text += ": for tick " + std::to_string(problem.expected) + ", found at tick " + std::to_string(problem.found) +
              ", expected " + std::to_string(canopen::Master::commit_lead) + " ticks before";
      break;
    default:
      break;
  }
  return text;
}

std::optional<std::string> HostNode::take_event() {
  using canopen::EventKind;
  const auto event = master_.take_event();
  if (!event) {
    return std::nullopt;
  }
  std::string text(canopen::describe(event->kind));
  if (event->kind == EventKind::change_dropped) {
    return text + ": the one for tick " + std::to_string(event->detail);
  }
  text = name_of(event->node) + ": " + text;
  if (event->kind == EventKind::emergency) {
    text += " " + hexadecimal(static_cast<std::uint16_t>(event->code), 4) + ", " +
            std::string(canopen::describe(event->code)) + " (" + std::to_string(event->detail) + ")";
  }
  return text;
}

}  // namespace proleg::sim
