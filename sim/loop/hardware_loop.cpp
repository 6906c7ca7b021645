#include "sim/loop/hardware_loop.hpp"

#include <algorithm>
#include <utility>

#include "shared/canopen/bus_load.hpp"
#include "sim/loop/host_node.hpp"
#include "sim/loop/injector.hpp"
#include "sim/loop/internal_values.hpp"
#include "sim/loop/module_making.hpp"
#include "sim/loop/plant_schedule.hpp"
#include "sim/loop/servo_pulses.hpp"
#include "sim/scenario/input_error.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime second = 1'000'000'000;
/// More than a SYNC waits for a frame on the wire, and crystals drift apart in a tick.
constexpr BusTime longest_sync_jitter = 500'000;

}  // namespace

class HardwareLoop::Implementation {
 public:
  Implementation(const Scenario& scenario, HardwareOptions options)
      : scenario_(scenario),
        options_(std::move(options)),
        servo_schedule_(scenario.robot.servo.period_us, scenario.kernel.tick_period_us),
        plant_(scenario),
        chain_(scenario.kernel, scenario.joint_limits, scenario.settings),
        touch_(scenario.robot.joints.size()),
        setpoints_(chain_.setpoints().begin(), chain_.setpoints().end()),
        latched_contacts_(scenario.robot.links.size()) {
    require_room_on_bus();
    chain_.set_losses(options_.losses);
    for_each_internal_value(scenario.kernel, [&](unsigned, unsigned, unsigned) { internal_values_.push_back(0); });
    make_modules();
    host_ = std::make_unique<HostNode>(bus_, scenario, sync_producer);
    injector_ = std::make_unique<Injector>(bus_, options_.injected);
    bus_.set_trace([this](const Transmission& transmission) { on_frame(transmission); });
    if (options_.losses != nullptr && options_.losses->any()) {
      bus_.set_loss_rule([this](const CanFrame& frame, std::size_t receiver) { return is_lost(frame, receiver); });
    }
    bring_up();
  }

  const Change* advance() {
    restart_events_.clear();
    tick_finished_ = false;
    const BusTime patience = bus_.now() + second;
    while (!tick_finished_) {
      run_next_event();
      if (bus_.now() > patience) {
        throw HardwareError("the SYNC of tick " + std::to_string(syncs_) + " stays out for a second");
      }
    }
    return change_;
  }

  [[nodiscard]] TickSample sample() const {
    return {tick_ - 1,    latched_contacts_,       setpoints_,          internal_values_,
            pulses_,      plant_.servo_commands(), plant_.link_poses(), plant_.joint_angles(),
            chain_.lost()};
  }

  const Scenario& scenario_;
  HardwareOptions options_;
  ServoSchedule servo_schedule_;
  Plant plant_;
  std::uint32_t tick_ = 0;  ///< finished ones
  ValueHash setpoint_hash_;
  ValueHash servo_hash_;
  std::uint64_t differences_ = 0;
  std::optional<Difference> first_difference_;
  std::uint64_t lost_frames_ = 0;
  std::uint64_t setup_frames_ = 0;
  std::vector<RestartEvent> restart_events_;
  Bus bus_;

 private:
  static constexpr unsigned no_joint = max_joints;

  void require_room_on_bus() const {
    const std::uint32_t load = canopen::worst_bus_load_permille(scenario_.kernel);
    if (load > canopen::highest_bus_load_permille) {
      throw InputError(
          scenario_.path, 0,
          std::to_string(scenario_.kernel.joint_count) + " modules that with a tick of " +
              std::to_string(scenario_.kernel.tick_period_us) + " us may take " + std::to_string((load + 9) / 10) +
              " % of the bus",
          "at most " + std::to_string(canopen::highest_bus_load_permille / 10) + " %: fewer joints, or a longer tick");
    }
  }

  void make_modules() {
    joint_of_node_.fill(no_joint);
    for (unsigned joint = 0; joint < chain_.joint_count(); ++joint) {
      firmware::Board board = make_board(scenario_, joint);
      if (options_.change_board) {
        options_.change_board(joint, board);
      }
      joint_of_node_[scenario_.modules[joint].node] = joint;
      modules_.push_back(std::make_unique<NativeModule>(
          bus_, board, make_crystal(scenario_, joint, options_.crystal_error_ppm), [this, joint] {
            const std::uint8_t sensors = wired_sensors(plant_.link_contacts(), joint);
            return options_.change_sensors ? options_.change_sensors(joint, sensors) : sensors;
          }));
      if (options_.tamper) {
        modules_.back()->set_tamper(
            [this, joint](const CanFrame& frame, const auto& deliver) { options_.tamper(joint, frame, deliver); });
      }
    }
  }

  void bring_up() {
    for (auto& module : modules_) {
      module->power_on(0);
    }
    host_->start(0);
    // The host gives up by itself; this only bounds a host that does not.
    const BusTime patience = 60 * second;
    while (host_->state() != canopen::MasterState::running) {
      run_next_event();
      report_host_events();
      if (bus_.now() > patience) {
        throw HardwareError("the robot is not set up after a minute on the bus");
      }
    }
    setup_frames_ = bus_.statistics().frames;
  }

  void run_next_event() {
    BusTime next = std::min(bus_.next_event(), host_->next_event());
    for (const auto& module : modules_) {
      next = std::min(next, module->next_event());
    }
    if (next_action_ < actions_.size()) {
      next = std::min(next, sync_time_ + actions_[next_action_].time);
    }
    if (next == never_on_bus) {
      throw HardwareError("nothing more happens on the bus after tick " + std::to_string(tick_));
    }
    while (next_action_ < actions_.size() && sync_time_ + actions_[next_action_].time <= next) {
      act(actions_[next_action_++]);
    }
    bus_.advance_to(next);
    if (tick_ended_) {
      complete_tick();
    }
    for (const auto& module : modules_) {
      if (module->next_event() <= next) {
        module->advance_to(next);
      }
    }
    if (host_->next_event() <= next) {
      host_->advance_to(next);
    }
    report_host_events();
  }

  void report_host_events() {
    while (const auto event = host_->take_event()) {
      if (options_.notice) {
        options_.notice(*event);
      }
    }
    if (const auto problem = host_->take_problem()) {
      if (syncs_ == 0) {
        throw HardwareError(*problem);
      }
      if (options_.notice) {
        options_.notice(*problem);
      }
    }
  }

  /// At the end of a frame, before anybody hears it.
  void on_frame(const Transmission& transmission) {
    if (options_.trace) {
      options_.trace(transmission);
    }
    // Others may send what looks like a SYNC; ticks are what the producer makes.
    if (transmission.sender == modules_[sync_producer]->controller() && canopen::decode_sync(transmission.frame)) {
      if (syncs_ > 0) {
        end_tick();
      }
      begin_tick(transmission.end);
    }
  }

  void begin_tick(BusTime now) {
    sync_time_ = now;
    if (syncs_ == 0) {
      bus_.start_statistics();
    }
    const std::uint32_t tick = syncs_++;
    injector_->advance_to(tick);
    for (; next_restart_ < options_.restarts.size() && options_.restarts[next_restart_].tick <= tick; ++next_restart_) {
      const unsigned joint = options_.restarts[next_restart_].joint;
      // What it still has to give of the tick before, by a slow crystal, it gives.
      modules_[joint]->advance_to(now + longest_sync_jitter);
      last_pulses_[joint] = modules_[joint]->pulse();
      modules_[joint]->power_on(now);
      stopping_.insert(joint);
    }
    schedule_tick(servo_schedule_, plant_, tick, scenario_.robot.servo.period_us, scenario_.kernel.tick_period_us,
                  actions_);
    next_action_ = 0;
  }

  void act(const PlantAction& action) {
    const std::uint64_t tick_start_us = std::uint64_t{tick_} * scenario_.kernel.tick_period_us;
    if (action.kind == PlantAction::Kind::read_servos) {
      for (std::uint32_t joint = 0; joint < modules_.size(); ++joint) {
        // Of a module that has restarted at the SYNC since: what it gave before.
        const bool restarted = tick_ended_ && stopping_.contains(joint);
        readings_.push_back({servo_schedule_.start_us(action.number), joint,
                             restarted ? last_pulses_[joint] : modules_[joint]->pulse()});
      }
    } else {
      take_readings(tick_start_us + plant_.step_start_us(static_cast<std::uint32_t>(action.number)));
      plant_.step();
    }
  }

  void take_readings(std::uint64_t until_us) {
    for (; taken_readings_ < readings_.size() && readings_[taken_readings_].time_us <= until_us; ++taken_readings_) {
      const Reading& reading = readings_[taken_readings_];
      if (reading.pulse) {
        plant_.set_command(reading.joint, *reading.pulse);
      } else {
        plant_.release(reading.joint);
      }
    }
  }

  /// At the next SYNC, before the modules hear it. Only the pulses of intervals that start so late that they are not
  /// read yet are still to come: by its own crystal a module may begin one just after the SYNC before which it belongs.
  void end_tick() {
    late_.clear();
    for (; next_action_ < actions_.size(); ++next_action_) {
      const PlantAction& action = actions_[next_action_];
      if (action.kind == PlantAction::Kind::read_servos) {
        late_.push_back(action);
      } else {
        act(action);
      }
    }
    advance_reference();
    read_modules();
    plant_.finish_tick();
    tick_ended_ = true;
  }

  /// After all have heard the SYNC.
  void complete_tick() {
    for (const PlantAction& action : late_) {
      act(action);
    }
    take_readings((std::uint64_t{tick_} + 1) * scenario_.kernel.tick_period_us);
    read_pulses();
    compare();
    readings_.clear();
    taken_readings_ = 0;
    ++tick_;
    tick_ended_ = false;
    tick_finished_ = true;
  }

  /// The gait in memory makes the same tick, with the sensors as they were at its SYNC.
  void advance_reference() {
    for (unsigned joint = 0; joint < modules_.size(); ++joint) {
      if (stopping_.contains(joint)) {
        chain_.stop(joint);
        touch_.reset(joint);
        restart_events_.push_back({joint, false});
      } else if (!chain_.is_running(joint) && modules_[joint]->has_computed(joint, tick_)) {
        chain_.join(joint);
        restart_events_.push_back({joint, true});
      }
    }
    stopping_ = {};
    change_ = nullptr;
    if (next_change_ < scenario_.changes.size() && scenario_.changes[next_change_].tick == tick_) {
      change_ = &scenario_.changes[next_change_++];
      chain_.apply(*change_);
    }
    for (unsigned joint = 0; joint < modules_.size(); ++joint) {
      if (chain_.is_running(joint)) {
        touch_.sample(plant_.link_contacts(), joint);
      }
    }
    chain_.advance(touch_.contacts());
    lost_frames_ += chain_.lost().size();
  }

  /// What the modules have made of the tick. A module that does not compute keeps its last values.
  void read_modules() {
    for (unsigned joint = 0; joint < modules_.size(); ++joint) {
      if (!modules_[joint]->has_computed(joint, tick_)) {
        latched_contacts_[joint + 1] = 0;
        latched_contacts_[0] = joint == 0 ? std::uint8_t{0} : latched_contacts_[0];
        continue;
      }
      const Kernel& kernel = modules_[joint]->kernel();
      setpoints_[joint] = kernel.setpoint(joint);
      const unsigned flags = kernel.frame(joint, 0).flags();
      latched_contacts_[joint + 1] = flags & StateFrame::rear_link_contact_bits;
      if (joint == 0) {
        latched_contacts_[0] = static_cast<std::uint8_t>((flags & StateFrame::contact_bits) >> 2U);
      }
    }
    auto value = internal_values_.begin();
    for_each_internal_value(scenario_.kernel, [&](unsigned slot, unsigned joint, unsigned number) {
      if (modules_[joint]->has_computed(joint, tick_)) {
        *value = modules_[joint]->kernel().internal_value(slot, joint, number);
      }
      ++value;
    });
    setpoint_hash_.append(setpoints_);
  }

  void read_pulses() {
    pulses_.clear();
    for (const Reading& reading : readings_) {
      if (reading.pulse) {
        pulses_.push_back({reading.time_us, reading.joint, *reading.pulse});
        servo_hash_.append(*reading.pulse);
      }
    }
  }

  void compare() {
    const auto note = [this](const Difference& difference) {
      ++differences_;
      if (!first_difference_) {
        first_difference_ = difference;
      }
    };
    compare_setpoints(tick_, setpoints_, chain_.setpoints(), note);
    expected_pulses_.clear();
    append_servo_pulses(chain_, servo_schedule_, expected_pulses_);
    compare_pulses(tick_, pulses_, expected_pulses_, note);
  }

  bool is_lost(const CanFrame& frame, std::size_t receiver) const {
    const auto state = canopen::decode_state(frame);
    const bool first = frame.identifier > canopen::identifier::state_frame &&
                       frame.identifier <= canopen::identifier::state_frame + canopen::highest_node;
    const bool second_channel = frame.identifier > canopen::identifier::second_state &&
                                frame.identifier <= canopen::identifier::second_state + canopen::highest_node;
    if (!state || (!first && !second_channel)) {
      return false;
    }
    const unsigned node = unsigned{frame.identifier} -
                          unsigned{first ? canopen::identifier::state_frame : canopen::identifier::second_state};
    const unsigned sender = joint_of_node_[node];
    // The frames that follow SYNC k hold state k + 1.
    if (sender == no_joint || receiver >= modules_.size() || state->label() != static_cast<std::uint8_t>(syncs_)) {
      return false;
    }
    return options_.losses->lost({syncs_, static_cast<std::uint8_t>(sender),
                                  static_cast<std::uint8_t>(second_channel ? 1 : 0),
                                  static_cast<std::uint8_t>(receiver)});
  }

  struct Reading {
    std::uint64_t time_us;
    std::uint32_t joint;
    std::optional<std::int32_t> pulse;
  };

  std::vector<std::unique_ptr<NativeModule>> modules_;  ///< by joint; attached first, so also by controller
  std::array<unsigned, canopen::highest_node + 2> joint_of_node_{};
  std::unique_ptr<HostNode> host_;
  std::unique_ptr<Injector> injector_;
  std::uint32_t syncs_ = 0;     ///< heard so far
  BusTime sync_time_ = 0;       ///< of the last one
  bool tick_ended_ = false;     ///< its SYNC is over, its last pulses are not read yet
  bool tick_finished_ = false;  ///< since the last advance()
  std::vector<PlantAction> late_;
  std::size_t next_restart_ = 0;
  JointMask stopping_;                                               ///< modules that restarted at the last SYNC
  std::array<std::optional<std::int32_t>, max_joints> last_pulses_;  ///< of those, before
  std::vector<PlantAction> actions_;
  std::size_t next_action_ = 0;
  std::vector<Reading> readings_;
  std::size_t taken_readings_ = 0;

  KernelChain chain_;
  TouchInputs touch_;
  std::size_t next_change_ = 0;
  const Change* change_ = nullptr;
  std::vector<ServoPulse> expected_pulses_;

  std::vector<std::int32_t> setpoints_;
  std::vector<std::int32_t> internal_values_;
  std::vector<ServoPulse> pulses_;
  std::vector<std::uint8_t> latched_contacts_;
};

HardwareLoop::HardwareLoop(const Scenario& scenario, HardwareOptions options)
    : implementation_(std::make_unique<Implementation>(scenario, std::move(options))) {}
HardwareLoop::~HardwareLoop() = default;

const Change* HardwareLoop::advance() { return implementation_->advance(); }
std::uint32_t HardwareLoop::tick() const { return implementation_->tick_; }
double HardwareLoop::time_s() const {
  return implementation_->tick_ * (implementation_->scenario_.kernel.tick_period_us * 1e-6);
}
const Plant& HardwareLoop::plant() const { return implementation_->plant_; }
TickSample HardwareLoop::sample() { return implementation_->sample(); }
std::span<const HardwareLoop::RestartEvent> HardwareLoop::restart_events() const {
  return implementation_->restart_events_;
}
const ValueHash& HardwareLoop::setpoint_hash() const { return implementation_->setpoint_hash_; }
const ValueHash& HardwareLoop::servo_hash() const { return implementation_->servo_hash_; }
std::uint64_t HardwareLoop::differences() const { return implementation_->differences_; }
const std::optional<Difference>& HardwareLoop::first_difference() const { return implementation_->first_difference_; }
std::uint64_t HardwareLoop::lost_frames() const { return implementation_->lost_frames_; }
BusStatistics HardwareLoop::bus_statistics() const { return implementation_->bus_.statistics(); }
std::uint64_t HardwareLoop::setup_frames() const { return implementation_->setup_frames_; }

}  // namespace proleg::sim
