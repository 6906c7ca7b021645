// Random robots: the simulation, native modules and the flashed image give the same set-points and servo commands.
//
// Run n draws the algorithms, their joints and parameters, the seed, a tick of 3 to 20 ms, a servo period of 0.7 to 20
// ms and losses of 0 to 20 %. PROLEG_SWEEP_FIRST and PROLEG_SWEEP_RUNS choose the runs.

#include <gtest/gtest.h>

#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "shared/fixed/random.hpp"
#include "shared/gait/registry.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/module_sensors.hpp"
#include "tests/support/from_environment.hpp"
#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

constexpr double duration_s = 4.0;

struct RandomRobot {
  Scenario scenario;
  Losses losses;
  std::string description;  ///< what differs from the shipped travelling wave
};

class RobotGenerator {
 public:
  explicit RobotGenerator(std::uint32_t run) : noise_(run, 61) {}

  RandomRobot draw() {
    robot_.scenario = shipped("travelling_wave/uniform");
    text_ << "the shipped travelling wave with";
    draw_times();
    do {
      draw_slots();
    } while (!is_valid());
    describe_slots();
    draw_parameters();
    draw_losses();
    robot_.description = text_.str();
    return std::move(robot_);
  }

 private:
  std::uint32_t joint_count() const { return robot_.scenario.kernel.joint_count; }

  void draw_times() {
    KernelConfiguration& kernel = robot_.scenario.kernel;
    kernel.tick_period_us = 1'000 * (3 + noise_.below(18));
    robot_.scenario.robot.servo.period_us = 100 * (7 + noise_.below(194));
    kernel.seed = std::uint64_t{noise_.next()} << 32U;
    kernel.seed |= noise_.next();
    text_ << "\n  tick " << kernel.tick_period_us << " us, servo period " << robot_.scenario.robot.servo.period_us
          << " us, seed " << kernel.seed;
  }

  void draw_slots() {
    robot_.scenario.kernel.slots = {};
    const std::uint32_t count = 1 + noise_.below(3);
    for (std::uint32_t slot = 0; slot < count; ++slot) {
      const std::uint32_t all = (1U << joint_count()) - 1;
      const std::uint32_t algorithm = noise_.below(static_cast<std::uint32_t>(algorithm_count()));
      const std::uint32_t group = noise_.below(3) == 0 ? 1 + noise_.below(all) : all;
      robot_.scenario.kernel.slots[slot] = {&algorithm_at(algorithm), JointMask(group)};
    }
  }

  /// Whether a kernel takes the slots: a joint has two state frames at most.
  bool is_valid() const {
    KernelOf<5> kernel;
    return kernel.configure(robot_.scenario.kernel, 0) == Status::ok;
  }

  void describe_slots() {
    for (const Slot& slot : robot_.scenario.kernel.slots) {
      if (slot.algorithm != nullptr) {
        text_ << "\n  " << slot.algorithm->declaration().name << " on joints " << slot.group.bits();
      }
    }
  }

  void draw_parameters() {
    robot_.scenario.settings.clear();
    for (std::uint8_t slot = 0; slot < max_slots; ++slot) {
      const Slot& drawn = robot_.scenario.kernel.slots[slot];
      for (std::uint8_t joint = 0; drawn.algorithm != nullptr && joint < joint_count(); ++joint) {
        if (drawn.group.contains(joint)) {
          draw_parameters_of(slot, joint, drawn.algorithm->declaration());
        }
      }
    }
  }

  /// Again until modules have the sensors that the parameters need.
  void draw_parameters_of(std::uint8_t slot, std::uint8_t joint, const Declaration& declaration) {
    std::vector<Setting> drawn;
    do {
      drawn.clear();
      for (std::uint8_t i = 0; i < declaration.parameters.size(); ++i) {
        if (noise_.below(2) != 0) {
          drawn.push_back({slot, joint, i, false, draw_value_of(declaration.parameters[i])});
        }
      }
    } while (!can_run_on_modules(declaration, drawn));
    for (const Setting& setting : drawn) {
      robot_.scenario.settings.push_back(setting);
      text_ << "\n  slot " << int{slot} << ", joint " << int{joint} << ": "
            << declaration.parameters[setting.number].name << " = " << setting.value;
    }
  }

  std::int32_t draw_value_of(const Parameter& parameter) {
    const auto width = static_cast<std::uint64_t>(std::int64_t{parameter.maximum} - parameter.minimum);
    const std::uint64_t distance = (width * noise_.next()) >> 32U;
    return static_cast<std::int32_t>(parameter.minimum + static_cast<std::int64_t>(distance));
  }

  static bool can_run_on_modules(const Declaration& declaration, const std::vector<Setting>& settings) {
    std::array<std::int32_t, max_parameters> values{};
    for (std::size_t i = 0; i < declaration.parameters.size(); ++i) {
      values[i] = declaration.parameters[i].default_value;
    }
    for (const Setting& setting : settings) {
      values[setting.number] = setting.value;
    }
    return declaration.rules == nullptr ||
           (declaration.rules->required_readings(values.data()) & ~sensors_of_modules) == 0;
  }

  void draw_losses() {
    const std::uint32_t percent = noise_.below(3) == 0 ? 0 : noise_.below(21);
    const std::uint32_t seed = noise_.below(1'000'000);
    robot_.losses = Losses(RandomLosses{seed, static_cast<std::uint32_t>(percent * 42'949'672ULL)});
    text_ << "\n  --losses " << seed << ":" << percent << "%";
  }

  Pcg32 noise_;
  RandomRobot robot_;
  std::ostringstream text_;
};

std::uint32_t tick_count(const RandomRobot& robot) {
  return static_cast<std::uint32_t>(duration_s * 1e6 / robot.scenario.kernel.tick_period_us);
}

std::string difference_text(const Scenario& scenario, const std::optional<Difference>& difference) {
  return difference ? describe(*difference, scenario.robot.joints[difference->joint].name) : "";
}

void expect_identical(const RandomRobot& robot, const Simulation& simulation, VirtualRobot::Choice is_virtual) {
  HardwareOptions options;
  options.losses = &robot.losses;
  VirtualRobot modules(robot.scenario, std::move(options), std::move(is_virtual));
  modules.run_to(tick_count(robot));
  EXPECT_EQ(modules.loop().differences(), 0U) << difference_text(robot.scenario, modules.loop().first_difference());
  EXPECT_EQ(modules.loop().setpoint_hash().hex(), simulation.setpoint_hash().hex());
  EXPECT_EQ(modules.loop().servo_hash().hex(), simulation.servo_hash().hex());
}

TEST(Sweep, RandomRobotsMoveBitForBitAlikeInSimulationInNativeModulesAndInTheImage) {
  const std::uint32_t first = from_environment("PROLEG_SWEEP_FIRST", 0);
  const std::uint32_t runs = from_environment("PROLEG_SWEEP_RUNS", 10);
  for (std::uint32_t run = first; run < first + runs; ++run) {
    const RandomRobot robot = RobotGenerator(run).draw();
    SCOPED_TRACE("run " + std::to_string(run) + ": " + robot.description);
    Simulation simulation(robot.scenario, &robot.losses);
    while (simulation.tick() < tick_count(robot)) {
      simulation.advance();
    }
    expect_identical(robot, simulation, [](unsigned) { return false; });
    expect_identical(robot, simulation, [](unsigned) { return true; });
  }
}

}  // namespace
}  // namespace proleg::sim
