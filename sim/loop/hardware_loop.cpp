#include "sim/loop/hardware_loop.hpp"

#include <algorithm>
#include <utility>

#include "shared/canopen/bus_load.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/fixed/random.hpp"
#include "sim/loop/host_node.hpp"
#include "sim/loop/injector.hpp"
#include "sim/loop/internal_values.hpp"
#include "sim/loop/module_making.hpp"
#include "sim/loop/native_module.hpp"
#include "sim/loop/plant_ticks.hpp"
#include "sim/loop/servo_pulses.hpp"

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
        plant_ticks_(scenario, plant_, [this](std::uint32_t joint) { return pulse_of(joint); }),
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
    if (options_.bit_errors.threshold != 0) {
      bus_.set_error_rule([errors = options_.bit_errors](const CanFrame& /*frame*/, std::uint64_t transmission) {
        return Pcg32(errors.seed, transmission).next() < errors.threshold;
      });
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
        report_problems();
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
  PlantTicks plant_ticks_;
  std::uint32_t tick_ = 0;  ///< finished ones
  ValueHash setpoint_hash_;
  ValueHash servo_hash_;
  std::uint64_t differences_ = 0;
  std::array<std::uint64_t, max_joints> differences_of_{};
  std::optional<Difference> first_difference_;
  std::uint64_t lost_frames_ = 0;
  std::uint64_t setup_frames_ = 0;
  std::vector<RestartEvent> restart_events_;
  std::vector<Failure> failures_;
  std::vector<Problem> problems_;
  Bus bus_;

 private:
  static constexpr unsigned no_joint = max_joints;

  void require_room_on_bus() const {
    const std::uint32_t load = canopen::worst_bus_load_permille(scenario_.kernel);
    if (load > canopen::max_bus_load_permille) {
      throw InputError(
          scenario_.path, 0,
          std::to_string(scenario_.kernel.joint_count) + " modules that with a tick of " +
              std::to_string(scenario_.kernel.tick_period_us) + " us may take " + std::to_string((load + 9) / 10) +
              " % of the bus",
          "at most " + std::to_string(canopen::max_bus_load_permille / 10) + " %: fewer joints, or a longer tick");
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
      const ModuleParts parts{bus_,
                              joint,
                              board,
                              make_crystal(scenario_, joint, options_.crystal_error_ppm),
                              [this, joint] { return sensors_of(joint); },
                              [this, joint] { return plant_.servo_readings(joint); }};
      std::unique_ptr<JointModule> module = options_.make_module ? options_.make_module(parts) : nullptr;
      modules_.push_back(module ? std::move(module) : make_native(parts));
    }
    records_.resize(modules_.size());
    failed_.resize(modules_.size());
  }

  std::unique_ptr<JointModule> make_native(const ModuleParts& parts) {
    auto module = std::make_unique<NativeModule>(parts.bus, parts.board, parts.crystal, parts.sensors, parts.readings);
    if (options_.tamper) {
      module->set_tamper([this, joint = parts.joint](const CanFrame& frame, const auto& deliver) {
        options_.tamper(joint, frame, deliver);
      });
    }
    return module;
  }

  [[nodiscard]] std::uint8_t sensors_of(unsigned joint) const {
    const std::uint8_t sensors = wired_sensors(plant_.link_contacts(), joint);
    return options_.change_sensors ? options_.change_sensors(joint, sensors) : sensors;
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
      report_events();
      report_problems();
      if (bus_.now() > patience) {
        throw HardwareError("the robot is not set up after a minute on the bus");
      }
    }
    setup_frames_ = bus_.statistics().frames;
  }

  void run_next_event() {
    BusTime next = std::min({bus_.next_event(), host_->next_event(), plant_ticks_.next_event()});
    for (const auto& module : modules_) {
      next = std::min(next, module->next_event());
    }
    if (next == never_on_bus) {
      throw HardwareError("nothing more happens on the bus after tick " + std::to_string(tick_));
    }
    plant_ticks_.advance_to(next);
    bus_.advance_to(next);
    if (plant_ticks_.is_complete(next)) {
      complete_tick();
    }
    const BusTime quiet_until = bus_.earliest_delivery();
    for (const auto& module : modules_) {
      if (module->next_event() <= next) {
        module->advance_to(next, quiet_until);
      }
    }
    if (host_->next_event() <= next) {
      host_->advance_to(next);
    }
    report_events();
  }

  void report_problems() {
    for (unsigned joint = 0; joint < modules_.size(); ++joint) {
      while (const auto problem = modules_[joint]->take_problem()) {
        problems_.push_back({tick_, joint, *problem});
        if (options_.notice) {
          options_.notice(scenario_.robot.joints[joint].name + " (node " +
                          std::to_string(scenario_.modules[joint].node) + "): " + *problem);
        }
      }
    }
  }

  void report_events() {
    while (const auto event = host_->take_event()) {
      if (options_.notice) {
        options_.notice(*event);
      }
    }
    if (const auto problem = host_->take_problem()) {
      if (syncs_ == 0) {
        report_problems();
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
    note_state_frame(transmission);
    // Others may send what looks like a SYNC; ticks are what the producer makes.
    if (transmission.sender == modules_[sync_producer]->controller() && canopen::decode_sync(transmission.frame)) {
      if (syncs_ > 0) {
        end_tick(transmission.end);
      }
      begin_tick(transmission.end);
    }
  }

  /// Whose state frames for the coming tick are out.
  void note_state_frame(const Transmission& transmission) {
    const auto state = canopen::decode_state(transmission.frame);
    if (state && transmission.sender < modules_.size() && syncs_ > 0 &&
        transmission.frame.identifier ==
            canopen::identifier::state_frame + scenario_.modules[transmission.sender].node &&
        state->label() == static_cast<std::uint8_t>(syncs_)) {
      sent_.insert(static_cast<unsigned>(transmission.sender));
    }
  }

  void begin_tick(BusTime now) {
    sent_ = {};
    if (syncs_ == 0) {
      bus_.start_statistics();
    }
    const std::uint32_t tick = syncs_++;
    injector_->advance_to(tick);
    for (; next_restart_ < options_.restarts.size() && options_.restarts[next_restart_].tick <= tick; ++next_restart_) {
      const unsigned joint = options_.restarts[next_restart_].joint;
      // What it still has to give of the tick before, by a slow crystal, it gives.
      modules_[joint]->run_out(now, now + longest_sync_jitter);
      last_pulses_[joint] = modules_[joint]->pulse();
      modules_[joint]->power_on(now);
      stopping_.insert(joint);
    }
    for (const auto& module : modules_) {
      module->note_sync(tick);
    }
    plant_ticks_.begin(tick, now);
  }

  /// What the servo of a joint gets; of a module that has restarted at the SYNC since: what it got before.
  [[nodiscard]] std::optional<std::int32_t> pulse_of(std::uint32_t joint) const {
    const bool restarted = plant_ticks_.has_ended() && stopping_.contains(joint);
    return restarted ? last_pulses_[joint] : modules_[joint]->pulse();
  }

  /// At the next SYNC, before the modules hear it.
  void end_tick(BusTime now) {
    for (unsigned joint = 0; joint < modules_.size(); ++joint) {
      records_[joint] = modules_[joint]->last_tick();
    }
    advance_reference();
    read_modules();
    plant_ticks_.end(now);
  }

  /// When all have heard the SYNC and given their last pulses.
  void complete_tick() {
    plant_ticks_.complete();
    read_pulses();
    compare();
    report_problems();
    ++tick_;
    tick_finished_ = true;
  }

  /// The gait in memory makes the same tick, with the sensors as they were at its SYNC.
  void advance_reference() {
    for (unsigned joint = 0; joint < modules_.size(); ++joint) {
      const bool computed = has_computed(records_[joint], joint, tick_);
      if (chain_.is_running(joint)) {
        if (stopping_.contains(joint) || is_gone(joint)) {
          stop_reference(joint);
        } else if (!computed) {
          fail(joint);
          if (!sent_.contains(joint)) {
            stop_reference(joint);
          }
        }
      } else if (computed || sent_.contains(joint)) {
        failed_[joint] = false;
        chain_.join(joint);
        restart_events_.push_back({joint, true});
        if (!computed) {
          fail(joint);
        }
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

  /// The run had not stopped it.
  void fail(unsigned joint) {
    failed_[joint] = true;
    failures_.push_back({tick_, joint});
    note({Difference::Kind::missed_tick, tick_, joint, std::nullopt, std::nullopt});
  }

  void stop_reference(unsigned joint) {
    chain_.stop(joint);
    touch_.reset(joint);
    restart_events_.push_back({joint, false});
  }

  /// A module that has computed the tick and sent its state, and failed since: nobody can ask it any more.
  [[nodiscard]] bool is_gone(unsigned joint) const { return failed_[joint] && chain_.is_running(joint); }

  void latch_contacts(unsigned joint, unsigned flags) {
    latched_contacts_[joint + 1] = flags & StateFrame::rear_link_contact_bits;
    if (joint == 0) {
      latched_contacts_[0] = static_cast<std::uint8_t>((flags & StateFrame::contact_bits) >> 2U);
    }
  }

  /// What the modules have made of the tick. A module that does not compute keeps its last values.
  void read_modules() {
    std::array<std::size_t, max_joints> value_of{};  // of each joint's record, the next to be read
    for (unsigned joint = 0; joint < modules_.size(); ++joint) {
      const firmware::TickRecord& record = records_[joint];
      if (is_gone(joint)) {
        setpoints_[joint] = chain_.setpoints()[joint];
        latch_contacts(joint, touch_.contacts()[joint]);
        continue;
      }
      if (!has_computed(record, joint, tick_)) {
        latched_contacts_[joint + 1] = 0;
        latched_contacts_[0] = joint == 0 ? std::uint8_t{0} : latched_contacts_[0];
        continue;
      }
      setpoints_[joint] = record.setpoint;
      latch_contacts(joint, record.flags);
    }
    auto value = internal_values_.begin();
    for_each_internal_value(scenario_.kernel, [&](unsigned slot, unsigned joint, unsigned number) {
      const firmware::TickRecord& record = records_[joint];
      if (is_gone(joint)) {
        *value = chain_.kernel(joint).internal_value(slot, joint, number);
      } else if (has_computed(record, joint, tick_) && value_of[joint] < record.value_count) {
        *value = record.internal_values[value_of[joint]++];
      }
      ++value;
    });
    setpoint_hash_.append(setpoints_);
  }

  void read_pulses() {
    pulses_.clear();
    for (const PlantTicks::Reading& reading : plant_ticks_.readings()) {
      // A module that failed may go on with old pulses; the servo takes them, but they are no part of the gait.
      if (reading.pulse && !failed_[reading.joint]) {
        pulses_.push_back({reading.time_us, reading.joint, *reading.pulse});
        servo_hash_.append(*reading.pulse);
      }
    }
  }

  void compare() {
    const auto take_note = [this](const Difference& difference) { note(difference); };
    compare_setpoints(tick_, setpoints_, chain_.setpoints(), take_note);
    expected_pulses_.clear();
    append_servo_pulses(chain_, servo_schedule_, expected_pulses_);
    std::erase_if(expected_pulses_, [this](const ServoPulse& pulse) { return failed_[pulse.joint]; });
    compare_pulses(tick_, pulses_, expected_pulses_, take_note);
  }

  void note(const Difference& difference) {
    ++differences_;
    ++differences_of_[difference.joint];
    if (!first_difference_) {
      first_difference_ = difference;
    }
  }

  bool is_lost(const CanFrame& frame, std::size_t receiver) const {
    const auto state = canopen::decode_state(frame);
    const bool first = frame.identifier > canopen::identifier::state_frame &&
                       frame.identifier <= canopen::identifier::state_frame + canopen::max_node_id;
    const bool second_channel = frame.identifier > canopen::identifier::second_state &&
                                frame.identifier <= canopen::identifier::second_state + canopen::max_node_id;
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

  std::vector<std::unique_ptr<JointModule>> modules_;  ///< by joint; attached first, so also by controller
  std::vector<firmware::TickRecord> records_;          ///< by joint: what the modules had computed at the last SYNC
  std::array<unsigned, canopen::max_node_id + 2> joint_of_node_{};
  std::unique_ptr<HostNode> host_;
  std::unique_ptr<Injector> injector_;
  std::uint32_t syncs_ = 0;     ///< heard so far
  bool tick_finished_ = false;  ///< since the last advance()
  std::size_t next_restart_ = 0;
  std::vector<bool> failed_;  ///< by joint: modules that stopped by themselves and have not joined again
  JointMask sent_;            ///< joints whose state frames came after the last SYNC
  JointMask stopping_;        ///< modules that restarted at the last SYNC
  std::array<std::optional<std::int32_t>, max_joints> last_pulses_;  ///< of those, before

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
std::uint64_t HardwareLoop::differences(unsigned joint) const { return implementation_->differences_of_[joint]; }
const std::optional<Difference>& HardwareLoop::first_difference() const { return implementation_->first_difference_; }
std::span<const HardwareLoop::Failure> HardwareLoop::failures() const { return implementation_->failures_; }
std::span<const HardwareLoop::Problem> HardwareLoop::problems() const { return implementation_->problems_; }
std::uint64_t HardwareLoop::lost_frames() const { return implementation_->lost_frames_; }
BusStatistics HardwareLoop::bus_statistics() const { return implementation_->bus_.statistics(); }
std::uint64_t HardwareLoop::setup_frames() const { return implementation_->setup_frames_; }

}  // namespace proleg::sim
