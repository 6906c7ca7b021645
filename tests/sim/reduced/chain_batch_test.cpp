// What a chain does depends neither on its lane, nor on the other chains, nor on the processor's instructions.

#include "sim/reduced/chain_batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "sim/reduced/kernel.hpp"
#include "sim/reduced/robot_chain.hpp"
#include "tests/sim/physics/small_world.hpp"
#include "tests/support/from_environment.hpp"

namespace proleg::sim::reduced {
namespace {

constexpr std::size_t links = 6;
constexpr std::size_t joints = links - 1;
constexpr double near_limit = 0.5;  // rad, of joint 0
constexpr std::size_t steps = 800;

struct Command {
  double speed;   ///< rad/s
  double torque;  ///< Nm
};

/// A chain, and what its servos want in each of the intervals of `interval` steps.
struct Candidate {
  static constexpr std::size_t interval = 100;
  PlanarChain chain;
  std::vector<std::array<Command, joints>> commands;
};

class ChainBatchTest : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 11; ++i) {
      candidates_.push_back(make());
    }
    for (auto& commands : candidates_[0].commands) {  // this one rolls up, so that its links touch each other
      std::fill(commands.begin() + 1, commands.end(), Command{3.0, 10.0});
    }
  }

  double between(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  Candidate make() {
    EnvironmentModel environment = flat_ground(between(0.0, 1.0), between(0.02, 0.03));
    environment.self_collision = true;
    StaticObject step = floor_with_friction(0.5);
    step.pose.position = {0, 50.06, -0.48};  // 20 mm high, before the head
    environment.objects.push_back(step);
    environment.gravity.y() = between(-2.0, 2.0);
    RobotModel robot = sim::chain(links);
    for (Link& link : robot.links) {
      const double factor = between(0.5, 2.0);
      link.mass.mass *= factor;
      link.mass.inertia *= factor;
    }
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const double limit = joint == 0 ? near_limit : 2.5;  // rad
      robot.joints[joint].lower_limit = -limit;
      robot.joints[joint].upper_limit = limit;
    }
    Candidate candidate{make_planar_chain(robot, environment, step_s, "test"), {}};
    for (std::size_t i = 0; i < steps / Candidate::interval; ++i) {
      for (Command& command : candidate.commands.emplace_back()) {
        const double strength = between(0.0, 1.0);  // strong, weak and limp motors
        command = {between(-8.0, 8.0), strength < 0.1 ? 0.0 : (strength < 0.6 ? between(0.01, 0.2) : 10.0)};
      }
    }
    return candidate;
  }

  /// The bits of all that can be read of each of the chosen candidates, after every step.
  [[nodiscard]] std::vector<std::vector<std::uint64_t>> run(const std::vector<std::size_t>& chosen,
                                                            const ChainKernel* kernel) const {
    std::vector<PlanarChain> chains;
    for (const std::size_t i : chosen) {
      chains.push_back(candidates_[i].chain);
    }
    ChainBatch<Planar> batch(chains, kernel);
    std::vector<std::vector<std::uint64_t>> traces(chosen.size());
    for (std::size_t step = 0; step < steps; ++step) {
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        command(batch, k, candidates_[chosen[k]], step);
      }
      batch.step();
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        read(batch, k, traces[k]);
      }
    }
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      EXPECT_FALSE(batch.failed(k)) << "candidate " << chosen[k];
    }
    return traces;
  }

  static void command(ChainBatch<Planar>& batch, std::size_t chain, const Candidate& candidate, std::size_t step) {
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const Command& command = candidate.commands[step / Candidate::interval][joint];
      batch.set_wanted_speed(chain, joint, command.speed);
      batch.set_max_torque(chain, joint, command.torque);
    }
  }

  static void read(const ChainBatch<Planar>& batch, std::size_t chain, std::vector<std::uint64_t>& trace) {
    const auto add = [&](double value) { trace.push_back(std::bit_cast<std::uint64_t>(value)); };
    std::ranges::for_each(batch.state(chain), add);
    for (std::size_t joint = 0; joint < joints; ++joint) {
      add(batch.motor_torque(chain, joint));
    }
    for (std::size_t link = 0; link < links; ++link) {
      add(batch.contact_force(chain, link));
      trace.push_back(batch.pressed(chain, link));
    }
    add(batch.sliding(chain).normal_force);
    add(batch.sliding(chain).force_times_speed);
    trace.push_back(batch.contact_count(chain));
  }

  [[nodiscard]] std::vector<std::vector<std::uint64_t>> run_alone() const {
    std::vector<std::vector<std::uint64_t>> traces;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      traces.push_back(run({i}, supported_kernels().front()).front());
    }
    return traces;
  }

  const std::uint32_t seed_ = from_environment("PROLEG_SEED", 17);
  const testing::ScopedTrace trace_{__FILE__, __LINE__, "PROLEG_SEED=" + std::to_string(seed_)};
  std::mt19937_64 random_{seed_};
  std::vector<Candidate> candidates_;
};

TEST(ChooseKernel, GivesTheWidestKernelWhoseLanesTheChainsFillByMoreThanHalf) {
  const ChainKernel* const narrowest = supported_kernels().front();
  EXPECT_EQ(&choose_kernel(0), narrowest);
  EXPECT_EQ(&choose_kernel(1), narrowest);
  for (const ChainKernel* kernel : supported_kernels()) {
    const std::size_t half = static_cast<std::size_t>(kernel->width) / 2;
    EXPECT_EQ(&choose_kernel(half + 1), kernel);
    if (kernel != narrowest) {
      EXPECT_NE(&choose_kernel(half), kernel);
    }
  }
  EXPECT_EQ(&choose_kernel(1000), supported_kernels().back());
}

TEST_F(ChainBatchTest, AChainGivesTheSameBitsAloneInAnyLaneAndWithEveryKernel) {
  const std::vector<std::vector<std::uint64_t>> expected = run_alone();
  std::vector<std::size_t> order(candidates_.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  for (const ChainKernel* kernel : supported_kernels()) {
    for (const std::size_t count : {order.size(), std::size_t{3}}) {
      std::ranges::shuffle(order, random_);
      const std::vector<std::size_t> chosen(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count));
      const std::vector<std::vector<std::uint64_t>> traces = run(chosen, kernel);
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        EXPECT_TRUE(traces[k] == expected[chosen[k]])
            << kernel->instructions << ", candidate " << chosen[k] << " in place " << k << " of " << count;
      }
    }
  }
}

TEST_F(ChainBatchTest, TheRandomRunsHaveWeakMotorsStopsAndContactsOfBothKinds) {
  bool has_weak_motor = false;
  bool has_stop = false;
  bool has_self_contact = false;
  std::size_t most_contacts = 0;
  for (const Candidate& candidate : candidates_) {
    ChainBatch<Planar> batch(std::span(&candidate.chain, 1));
    for (std::size_t step = 0; step < steps; ++step) {
      command(batch, 0, candidate, step);
      batch.step();
      most_contacts = std::max(most_contacts, batch.contact_count(0));
      for (std::size_t joint = 0; joint < joints; ++joint) {
        const double torque = candidate.commands[step / Candidate::interval][joint].torque;
        has_weak_motor |= torque > 0.0 && std::abs(batch.motor_torque(0, joint)) == torque;
      }
      has_stop |= std::abs(batch.joint_angle(0, 0)) > near_limit - 1e-6;
      double forces = 0.0;  // those between links count twice, those with the ground once
      for (std::size_t link = 0; link < links; ++link) {
        forces += batch.contact_force(0, link);
      }
      has_self_contact |= forces > batch.sliding(0).normal_force + 1e-3;
    }
  }
  EXPECT_TRUE(has_weak_motor);
  EXPECT_TRUE(has_stop);
  EXPECT_TRUE(has_self_contact);
  EXPECT_GE(most_contacts, 5U);
}

TEST_F(ChainBatchTest, AChainThatBreaksDownTouchesNoOther) {
  const std::vector<std::vector<std::uint64_t>> expected = run_alone();
  for (const ChainKernel* kernel : supported_kernels()) {
    std::vector<PlanarChain> chains;
    for (const Candidate& candidate : candidates_) {
      chains.push_back(candidate.chain);
    }
    chains[1].gravity.z = -std::numeric_limits<double>::infinity();
    chains[4].masses[2] = std::numeric_limits<double>::quiet_NaN();
    chains[9].gravity.z = 1e308;  // finite, for a while
    const auto is_broken = [](std::size_t chain) { return chain == 1 || chain == 4 || chain == 9; };
    ChainBatch<Planar> batch(chains, kernel);
    std::vector<std::vector<std::uint64_t>> traces(chains.size());
    for (std::size_t step = 0; step < steps; ++step) {
      for (std::size_t k = 0; k < chains.size(); ++k) {
        command(batch, k, candidates_[k], step);
      }
      batch.step();
      for (std::size_t k = 0; k < chains.size(); ++k) {
        read(batch, k, traces[k]);
      }
    }
    for (std::size_t k = 0; k < chains.size(); ++k) {
      if (k != 9) {
        EXPECT_EQ(batch.failed(k), is_broken(k)) << kernel->instructions << ", chain " << k;
      }
      if (!is_broken(k)) {
        EXPECT_TRUE(traces[k] == expected[k]) << kernel->instructions << ", chain " << k;
      }
    }
  }
}

TEST_F(ChainBatchTest, AChainIsPlacedAtRestLikeAnother) {
  std::vector<PlanarChain> chains{candidates_[0].chain, candidates_[1].chain};
  ChainBatch<Planar> moved(chains);
  for (std::size_t joint = 0; joint < joints; ++joint) {
    moved.set_max_torque(1, joint, 10.0);
    moved.set_wanted_speed(1, joint, joint % 2 == 0 ? 1.0 : -1.0);
  }
  for (int i = 0; i < 300; ++i) {
    moved.step();
  }
  ChainBatch<Planar> placed(chains);
  const std::vector<double> untouched = placed.state(0);
  placed.place_like(1, moved, 1, {3.0, 4.0});
  EXPECT_EQ(placed.state(0), untouched);
  EXPECT_EQ(placed.center(1), (Point{3.0, 4.0}));
  const Point center = moved.center(1);
  for (std::size_t link = 0; link < links; ++link) {
    const ChainBatch<Planar>::LinkPlace expected = moved.link_place(1, link);
    const ChainBatch<Planar>::LinkPlace place = placed.link_place(1, link);
    EXPECT_EQ(place.half_sine, expected.half_sine);
    EXPECT_EQ(place.half_cosine, expected.half_cosine);
    EXPECT_NEAR(place.position.x - 3.0, expected.position.x - center.x, 1e-12);
    EXPECT_NEAR(place.position.z - 4.0, expected.position.z - center.z, 1e-12);
    const ChainBatch<Planar>::LinkMotion motion = placed.link_motion(1, link);
    EXPECT_EQ(motion.velocity, (Point{0.0, 0.0}));
    EXPECT_EQ(motion.rotation, 0.0);
  }
  placed.step();
  for (std::size_t joint = 0; joint < joints; ++joint) {
    EXPECT_NEAR(placed.joint_angle(1, joint) - moved.joint_angle(1, joint), joint % 2 == 0 ? step_s : -step_s, 1e-12)
        << "its motor goes on";
  }
}

}  // namespace
}  // namespace proleg::sim::reduced
