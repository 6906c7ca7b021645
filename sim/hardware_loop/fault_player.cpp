#include "sim/hardware_loop/fault_player.hpp"

#include <algorithm>

#include "shared/fixed/random.hpp"
#include "shared/gait/joint_readings.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {
namespace {

// Uses of draw() beside the loss of frames, whose use is the number of the joint.
constexpr std::uint32_t for_bus = 0x100;
constexpr std::uint32_t for_touch = 0x200;

// Ramps of a supply: three times as steep as the capacitors of the board allow (docs/board.md). What is above the
// threshold of the detector has no effect, and takes no time.
constexpr std::uint32_t top_of_ramps_mv = 2'940;
constexpr std::uint32_t ramp_step_mv = 20;
constexpr std::uint64_t ramp_step_us = 200;

}  // namespace

FaultState::FaultState(const Scenario& scenario) : scenario_(scenario), modules_(scenario.modules.size()) {}

void FaultState::begin_tick(std::uint32_t tick) {
  tick_ = tick;
  attempts_.fill(0);
}

std::uint32_t FaultState::draw(std::uint32_t use, std::uint32_t detail) const {
  Pcg32 noise(scenario_.kernel.seed + (std::uint64_t{use} << 32U | tick_), random_stream::fault_effects + detail);
  return noise.next();
}

bool FaultState::destroys(const CanFrame& frame) {
  const std::uint32_t attempt = attempts_.at(frame.identifier)++;
  return corruption_ != 0 && draw(for_bus, attempt << 11U | frame.identifier) < corruption_;
}

bool FaultState::loses(const CanFrame& frame, std::size_t receiver) {
  if (receiver >= modules_.size() || modules_[receiver].loss == 0) {
    return false;
  }
  const std::uint32_t attempt = attempts_.at(frame.identifier);
  return draw(static_cast<std::uint32_t>(receiver), attempt << 11U | frame.identifier) < modules_[receiver].loss;
}

std::uint8_t FaultState::sensors(unsigned joint, std::uint8_t contacts) const {
  constexpr unsigned all = StateFrame::contact_bits;
  switch (modules_[joint].touch) {
    case TouchFault::none:
      break;
    case TouchFault::pressed:
      return static_cast<std::uint8_t>(contacts | all);
    case TouchFault::open:
      return static_cast<std::uint8_t>(contacts & ~all);
    case TouchFault::bouncing:
      return static_cast<std::uint8_t>((contacts & ~all) | (draw(for_touch | joint, 0) >> 28U & all));
  }
  return contacts;
}

/// A node that requests its next frame as soon as one was sent.
class FaultPlayer::Babbler final : private BusListener {
 public:
  explicit Babbler(Bus& bus) : controller_(bus.attach(*this)) {}

  void begin(std::uint16_t identifier) {
    frame_.identifier = identifier;
    is_on_ = true;
    controller_.switch_off();
    controller_.switch_on();
    send();
  }
  void end() {
    is_on_ = false;
    controller_.abort_all();
  }

 private:
  void received(BusTime /*time*/, const CanFrame& /*frame*/) override {}
  void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override { send(); }
  void send() {
    while (is_on_ && controller_.send(frame_)) {
    }
  }

  Controller& controller_;
  CanFrame frame_;
  bool is_on_ = false;
};

FaultPlayer::FaultPlayer(const FaultSchedule& schedule, const Stage& stage)
    : stage_(stage), supplies_(stage.scenario.modules.size()) {
  for (const Fault& fault : schedule) {
    actions_.insert({fault.start_us, {&fault, Phase::begin}});
  }
}

FaultPlayer::~FaultPlayer() = default;

void FaultPlayer::begin_tick(std::uint32_t tick, BusTime sync) {
  stage_.state.begin_tick(tick);
  tick_ = tick;
  sync_ = sync;
  has_started_ = true;
}

BusTime FaultPlayer::next_event() const {
  BusTime next = next_action();
  for (const auto& master : masters_) {
    next = std::min(next, master->next_event());
  }
  return next;
}

BusTime FaultPlayer::next_action() const {
  if (!has_started_ || actions_.empty()) {
    return never_on_bus;
  }
  const std::uint64_t tick_us = stage_.scenario.kernel.tick_period_us;
  const std::uint64_t begin_us = tick_ * tick_us;
  const std::uint64_t time_us = actions_.begin()->first;
  if (time_us >= begin_us + tick_us) {
    return never_on_bus;  // in a later tick
  }
  return sync_ + (time_us > begin_us ? (time_us - begin_us) * 1'000 : 0);
}

void FaultPlayer::advance_to(BusTime now) {
  while (next_action() <= now) {
    const auto first = actions_.begin();
    const auto [time_us, action] = *first;
    actions_.erase(first);
    stage_.rack.catch_up_before(now);  // readings change
    act(action, time_us, now);
  }
  for (const auto& master : masters_) {
    if (master->next_event() <= now) {
      master->advance_to(now);
    }
    while (master->take_event()) {
      // The run does not report them, but the list must not grow.
    }
  }
}

void FaultPlayer::act(const Action& action, std::uint64_t time_us, BusTime now) {
  const Fault& fault = *action.fault;
  switch (action.phase) {
    case Phase::begin:
      has_begun_ = true;
      begin(fault, now);
      if (fault.duration_us) {
        actions_.insert({fault.start_us + *fault.duration_us, {&fault, Phase::end}});
      }
      break;
    case Phase::repeat:
      foreign_node_->send_now(fault.frame);
      break;
    case Phase::ramp:
      ramp_supply(fault, time_us, now);
      break;
    case Phase::end:
      end(fault, now);
      break;
  }
  if (fault.kind == FaultKind::supply && action.phase != Phase::ramp) {
    change_supply(fault, action.phase == Phase::begin ? fault.amount : nominal_supply_mv, time_us, now);
  }
  const std::uint64_t again_us = time_us + fault.repeat_us;
  const bool lasts = !fault.duration_us || again_us < fault.start_us + *fault.duration_us;
  if (fault.repeat_us != 0 && action.phase != Phase::end && lasts) {
    actions_.insert({again_us, {&fault, Phase::repeat}});
  }
}

void FaultPlayer::begin(const Fault& fault, BusTime now) {
  switch (fault.kind) {
    case FaultKind::unplug:
      stage_.bus.controller(stage_.rack.controller(*fault.joint)).unplug();
      break;
    case FaultKind::reset:
      module_of(fault).power_on(now);
      break;
    case FaultKind::crystal:
      module_of(fault).set_crystal(now, false);
      break;
    case FaultKind::pll:
      module_of(fault).set_pll(now, false);
      break;
    case FaultKind::adc:
      module_of(fault).set_adc(now, false);
      break;
    case FaultKind::touch:
      stage_.state.set_touch(*fault.joint, fault.touch);
      break;
    case FaultKind::jam:
      stage_.plant.jam(*fault.joint, fault.amount);
      break;
    case FaultKind::babble:
      if (!babbler_) {
        babbler_ = std::make_unique<Babbler>(stage_.bus);
      }
      babbler_->begin(fault.frame.identifier);
      break;
    case FaultKind::dominant:
      stage_.bus.hold_dominant(true);
      break;
    case FaultKind::corrupt:
      stage_.state.set_corruption(fault.amount);
      break;
    case FaultKind::lose:
      stage_.state.set_loss(*fault.joint, fault.amount);
      break;
    case FaultKind::delay:
      stage_.state.set_delay(*fault.joint, BusTime{fault.amount} * 1'000);
      break;
    case FaultKind::send:
      if (!foreign_node_) {
        foreign_node_ = std::make_unique<Injector>(stage_.bus, std::span<const InjectedFrame>());
      }
      foreign_node_->send_now(fault.frame);
      break;
    case FaultKind::master:
      masters_.push_back(std::make_unique<HostNode>(stage_.bus, stage_.scenario, stage_.sync_producer));
      masters_.back()->start(now);
      break;
    case FaultKind::host_stall:
      stage_.host.stall();
      break;
    case FaultKind::host_dies:
      stage_.host.die();
      break;
    case FaultKind::supply:
      break;  // change_supply()
  }
}

void FaultPlayer::end(const Fault& fault, BusTime now) {
  switch (fault.kind) {
    case FaultKind::unplug:
      stage_.bus.controller(stage_.rack.controller(*fault.joint)).plug_in();
      break;
    case FaultKind::crystal:
      module_of(fault).set_crystal(now, true);
      break;
    case FaultKind::pll:
      module_of(fault).set_pll(now, true);
      break;
    case FaultKind::adc:
      module_of(fault).set_adc(now, true);
      break;
    case FaultKind::touch:
      stage_.state.set_touch(*fault.joint, TouchFault::none);
      break;
    case FaultKind::jam:
      stage_.plant.free(*fault.joint);
      break;
    case FaultKind::babble:
      babbler_->end();
      break;
    case FaultKind::dominant:
      stage_.bus.hold_dominant(false);
      break;
    case FaultKind::corrupt:
      stage_.state.set_corruption(0);
      break;
    case FaultKind::lose:
      stage_.state.set_loss(*fault.joint, 0);
      break;
    case FaultKind::delay:
      stage_.state.set_delay(*fault.joint, 0);
      break;
    case FaultKind::master:
      masters_.back()->die();
      break;
    case FaultKind::host_stall:
      stage_.host.resume(now);
      break;
    case FaultKind::supply:
    case FaultKind::reset:
    case FaultKind::send:
    case FaultKind::host_dies:
      break;
  }
}

/// A supply that is cut, or comes back, changes at once.
void FaultPlayer::change_supply(const Fault& fault, std::uint32_t mv, std::uint64_t time_us, BusTime now) {
  Supply& supply = supplies_[*fault.joint];
  supply.wanted_mv = mv;
  if (mv == 0 || supply.mv == 0) {
    supply.mv = mv;
    module_of(fault).set_supply(now, mv);
  } else if (supply.mv > top_of_ramps_mv && mv < top_of_ramps_mv) {
    supply.mv = top_of_ramps_mv;
  }
  if (!supply.is_ramping) {
    ramp_supply(fault, time_us, now);
  }
}

void FaultPlayer::ramp_supply(const Fault& fault, std::uint64_t time_us, BusTime now) {
  Supply& supply = supplies_[*fault.joint];
  supply.is_ramping = supply.mv != supply.wanted_mv;
  if (!supply.is_ramping) {
    return;
  }
  supply.mv = supply.wanted_mv > supply.mv ? std::min(supply.mv + ramp_step_mv, supply.wanted_mv)
                                           : std::max(supply.mv - ramp_step_mv, supply.wanted_mv);
  module_of(fault).set_supply(now, supply.mv);
  actions_.insert({time_us + ramp_step_us, {&fault, Phase::ramp}});
}

}  // namespace proleg::sim
