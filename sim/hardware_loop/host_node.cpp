#include "sim/hardware_loop/host_node.hpp"

#include <utility>

#include "shared/computer/master/master_report.hpp"
#include "shared/kernel/fingerprint.hpp"

namespace proleg::sim {

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

std::optional<std::string> HostNode::take_problem() {
  if (master_.problem().code == canopen::ProblemCode::none || problem_taken_) {
    return std::nullopt;
  }
  problem_taken_ = true;
  return problem_text(master_.problem(), [this](std::uint8_t node) { return name_of_node(scenario_, node); });
}

std::optional<std::string> HostNode::take_event() {
  const auto event = master_.take_event();
  if (!event) {
    return std::nullopt;
  }
  return event_text(*event, [this](std::uint8_t node) { return name_of_node(scenario_, node); });
}

}  // namespace proleg::sim
