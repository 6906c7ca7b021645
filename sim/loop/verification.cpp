#include "sim/loop/verification.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "sim/loop/gait.hpp"
#include "sim/loop/module_readings.hpp"
#include "sim/record/recorded_run.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint64_t max_servo_period_us = 1'000'000;

/// The inputs of a recorded gait, with names resolved.
class RecordedGait {
 public:
  explicit RecordedGait(const Recording& recording) : recording_(recording) {
    configuration.joint_count = static_cast<std::uint8_t>(recording.joints().size());
    configuration.tick_period_us = recording.tick_period_us();
    configuration.seed = whole_number("seed");
    servo_period_us = static_cast<std::uint32_t>(whole_number("servo_period_us"));
    command_speed = static_cast<std::uint32_t>(whole_number("command_speed_deg_per_s"));
    if (whole_number("command_speed_deg_per_s") < min_command_speed ||
        whole_number("command_speed_deg_per_s") > max_command_speed) {
      refuse("a command speed of " + std::to_string(whole_number("command_speed_deg_per_s")) + " degrees a second",
             "90 to 10000 degrees a second");
    }
    if (whole_number("servo_period_us") < 1 || whole_number("servo_period_us") > max_servo_period_us) {
      refuse("a servo period of " + std::to_string(whole_number("servo_period_us")) + " us", "1 to 1000000 us");
    }
    for (const RecordedJoint& joint : recording.joints()) {
      limits.push_back({joint.lower_limit, joint.upper_limit});
    }
    read_slots();
    check_internal_values();
    for (const RecordedSetting& setting : recording.parameters()) {
      if (setting.commit) {
        add_change(setting, false);
      } else {
        settings.push_back(resolve(setting, false));
      }
    }
    for (const RecordedSetting& setting : recording.distortions()) {
      add_change(setting, true);
    }
  }

  KernelConfiguration configuration;
  std::uint32_t servo_period_us = 0;
  std::uint32_t command_speed = 0;
  std::vector<AngleLimits> limits;
  std::vector<Setting> settings;
  std::vector<Change> changes;  ///< by ascending tick

  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const {
    throw InputError(recording_.path().string(), 0, found, expected);
  }

 private:
  [[nodiscard]] std::uint64_t whole_number(const std::string& key) const {
    const std::string text = recording_.run_value(key);
    const auto value = parse_whole<std::uint64_t>(text);
    if (!value) {
      refuse(in_quotes(text) + " as " + key, "a whole number");
    }
    return *value;
  }

  void read_slots() {
    for (const RecordedSlot& slot : recording_.slots()) {
      Slot& kernel_slot = configuration.slots[slot.slot];
      kernel_slot.algorithm = find_algorithm(slot.algorithm);
      if (kernel_slot.algorithm == nullptr) {
        refuse("algorithm " + in_quotes(slot.algorithm),
               "an algorithm that this program has ('proleg algorithms' lists them)");
      }
      for (unsigned joint = 0; joint < slot.joint_group.size(); ++joint) {
        if (slot.joint_group[joint]) {
          kernel_slot.group.insert(joint);
        }
      }
    }
  }

  /// The recording must have the values that recompute() compares.
  void check_internal_values() const {
    const std::vector<RecordedInternalValue>& recorded = recording_.internal_values();
    std::size_t count = 0;
    for_each_internal_value(configuration, [&](unsigned slot, unsigned joint, unsigned number) {
      const std::string_view name = configuration.slots[slot].algorithm->declaration().internal_values[number].name;
      if (count < recorded.size()) {
        const RecordedInternalValue& value = recorded[count];
        if (value.slot != slot || value.joint != joint || value.number != number || value.name != name) {
          refuse_internal_value(in_quotes(value.name), slot, joint, in_quotes(name));
        }
      } else {
        refuse_internal_value("nothing", slot, joint, in_quotes(name));
      }
      ++count;
    });
    if (count < recorded.size()) {
      refuse_internal_value(in_quotes(recorded[count].name), recorded[count].slot, recorded[count].joint, "nothing");
    }
  }

  [[noreturn]] void refuse_internal_value(const std::string& found, std::uint32_t slot, std::uint32_t joint,
                                          const std::string& expected) const {
    refuse(found + " as an internal value of joint " + std::to_string(joint) + " in slot " + std::to_string(slot),
           expected + ", as this program's algorithm declares");
  }

  [[nodiscard]] Setting resolve(const RecordedSetting& setting, bool internal) const {
    const ActuationModule* algorithm = setting.slot < max_slots ? configuration.slots[setting.slot].algorithm : nullptr;
    const int index = algorithm == nullptr ? -1
                                           : (internal ? find_internal_value(algorithm->declaration(), setting.name)
                                                       : find_parameter(algorithm->declaration(), setting.name));
    if (index < 0 || setting.joint >= configuration.joint_count ||
        !configuration.slots[setting.slot].group.contains(setting.joint)) {
      refuse("a value for " + in_quotes(setting.name) + " of joint " + std::to_string(setting.joint) + " in slot " +
                 std::to_string(setting.slot),
             "names that the recorded algorithms have");
    }
    return {static_cast<std::uint8_t>(setting.slot), static_cast<std::uint8_t>(setting.joint),
            static_cast<std::uint8_t>(index), internal, setting.raw};
  }

  void add_change(const RecordedSetting& setting, bool internal) {
    const auto change = std::ranges::lower_bound(changes, setting.tick, {}, &Change::tick);
    if (change != changes.end() && change->tick == setting.tick) {
      change->settings.push_back(resolve(setting, internal));
    } else {
      changes.insert(change, Change{setting.tick, {resolve(setting, internal)}});
    }
  }

  const Recording& recording_;
};

/// The recorded pulses, tick by tick.
class PulsesByTick {
 public:
  explicit PulsesByTick(const Recording& recording) : reader_(recording), next_(reader_.next()) {}

  /// The pulses before this time that no earlier call has returned; valid until the next call.
  [[nodiscard]] std::span<const ServoPulse> take_before(std::uint64_t end_us) {
    taken_.clear();
    for (; next_ && next_->time_us < end_us; next_ = reader_.next()) {
      taken_.push_back(*next_);
    }
    return taken_;
  }
  /// One that take_before() has not returned.
  [[nodiscard]] std::optional<ServoPulse> take() {
    const std::optional<ServoPulse> taken = next_;
    if (taken) {
      next_ = reader_.next();
    }
    return taken;
  }

 private:
  ServoPulseReader reader_;
  std::optional<ServoPulse> next_;
  std::vector<ServoPulse> taken_;
};

/// The recorded losses, tick by tick.
class LossesByTick {
 public:
  explicit LossesByTick(const Recording& recording) : reader_(recording), next_(reader_.next()) {}

  /// The losses of the tick that take() had last. The address is the same in all ticks.
  [[nodiscard]] const Losses& taken() const { return taken_; }
  /// Ticks must ascend.
  void take(std::uint32_t tick) {
    if (taken_.any()) {
      taken_ = Losses();
    }
    std::vector<Loss> list;
    for (; next_ && next_->tick <= tick; next_ = reader_.next()) {
      list.push_back(*next_);
    }
    if (!list.empty()) {
      taken_ = Losses(std::move(list));
    }
  }

 private:
  LossReader reader_;
  std::optional<Loss> next_;
  Losses taken_;
};

Verification recompute(const Recording& recording, const RecordedGait& recorded,
                       const std::function<void(std::uint32_t tick)>& progress, MotionCheck* motion) {
  LossesByTick losses(recording);
  const std::vector<RecordedRestart> restarts = recording.restarts();
  PulsesByTick pulses(recording);

  Gait gait({.kernel = recorded.configuration,
             .limits = recorded.limits,
             .settings = recorded.settings,
             .changes = recorded.changes,
             .servo_period_us = recorded.servo_period_us,
             .command_speed = recorded.command_speed});
  KernelChain& chain = gait.chain();
  chain.set_losses(&losses.taken());
  Verification result;
  const auto note = [&result](const Difference& difference) {
    ++result.differences;
    if (!result.first) {
      result.first = difference;
    }
  };
  ValueHash setpoint_hash;
  ValueHash servo_hash;
  std::vector<std::uint8_t> contacts(chain.joint_count());
  std::vector<std::int32_t> last_commands(chain.joint_count(), servo_center);
  auto restart = restarts.begin();
  const std::optional<std::uint32_t> first_fault = recording.first_fault_tick();
  if (first_fault == 0U) {
    result.first_fault_tick = first_fault;
    return result;
  }
  const std::uint32_t last = std::min(recording.last_tick(), first_fault ? *first_fault - 1 : recording.last_tick());
  recording.read_ticks(0, last, [&](const RecordedTick& tick) {
    for (; restart != restarts.end() && restart->tick <= tick.tick; ++restart) {
      restart->joined ? chain.join(restart->joint) : chain.stop(restart->joint);
    }
    gait.apply_due_changes();
    for (std::size_t joint = 0; joint < contacts.size(); ++joint) {
      contacts[joint] = joint_contacts(tick.latched_contacts, joint);
    }
    for (unsigned joint = 0; joint < chain.joint_count(); ++joint) {
      chain.set_readings(joint, tick.readings[joint]);
    }
    losses.take(tick.tick);
    gait.advance(contacts);
    setpoint_hash.append(chain.setpoints());
    compare_setpoints(tick.tick, tick.setpoints, chain.setpoints(), note);
    result.setpoints += contacts.size();
    auto value = tick.internal_values.begin();
    for_each_internal_value(recorded.configuration, [&](unsigned slot, unsigned joint, unsigned number) {
      const std::int32_t expected = chain.kernel(joint).internal_value(slot, joint, number);
      if (*value != expected) {
        note({Difference::Kind::internal_value, tick.tick, joint, *value, expected});
      }
      ++value;
      ++result.internal_values;
    });

    for (const ServoPulse& expected : gait.pulses()) {
      servo_hash.append(expected.command);
      last_commands[expected.joint] = expected.command;
    }
    for (std::uint32_t joint = 0; joint < contacts.size(); ++joint) {
      if (tick.servo_commands[joint] != last_commands[joint]) {
        note(
            {Difference::Kind::last_servo_command, tick.tick, joint, tick.servo_commands[joint], last_commands[joint]});
      }
    }
    const std::uint64_t end_us = (tick.tick + std::uint64_t{1}) * recorded.configuration.tick_period_us;
    const std::span<const ServoPulse> taken = pulses.take_before(end_us);
    compare_pulses(tick.tick, taken, gait.pulses(), note);
    if (motion != nullptr) {
      motion->check(tick, taken);
    }
    result.servo_commands += gait.pulses().size();
    ++result.ticks;
    if (progress) {
      progress(tick.tick);
    }
  });
  result.first_fault_tick = first_fault;
  while (const auto pulse = first_fault ? std::nullopt : pulses.take()) {
    note({Difference::Kind::servo_command, recording.last_tick(), pulse->joint, pulse->command, std::nullopt});
  }
  result.setpoint_hash = setpoint_hash.hex();
  result.servo_hash = servo_hash.hex();
  return result;
}

}  // namespace

Verification verify(const Recording& recording, const std::function<void(std::uint32_t tick)>& progress,
                    MotionCheck* motion) {
  const RecordedGait gait(recording);
  if (recording.first_tick() != 0) {
    gait.refuse("tick " + std::to_string(recording.first_tick()) + " as the first one", "a recording from tick 0 on");
  }
  try {
    return recompute(recording, gait, progress, motion);
  } catch (const KernelRefusal& refusal) {
    gait.refuse(std::string("values that the kernel refuses: ") + refusal.what(), "a recording of this version");
  }
}

}  // namespace proleg::sim
