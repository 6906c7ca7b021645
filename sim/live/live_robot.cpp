#include "sim/live/live_robot.hpp"

#include <algorithm>
#include <utility>

#include "shared/canopen/messages.hpp"

namespace proleg::sim {
namespace {

HardwareOptions for_rack(const LiveRobotOptions& options) {
  HardwareOptions rack;
  rack.make_module = options.make_module;
  rack.change_identity = options.change_identity;
  rack.crystal_error_ppm = options.crystal_error_ppm;
  rack.gateway = options.gateway;
  rack.threads = options.threads;
  return rack;
}

}  // namespace

LiveRobot::LiveRobot(const Scenario& scenario, LiveRobotOptions options)
    : scenario_(scenario),
      options_(std::move(options)),
      rack_options_(for_rack(options_)),
      plant_(scenario),
      plant_ticks_(
          scenario, plant_, [this](std::uint32_t joint) { return rack_.pulse(joint); },
          [this](BusTime now) { rack_.catch_up_before(now); }),
      rack_(bus_, plant_, scenario, rack_options_),
      adapter_(bus_.attach(*this)) {
  bus_.set_frame_listener([this](const Transmission& transmission) { on_frame(transmission); });
  adapter_.set_order(Controller::Order::request);
  plant_.let_it_rest();
  rack_.power_on(0);
  begin_tick(0, false);
}

BusTime LiveRobot::next_event() const {
  return std::max(std::min({bus_.next_event(), plant_ticks_.next_event(), rack_.next_event(), tick_deadline()}),
                  bus_.now());
}

void LiveRobot::advance_to(BusTime time) {
  run_events(time, false);
  bus_.advance_to(time);
  take_problems();
}

void LiveRobot::advance_to_frame(BusTime time) {
  if (run_events(time, true)) {
    bus_.advance_to(time);
  }
  take_problems();
}

bool LiveRobot::run_events(BusTime time, bool ends_with_frame) {
  has_had_frame_ = false;
  for (BusTime next = next_event(); next <= time; next = next_event()) {
    plant_ticks_.advance_to(next);
    bus_.advance_to(next);
    if (plant_ticks_.is_complete(next)) {
      plant_ticks_.complete();
      ++ticks_;
    }
    if (tick_deadline() <= next) {
      plant_ticks_.end(next);
      begin_tick(tick_begin_ + tick_period(), false);
    }
    // A frame from an outside program is on the bus after `time`, so it is delivered after `time` too.
    const BusTime quiet_until = bus_.earliest_delivery();
    // At `time` the caller may use the modules.
    const BusTime ahead_until =
        bus_.is_watched() ? next : std::min({quiet_until, plant_ticks_.next_event(), tick_deadline(), time});
    rack_.advance_to(next, quiet_until, ahead_until);
    if (ends_with_frame && has_had_frame_) {
      return false;
    }
  }
  return true;
}

BusTime LiveRobot::tick_deadline() const {
  if (plant_ticks_.has_ended()) {
    return never_on_bus;
  }
  // A SYNC may come a little late: a quarter of the period.
  return tick_begin_ + tick_period() + (follows_sync_ ? tick_period() / 4 : 0);
}

void LiveRobot::begin_tick(BusTime now, bool has_sync) {
  follows_sync_ = has_sync;
  tick_begin_ = now;
  rack_.begin_tick(begun_ticks_, now);
  plant_ticks_.begin(begun_ticks_++, now);
}

void LiveRobot::on_frame(const Transmission& transmission) {
  has_had_frame_ = true;
  if (options_.on_frame) {
    options_.on_frame(transmission, transmission.sender == adapter_.index());
  }
  if (transmission.sender < rack_.size() && canopen::decode_sync(transmission.frame)) {
    take_sync(transmission.end);
  }
}

void LiveRobot::take_sync(BusTime now) {
  if (!follows_sync_ && now < tick_begin_ + tick_period() / 4) {
    // The SYNC belongs to the tick that has just begun without it.
    follows_sync_ = true;
    tick_begin_ = now;
    return;
  }
  if ((follows_sync_ && now < tick_begin_ + tick_period() / 2) || plant_ticks_.has_ended()) {
    return;
  }
  plant_ticks_.end(now);
  begin_tick(now, true);
}

bool LiveRobot::send(const CanFrame& frame, std::uint32_t source) {
  if (waiting() >= max_waiting) {
    return false;
  }
  waiting_.push_back({frame, source});
  fill_mailboxes();
  return true;
}

void LiveRobot::fill_mailboxes() {
  while (!waiting_.empty() && adapter_.send(waiting_.front().frame)) {
    in_mailboxes_.push_back(waiting_.front());
    waiting_.pop_front();
  }
}

void LiveRobot::transmitted(BusTime time, const CanFrame& frame) {
  if (!in_mailboxes_.empty()) {
    const std::uint32_t source = in_mailboxes_.front().source;
    in_mailboxes_.pop_front();
    has_had_frame_ = true;
    if (options_.on_sent) {
      options_.on_sent(time, frame, source);
    }
  }
  fill_mailboxes();
}

void LiveRobot::error_state_changed(BusTime /*time*/) {
  if (adapter_.error_state() == ErrorState::bus_off) {
    in_mailboxes_.clear();  // the controller has dropped them
    adapter_.recover();
  } else {
    fill_mailboxes();
  }
  if (options_.on_state) {
    options_.on_state(adapter_);
  }
}

void LiveRobot::take_problems() {
  for (unsigned joint = 0; joint < rack_.size(); ++joint) {
    while (const auto problem = rack_.module(joint).take_problem()) {
      if (options_.notice) {
        options_.notice(scenario_.robot.joints[joint].name + " (node " + std::to_string(scenario_.modules[joint].node) +
                        "): " + *problem);
      }
    }
  }
}

}  // namespace proleg::sim
