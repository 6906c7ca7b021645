#include "sim/hardware_loop/hardware_loop.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "shared/canopen/robot_configuration.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/fixed/random.hpp"
#include "sim/hardware_loop/fault_player.hpp"
#include "sim/hardware_loop/hardware_options.hpp"
#include "sim/hardware_loop/hardware_report.hpp"
#include "sim/hardware_loop/host_node.hpp"
#include "sim/hardware_loop/module_rack.hpp"
#include "sim/hardware_loop/plant_ticks.hpp"
#include "sim/hardware_loop/reference_gait.hpp"
#include "sim/hardware_loop/state_frame_monitor.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime second = 1'000'000'000;

/// The scenario; InputError if its frames could fill the bus.
const Scenario& require_room_on_bus(const Scenario& scenario) {
  const std::uint32_t load = canopen::worst_bus_load_permille(scenario.kernel);
  if (load > canopen::max_bus_load_permille) {
    throw InputError(
        scenario.path, 0,
        std::to_string(scenario.kernel.joint_count) + " modules that with a tick of " +
            std::to_string(scenario.kernel.tick_period_us) + " us may take " + std::to_string((load + 9) / 10) +
            " % of the bus",
        "at most " + std::to_string(canopen::max_bus_load_permille / 10) + " %: fewer joints, or a longer tick");
  }
  return scenario;
}

}  // namespace

/// The event loop: advances bus, modules, host and world together and divides their time into ticks.
class HardwareLoop::Implementation {
 public:
  Implementation(const Scenario& scenario, HardwareOptions options)
      : scenario_(require_room_on_bus(scenario)),
        options_(std::move(options)),
        plant_(scenario),
        plant_ticks_(
            scenario, plant_, [this](std::uint32_t joint) { return pulse_of(joint); },
            [this](BusTime now) { rack_.catch_up_before(now); }),
        fault_state_(scenario),
        rack_(bus_, plant_, scenario, with_faulty_sensors()),
        state_frames_(scenario),
        reference_(scenario, options_.losses),
        values_(scenario, rack_, reference_),
        host_(bus_, scenario, sync_producer),
        injector_(bus_, options_.injected),
        watch_(scenario),
        command_latency_({scenario.robot.servo.period_us, scenario.kernel.tick_period_us}, rack_.size()),
        faults_(options_.faults, {scenario, sync_producer, fault_state_, bus_, rack_, plant_, host_}) {
    set_bus_rules();
    if (has_faults()) {
      rack_.watch_pulses(
          [this](unsigned joint, const JointModule::WatchedPulse& pulse) { watch_.note_pulse(joint, pulse); });
    }
    rack_.watch_commands([this](unsigned joint, BusTime time) { command_latency_.note_command(joint, time); });
    if (options_.before_start) {
      options_.before_start();
    }
    bring_up();
  }

  const Change* advance() {
    report_.restart_events.clear();
    tick_finished_ = false;
    const BusTime deadline = bus_.now() + second;
    while (!tick_finished_) {
      run_next_event();
      if (bus_.now() > deadline) {
        rack_.take_problems(tick_, report_);
        throw HardwareError("the SYNC of tick " + std::to_string(syncs_) + " has been missing for a second");
      }
    }
    return change_;
  }

  [[nodiscard]] TickSample sample() const {
    TickSample sample{.tick = tick_ - 1,
                      .latched_contacts = values_.latched_contacts(),
                      .setpoints = values_.setpoints(),
                      .internal_values = values_.internal_values(),
                      .servo_pulses = values_.pulses(),
                      .lost = first_fault_tick_ ? std::span<const Loss>() : reference_.chain().lost(),
                      .readings = reference_.readings()};
    plant_.add_to(sample);
    return sample;
  }

  [[nodiscard]] std::uint32_t tick() const { return tick_; }
  [[nodiscard]] double time_s() const { return tick_ * (scenario_.kernel.tick_period_us * 1e-6); }
  [[nodiscard]] const Plant& plant() const { return plant_; }
  [[nodiscard]] const HardwareReport& report() const { return report_; }
  [[nodiscard]] const MotionWatch& watch() const { return watch_; }
  [[nodiscard]] const Durations& command_latency_ns() const { return command_latency_.nanoseconds(); }
  void finish_watch() { watch_.finish(bus_.now()); }
  [[nodiscard]] std::optional<std::uint32_t> first_fault_tick() const { return first_fault_tick_; }
  [[nodiscard]] std::span<const std::uint32_t> clipped_ticks() const { return reference_.chain().clipped_ticks(); }
  [[nodiscard]] BusStatistics bus_statistics() const { return bus_.statistics(); }

 private:
  [[nodiscard]] bool has_faults() const { return !options_.faults.empty(); }
  [[nodiscard]] bool has_losses() const { return options_.losses != nullptr && options_.losses->any(); }

  /// The options, with touch sensors that fail as the faults say.
  const HardwareOptions& with_faulty_sensors() {
    if (has_faults()) {
      options_.change_sensors = [this, change = options_.change_sensors](unsigned joint, std::uint8_t sensors) {
        return fault_state_.sensors(joint, change ? change(joint, sensors) : sensors);
      };
    }
    return options_;
  }

  void set_bus_rules() {
    bus_.set_frame_listener([this](const Transmission& transmission) { on_frame(transmission); });
    if (has_losses() || has_faults()) {
      bus_.set_loss_rule([this](const CanFrame& frame, std::size_t receiver) {
        return (has_losses() && state_frames_.is_lost(*options_.losses, frame, receiver)) ||
               fault_state_.loses(frame, receiver);
      });
    }
    if (options_.bit_errors.threshold != 0 || has_faults()) {
      bus_.set_error_rule([this](const CanFrame& frame, std::uint64_t transmission) {
        const HardwareOptions::BitErrors& errors = options_.bit_errors;
        return Pcg32(errors.seed, transmission).next() < errors.threshold || fault_state_.destroys(frame);
      });
    }
    if (has_faults()) {
      bus_.set_delay_rule(
          [this](const CanFrame& /*frame*/, std::size_t receiver) { return fault_state_.delay(receiver); });
    }
  }

  void bring_up() {
    rack_.power_on(0);
    host_.start(0);
    // The host gives up by itself. This deadline bounds a host that has a fault.
    const BusTime deadline = 60 * second;
    while (host_.state() != canopen::MasterState::running) {
      run_next_event();
      rack_.take_problems(tick_, report_);
      if (bus_.now() > deadline) {
        throw HardwareError("the robot is not set up after a minute on the bus");
      }
    }
    report_.setup_frames = bus_.statistics().frames;
  }

  void run_next_event() {
    const BusTime next = std::max(std::min({bus_.next_event(), host_.next_event(), plant_ticks_.next_event(),
                                            rack_.next_event(), faults_.next_event(), tick_deadline()}),
                                  bus_.now());
    if (next == never_on_bus) {
      throw HardwareError("nothing more happens on the bus after tick " + std::to_string(tick_));
    }
    plant_ticks_.advance_to(next);
    bus_.advance_to(next);
    if (plant_ticks_.is_complete(next)) {
      complete_tick();
    }
    if (tick_deadline() <= next) {
      end_tick_without_sync(next);
    }
    faults_.advance_to(next);
    advance_rack(next);
    if (host_.next_event() <= next) {
      host_.advance_to(next);
    }
    report_host();
  }

  void advance_rack(BusTime now) {
    const BusTime quiet_until = std::min(bus_.earliest_delivery(), faults_.next_event());
    const BusTime ahead_until =
        bus_.is_watched() ? now
                          : std::min({quiet_until, host_.next_event(), plant_ticks_.next_event(), tick_deadline()});
    rack_.advance_to(now, quiet_until, ahead_until);
  }

  void report_host() {
    while (const auto event = host_.take_event()) {
      notify(*event);
    }
    if (const auto problem = host_.take_problem()) {
      if (syncs_ == 0) {
        rack_.take_problems(tick_, report_);
        throw HardwareError(*problem);
      }
      notify(*problem);
    }
  }

  void notify(const std::string& text) {
    if (options_.notice) {
      options_.notice(text);
    }
  }

  /// Records a frame at its end, before any node receives it.
  void on_frame(const Transmission& transmission) {
    if (options_.on_frame) {
      options_.on_frame(transmission);
    }
    state_frames_.note(transmission);
    if (has_faults()) {
      watch_.note_frame(transmission);
    }
    // Another node may send what looks like a SYNC. Only the producer's makes a tick.
    if (transmission.sender == rack_.controller(sync_producer) && canopen::decode_sync(transmission.frame)) {
      take_sync(transmission.end);
    }
  }

  void take_sync(BusTime now) {
    if (has_missed_sync_ && now < tick_begin_ + tick_period() / 2) {
      // It comes late, for the tick that has begun without it.
      tick_begin_ = now;
      return;
    }
    has_missed_sync_ = false;
    if (syncs_ > 0) {
      end_tick(now);
    }
    begin_tick(now);
  }

  [[nodiscard]] BusTime tick_period() const { return BusTime{scenario_.kernel.tick_period_us} * 1'000; }

  /// When a tick ends although its SYNC has not come: only after a fault.
  [[nodiscard]] BusTime tick_deadline() const {
    const bool is_bounded = faults_.has_begun() && syncs_ > 0 && !plant_ticks_.has_ended();
    return is_bounded ? tick_begin_ + tick_period() + tick_period() / 4 : never_on_bus;
  }

  /// The tick that follows begins a period after the last one, so that the world keeps the time of the bus.
  void end_tick_without_sync(BusTime now) {
    has_missed_sync_ = true;
    end_tick(now);
    begin_tick(tick_begin_ + tick_period());
  }

  void begin_tick(BusTime now) {
    if (syncs_ == 0) {
      bus_.start_statistics();
      watch_.start(now);
    }
    tick_begin_ = now;
    faults_.begin_tick(syncs_, now);
    const std::uint32_t tick = syncs_++;
    state_frames_.begin_tick(tick);
    injector_.advance_to(tick);
    command_latency_.begin_tick(tick, now);
    if (has_missed_sync_) {
      rack_.begin_tick_without_sync(tick, now);
    } else {
      rack_.begin_tick(tick, now);
    }
    plant_ticks_.begin(tick, now);
  }

  /// The pulse that the servo of a joint gets. After the SYNC the servos still take late pulses of the tick before.
  [[nodiscard]] std::optional<std::int32_t> pulse_of(std::uint32_t joint) const {
    return plant_ticks_.has_ended() ? rack_.pulse_before_restart(joint) : rack_.pulse(joint);
  }

  /// Ends a tick at the next SYNC, before the modules receive it.
  void end_tick(BusTime now) {
    rack_.end_tick();
    if (has_faults()) {
      for (unsigned joint = 0; joint < rack_.size(); ++joint) {
        watch_.note_tick(joint, now,
                         {rack_.has_computed_anew(joint), rack_.pulse(joint).has_value(), rack_.module(joint).power()});
      }
    }
    if (faults_.has_begun()) {
      first_fault_tick_ = first_fault_tick_.value_or(tick_);
      change_ = nullptr;
      values_.read_whatever();
    } else {
      follow_reference();
    }
    report_.setpoint_hash.append(values_.setpoints());
    plant_ticks_.end(now, values_.setpoints());
    report_.world_hash.append(plant_);
  }

  void follow_reference() {
    for (unsigned joint = 0; joint < rack_.size(); ++joint) {
      reference_.follow(joint,
                        {rack_.has_computed(joint, tick_), state_frames_.has_sent(joint), rack_.has_restarted(joint)},
                        report_);
      if (rack_.has_computed(joint, tick_)) {
        reference_.set_current(joint, rack_.record(joint).current_ma);
      }
    }
    advance_reference();
    report_.lost_frames += reference_.chain().lost().size();
    report_.receptions += reference_.chain().receptions();
    values_.read(tick_);
  }

  void advance_reference() {
    const std::optional<std::size_t> due = reference_.due_change();
    const bool is_made = due && host_.has_made_change(*due);
    if (due && !is_made) {
      report_.dropped_changes.push_back(tick_);
    }
    change_ = reference_.advance(plant_.link_contacts(), is_made);
  }

  /// When all modules have received the SYNC and given their last pulses.
  void complete_tick() {
    plant_ticks_.complete();
    values_.read_pulses(plant_ticks_.readings());
    for (const ServoPulse& pulse : values_.pulses()) {
      report_.servo_hash.append(pulse.command);
    }
    if (!first_fault_tick_) {
      compare_with_reference();
    }
    rack_.take_problems(tick_, report_);
    ++tick_;
    tick_finished_ = true;
  }

  void compare_with_reference() {
    reference_.compare(values_.setpoints(), values_.pulses(), report_);
    for (const PlantTicks::Reading& late : plant_ticks_.late_readings()) {
      if (!reference_.has_failed(late.joint)) {
        report_.add({Difference::Kind::late_servo_command, tick_, late.joint, late.pulse, std::nullopt});
      }
    }
  }

  const Scenario& scenario_;
  HardwareOptions options_;
  HardwareReport report_;
  Plant plant_;
  PlantTicks plant_ticks_;
  Bus bus_;
  FaultState fault_state_;
  ModuleRack rack_;  ///< the first to attach to the bus
  StateFrameMonitor state_frames_;
  ReferenceGait reference_;
  ModuleValues values_;
  HostNode host_;
  Injector injector_;
  MotionWatch watch_;
  CommandLatency command_latency_;
  FaultPlayer faults_;
  std::uint32_t syncs_ = 0;       ///< number of ticks that have begun
  BusTime tick_begin_ = 0;        ///< time at which the last tick began
  bool has_missed_sync_ = false;  ///< the last tick began without a SYNC
  std::optional<std::uint32_t> first_fault_tick_;
  std::uint32_t tick_ = 0;          ///< number of finished ticks
  bool tick_finished_ = false;      ///< since the last advance()
  const Change* change_ = nullptr;  ///< of the last tick
};

HardwareLoop::HardwareLoop(const Scenario& scenario, HardwareOptions options)
    : implementation_(std::make_unique<Implementation>(scenario, std::move(options))) {}
HardwareLoop::~HardwareLoop() = default;

const Change* HardwareLoop::advance() { return implementation_->advance(); }
std::uint32_t HardwareLoop::tick() const { return implementation_->tick(); }
double HardwareLoop::time_s() const { return implementation_->time_s(); }
const Plant& HardwareLoop::plant() const { return implementation_->plant(); }
TickSample HardwareLoop::sample() { return implementation_->sample(); }
std::span<const RestartEvent> HardwareLoop::restart_events() const { return implementation_->report().restart_events; }
std::span<const ModuleFailure> HardwareLoop::failures() const { return implementation_->report().failures; }
std::span<const ModuleProblem> HardwareLoop::problems() const { return implementation_->report().problems; }
std::span<const std::uint32_t> HardwareLoop::clipped_ticks() const { return implementation_->clipped_ticks(); }
std::span<const std::uint32_t> HardwareLoop::dropped_changes() const {
  return implementation_->report().dropped_changes;
}
const MotionWatch& HardwareLoop::motion_watch() const { return implementation_->watch(); }
const Durations& HardwareLoop::command_latency_ns() const { return implementation_->command_latency_ns(); }
void HardwareLoop::finish_watch() { implementation_->finish_watch(); }
std::optional<std::uint32_t> HardwareLoop::first_fault_tick() const { return implementation_->first_fault_tick(); }
const ValueHash& HardwareLoop::setpoint_hash() const { return implementation_->report().setpoint_hash; }
const ValueHash& HardwareLoop::servo_hash() const { return implementation_->report().servo_hash; }
std::optional<std::string> HardwareLoop::world_hash() const { return implementation_->report().world_hash.hex(); }
std::string HardwareLoop::motion_hash() const { return implementation_->report().world_hash.motion_hex(); }
std::uint64_t HardwareLoop::differences() const { return implementation_->report().differences; }
std::uint64_t HardwareLoop::differences(unsigned joint) const {
  return implementation_->report().differences_of[joint];
}
const std::optional<Difference>& HardwareLoop::first_difference() const {
  return implementation_->report().first_difference;
}
std::uint64_t HardwareLoop::lost_frames() const { return implementation_->report().lost_frames; }
std::uint64_t HardwareLoop::receptions() const { return implementation_->report().receptions; }
BusStatistics HardwareLoop::bus_statistics() const { return implementation_->bus_statistics(); }
std::uint64_t HardwareLoop::setup_frames() const { return implementation_->report().setup_frames; }

}  // namespace proleg::sim
