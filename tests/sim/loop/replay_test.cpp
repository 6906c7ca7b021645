// A recording must be sufficient to repeat the run: everything below the line comes from the file alone.

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "shared/gait/registry.hpp"
#include "shared/kernel/servo_pulses.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/record/recorder.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/identity/sensing_probe.hpp"

namespace proleg::sim {
namespace {

/// The probes make every single contact and reading matter in all later set-points.
const ActuationModule* algorithm_of(const std::string& name) {
  for (const ActuationModule* probe :
       {static_cast<const ActuationModule*>(&identity::sensing_probe()), &identity::reading_probe()}) {
    if (name == probe->declaration().name) {
      return probe;
    }
  }
  return find_algorithm(name);
}

/// Coupled oscillators, and the probe on some joints, with limits that bite, changes in flight and distortions.
Scenario eventful_scenario() {
  Scenario scenario = shipped("travelling_wave/coupled");
  scenario.kernel.seed = 18446744073709551557U;
  scenario.kernel.slots[2] = {&identity::sensing_probe(), JointMask(0b10110)};
  scenario.kernel.slots[3] = {&identity::reading_probe(), JointMask(0b10110)};
  scenario.joint_limits[1] = {-200'000'000, 300'000'000};
  scenario.joint_limits[4].upper = 100'000'000;
  scenario.robot.servo.period_us = 3'000;
  const std::string oscillator = "PatternGenerator_coupled_oscillator.";
  for (const std::string& setting :
       {std::string("SensingProbe.amplitude=4"), std::string("SensingProbe.amplitude:J1=9"),
        oscillator + "amplitude:J3=25", oscillator + "amplitude=33@120", oscillator + "frequency=0.7@120",
        std::string("ReadingProbe.amplitude=3"), std::string("SensingProbe.amplitude=6@120"),
        oscillator + "current_phase=77@0", oscillator + "current_phase:J4=-140@200",
        std::string("SensingProbe.mixture:J4=90@200"), std::string("SensingProbe.amplitude=3.5@201")}) {
    apply_setting(scenario, setting);
  }
  return scenario;
}

void record(const Scenario& scenario, std::uint32_t ticks, const std::filesystem::path& path) {
  Simulation simulation(scenario);
  Recorder recorder(path, scenario, "test", "build");
  while (simulation.tick() < ticks) {
    if (const Change* change = simulation.advance()) {
      recorder.record_change(*change);
    }
    recorder.record_tick(simulation.sample());
  }
  recorder.finish({{"setpoint_hash", simulation.setpoint_hash().hex()}, {"servo_hash", simulation.servo_hash().hex()}});
}

// ---------------------------------------------------------------------------------------------------------------------

class Replay {
 public:
  explicit Replay(const Recording& recording)
      : parameters_(recording.parameters()),
        distortions_(recording.distortions()),
        memory_(recording.joints().size()),
        kernel_(memory_) {
    KernelConfiguration configuration;
    configuration.joint_count = static_cast<std::uint8_t>(recording.joints().size());
    configuration.tick_period_us = recording.tick_period_us();
    configuration.seed = std::strtoull(recording.run_value("seed").c_str(), nullptr, 10);
    for (const RecordedSlot& slot : recording.slots()) {
      Slot& kernel_slot = configuration.slots.at(slot.slot);
      kernel_slot.algorithm = algorithm_of(slot.algorithm);
      for (unsigned joint = 0; joint < slot.joint_group.size(); ++joint) {
        if (slot.joint_group[joint]) {
          kernel_slot.group.insert(joint);
        }
      }
    }
    EXPECT_EQ(kernel_.configure(configuration, 0), Status::ok);
    for (unsigned joint = 0; joint < recording.joints().size(); ++joint) {
      const RecordedJoint& limits = recording.joints()[joint];
      EXPECT_EQ(kernel_.set_limits(joint, limits.lower_limit, limits.upper_limit), Status::ok);
    }
    for (const RecordedSetting& setting : parameters_) {
      if (!setting.commit) {
        EXPECT_EQ(kernel_.set_parameter(setting.slot, setting.joint, index_of(setting), setting.raw), Status::ok);
      }
    }
    kernel_.reset();
  }

  void advance(const RecordedTick& tick) {
    const auto transaction = static_cast<std::uint16_t>(tick.tick + 1);
    EXPECT_EQ(kernel_.open(transaction), Status::ok);
    for (const RecordedSetting& setting : parameters_) {
      if (setting.commit && setting.tick == tick.tick) {
        EXPECT_EQ(kernel_.stage(transaction, setting.slot, setting.joint, index_of(setting), setting.raw), Status::ok);
      }
    }
    for (const RecordedSetting& setting : distortions_) {
      if (setting.tick == tick.tick) {
        const int value = find_internal_value(declaration(setting.slot), setting.name);
        EXPECT_EQ(
            kernel_.stage_internal(transaction, setting.slot, setting.joint, static_cast<unsigned>(value), setting.raw),
            Status::ok);
      }
    }
    EXPECT_EQ(kernel_.commit(transaction, tick.tick), Status::ok);
    for (unsigned joint = 0; joint < kernel_.local_joint_count(); ++joint) {
      const unsigned head = joint == 0 ? tick.latched_contacts[0] : 0U;
      kernel_.set_contacts(joint, static_cast<std::uint8_t>(tick.latched_contacts[joint + 1] | head << 2U));
      kernel_.set_readings(joint, tick.readings[joint]);
    }
    kernel_.advance();
  }

  [[nodiscard]] const Kernel& kernel() const { return kernel_; }

 private:
  [[nodiscard]] const Declaration& declaration(std::uint32_t slot) const {
    return kernel_.configuration().slots.at(slot).algorithm->declaration();
  }
  [[nodiscard]] unsigned index_of(const RecordedSetting& setting) const {
    return static_cast<unsigned>(find_parameter(declaration(setting.slot), setting.name));
  }

  std::vector<RecordedSetting> parameters_;
  std::vector<RecordedSetting> distortions_;
  std::vector<JointMemory> memory_;
  Kernel kernel_;
};

std::string result(const Recording& recording, const std::string& name) {
  for (const auto& [key, value] : recording.results()) {
    if (key == name) {
      return value;
    }
  }
  return {};
}

class ReplayedRecording : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) /
                                ("proleg-replay-" + std::to_string(testing::UnitTest::GetInstance()->random_seed()) +
                                 "-" + std::to_string(::getpid()) + ".sqlite");
};

TEST_F(ReplayedRecording, RepeatsEverySetpointInternalValueAndServoCommand) {
  constexpr std::uint32_t ticks = 300;
  record(eventful_scenario(), ticks, path_);

  const Recording recording(path_);
  std::vector<ServoPulse> pulses;
  ServoPulseReader pulse_reader(recording);
  while (const auto next = pulse_reader.next()) {
    pulses.push_back(*next);
  }
  const ServoSchedule schedule(
      static_cast<std::uint32_t>(std::strtoul(recording.run_value("servo_period_us").c_str(), nullptr, 10)),
      recording.tick_period_us());
  Replay replay(recording);
  const Kernel& kernel = replay.kernel();
  const unsigned joints = kernel.local_joint_count();
  std::vector<MotionLimiter> limiters(joints);
  for (MotionLimiter& limiter : limiters) {
    limiter.set_step(MotionLimiter::step_of(default_command_speed, schedule.servo_period_us()));
  }
  ValueHash setpoint_hash;
  ValueHash servo_hash;
  std::size_t pulse = 0;
  unsigned contacts = 0;
  std::set<std::int32_t> pitches;
  unsigned limited = 0;

  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const RecordedTick& tick) {
    replay.advance(tick);
    for (unsigned joint = 0; joint < joints; ++joint) {
      ASSERT_EQ(tick.setpoints[joint], kernel.setpoint(joint)) << "tick " << tick.tick << " joint " << joint;
      setpoint_hash.append(kernel.setpoint(joint));
      limited += kernel.setpoint(joint) == recording.joints()[joint].upper_limit ? 1U : 0U;
    }
    std::vector<unsigned> count(max_slots * max_joints);
    for (std::size_t i = 0; i < tick.internal_values.size(); ++i) {
      const RecordedInternalValue& value = recording.internal_values()[i];
      const unsigned index = count[value.slot * max_joints + value.joint]++;
      ASSERT_EQ(tick.internal_values[i], kernel.internal_value(value.slot, value.joint, index))
          << "tick " << tick.tick << " joint " << value.joint << " " << value.name;
    }
    for (std::uint64_t n = schedule.first_interval(tick.tick); n < schedule.first_interval(tick.tick + 1U); ++n) {
      for (unsigned joint = 0; joint < joints; ++joint) {
        const std::int32_t command = servo_command(limiters[joint].next(
            interpolate(kernel.previous_setpoint(joint), kernel.setpoint(joint), schedule.fraction(n))));
        servo_hash.append(command);
        ASSERT_LT(pulse, pulses.size());
        ASSERT_EQ(pulses[pulse].time_us, schedule.start_us(n));
        ASSERT_EQ(pulses[pulse].joint, joint);
        ASSERT_EQ(pulses[pulse].command, command) << pulses[pulse].time_us << " us, joint " << joint;
        ++pulse;
      }
    }
    EXPECT_EQ(tick.readings[0].present, 0) << "of a joint without the probe";
    EXPECT_EQ(tick.readings[1].present, JointReadings::all_sensors) << "a simulated module has all sensors";
    pitches.insert(tick.readings[1].pitch);
    for (const std::uint8_t link : tick.latched_contacts) {
      contacts += link != 0 ? 1U : 0U;
    }
  });
  EXPECT_EQ(recording.last_tick() + 1, ticks);
  EXPECT_EQ(pulse, pulses.size());
  EXPECT_EQ(setpoint_hash.hex(), result(recording, "setpoint_hash"));
  EXPECT_EQ(servo_hash.hex(), result(recording, "servo_hash"));
  EXPECT_GT(contacts, 100U) << "the probe had something to react to";
  EXPECT_GT(pitches.size(), ticks / 2) << "the link moved";
  EXPECT_GT(limited, 10U) << "the limits cut something off";
}

}  // namespace
}  // namespace proleg::sim
