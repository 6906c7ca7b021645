#include "sim/scenario/losses.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

RobotModel caterpillar_robot() {
  DiskFiles files;
  return read_scenario(std::filesystem::path(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml")),
                       files)
      .robot;
}

class LossFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  Losses read(const std::string& text) {
    std::ofstream(path_) << text;
    return read_losses(path_.string(), robot_);
  }

  void expect_refusal(const std::string& text, const std::string& message) {
    try {
      (void)read(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }

  RobotModel robot_ = caterpillar_robot();
  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("proleg-losses-" + std::to_string(::getpid()) + ".txt");
};

// Joints of files are J1 at the tail to J5 at the head; kernel joint 0 is the head.
TEST_F(LossFile, NamesTickSenderReceiverAndChannel) {
  const Losses losses = read("# a comment\n120 J5 J4\n\n120 J5 J1  # both\n7 J1 J2 2\n");
  EXPECT_TRUE(losses.any());
  EXPECT_EQ(losses.receivers_without(120, 0, 0), JointMask(0b10010));
  EXPECT_EQ(losses.receivers_without(120, 0, 1), JointMask());
  EXPECT_EQ(losses.receivers_without(7, 4, 1), JointMask(0b01000));
  EXPECT_EQ(losses.receivers_without(7, 4, 0), JointMask());
  EXPECT_EQ(losses.receivers_without(119, 0, 0), JointMask());
  EXPECT_TRUE(losses.lost({120, 0, 0, 1}));
  EXPECT_FALSE(losses.lost({120, 0, 0, 2}));
}

TEST_F(LossFile, MayComeFromAnyEditor) {
  EXPECT_EQ(read("\xEF\xBB\xBF"
                 "5\tJ3 *\r\n")
                .receivers_without(5, 2, 0),
            JointMask(0b11011));
  expect_refusal("5\xC2\xA0J3 *", "'5<U+00A0>J3 *'");
}

TEST_F(LossFile, AStarMeansAllOtherJoints) { EXPECT_EQ(read("5 J3 *").receivers_without(5, 2, 0), JointMask(0b11011)); }

TEST_F(LossFile, WithoutALineIsNoLoss) { EXPECT_FALSE(read("# nothing\n").any()); }

TEST_F(LossFile, WhatDoesNotFitIsRefusedWithItsLine) {
  expect_refusal("5 J3\n", path_.string() + ":1: found '5 J3', expected TICK SENDER RECEIVER [CHANNEL]");
  expect_refusal("1 J1 J2\nx J1 J2\n", ":2:");
  expect_refusal("1 J1 J2 3\n", "channel 1 or 2");
  expect_refusal("1 J1 J2 1 1\n", "expected TICK SENDER");
  expect_refusal("-1 J1 J2\n", ":1:");
  expect_refusal("4294967296 J1 J2\n", ":1:");
  expect_refusal("1 J1 J9\n", "unknown joint 'J9', expected one of J1, J2, J3, J4, J5");
  expect_refusal("1 J1 J1\n", "J1 as sender and receiver");
}

TEST_F(LossFile, AMissingFileIsRefused) {
  EXPECT_THROW((void)read_losses("/missing/losses", robot_), InputError);
  EXPECT_THROW((void)read_losses("", robot_), InputError);
}

TEST(RandomLosses, HaveTheirRate) {
  const RobotModel robot = caterpillar_robot();
  for (const auto& [argument, rate] : {std::pair{"7:5%", 0.05}, std::pair{"11:0.25", 0.25}, std::pair{"3:1", 1.0}}) {
    const Losses losses = read_losses(argument, robot);
    std::uint64_t lost = 0;
    std::uint64_t frames = 0;
    for (std::uint32_t tick = 0; tick < 2000; ++tick) {
      for (unsigned sender = 0; sender < 20; ++sender) {
        const std::uint64_t bits = losses.receivers_without(tick, sender, 0).bits() & JointMask::first(20).bits();
        lost += static_cast<std::uint64_t>(std::popcount(bits));
        frames += 19;
      }
    }
    const double deviation = std::sqrt(static_cast<double>(frames) * rate * (1 - rate)) + 1;
    EXPECT_NEAR(static_cast<double>(lost), static_cast<double>(frames) * rate, 4 * deviation) << argument;
  }
}

TEST(RandomLosses, NeverContainAJointsOwnFrame) {
  const Losses losses = read_losses("3:100%", caterpillar_robot());
  for (unsigned sender = 0; sender < max_joints; ++sender) {
    EXPECT_FALSE(losses.receivers_without(9, sender, 0).contains(sender));
  }
}

TEST(RandomLosses, DifferWithSeedTickSenderAndChannelAndRepeat) {
  const RobotModel robot = caterpillar_robot();
  const auto pattern = [&](const char* argument, std::uint32_t tick, unsigned sender, unsigned channel) {
    return read_losses(argument, robot).receivers_without(tick, sender, channel).bits();
  };
  const std::uint64_t reference = pattern("7:50%", 100, 3, 0);
  EXPECT_EQ(pattern("7:0.5", 100, 3, 0), reference);
  EXPECT_NE(pattern("8:50%", 100, 3, 0), reference);
  EXPECT_NE(pattern("7:50%", 101, 3, 0), reference);
  EXPECT_NE(pattern("7:50%", 100, 4, 0), reference);
  EXPECT_NE(pattern("7:50%", 100, 3, 1), reference);
}

TEST(RandomLosses, StayWithinTheirTicks) {
  const Losses losses = read_losses("1:100%@10-20", caterpillar_robot());
  EXPECT_FALSE(losses.lost({9, 0, 0, 1}));
  EXPECT_TRUE(losses.lost({10, 0, 0, 1}));
  EXPECT_TRUE(losses.lost({20, 0, 0, 1}));
  EXPECT_FALSE(losses.lost({21, 0, 0, 1}));
}

TEST(RandomLosses, RefuseWhatIsNoRateOrRange) {
  const RobotModel robot = caterpillar_robot();
  for (const char* argument : {"7:", "7:x", "7:1.5", "7:-1%", "7:101%", "7:5%@", "7:5%@9", "7:5%@9-3", "7:5%@-3",
                               "99999999999999999999:5%", "7:nan"}) {
    EXPECT_THROW((void)read_losses(argument, robot), InputError) << argument;
  }
}

}  // namespace
}  // namespace proleg::sim
