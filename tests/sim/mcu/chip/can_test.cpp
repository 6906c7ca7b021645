// The CAN controller as the program drives it: load, order, filters, bus-off.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

/// Instructions that a chip in Pre-operational executes in 30 ms, in which it receives these frames at this distance.
std::uint64_t instructions(
    const std::vector<CanFrame>& frames, BusTime distance,
    const std::function<void(ChipRig&)>& prepare = [](ChipRig&) {}) {
  ChipRig rig;
  rig.boot();
  prepare(rig);
  const BusTime start = rig.bus.now();
  const std::uint64_t before = rig.chip.instructions();
  for (const CanFrame& frame : frames) {
    rig.host.send(frame);
    rig.run_for(distance);
  }
  rig.run_until(start + 30 * ms);
  EXPECT_TRUE(rig.host.is_done());
  EXPECT_TRUE(rig.events.empty());
  return rig.chip.instructions() - before;
}

/// As short as a frame can be: 44 bits and stuff bits.
const CanFrame shortest{0x680, 0, {}};

TEST(ChipCan, ABurstOf64FramesCostsAsMuchAs64FramesOneByOneSoNoneIsLost) {
  const std::uint64_t idle = instructions({}, 0);
  const std::uint64_t one = instructions({shortest}, 400 * us) - idle;
  const std::vector<CanFrame> burst(64, shortest);
  const std::uint64_t one_by_one = instructions(burst, 400 * us) - idle;
  const std::uint64_t back_to_back = instructions(burst, 0) - idle;
  EXPECT_GT(one, 100U);
  EXPECT_EQ(one_by_one, 64 * one);
  EXPECT_NEAR(static_cast<double>(back_to_back), static_cast<double>(64 * one), static_cast<double>(one) / 2);
}

TEST(ChipCan, SixtyFourRequestsBackToBackAreAllAnsweredInTheirOrder) {
  ChipRig rig;
  rig.boot();
  constexpr std::array<std::uint16_t, 4> objects{0x1018, 0x2000, 0x2003, 0x1800};
  std::vector<CanFrame> requests;
  for (unsigned i = 0; i < 64; ++i) {
    const std::uint16_t object = objects.at(i / 2 % 4);
    requests.push_back({0x603,
                        8,
                        {0x40, static_cast<std::uint8_t>(object), static_cast<std::uint8_t>(object >> 8U),
                         static_cast<std::uint8_t>(1 + i % 2)}});
  }
  const BusTime start = rig.bus.now();
  rig.bus.start_statistics();
  for (const CanFrame& request : requests) {
    rig.host.send(request);
  }
  ASSERT_TRUE(rig.run_until_true([&] { return rig.host.is_done(); }));
  EXPECT_GT(rig.bus.statistics().load(), 0.99);
  rig.run_for(10 * ms);
  const std::vector<LoggedFrame> answers = rig.frames(0x583, start);
  ASSERT_EQ(answers.size(), requests.size());
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_EQ(answers[i].frame.data[0] & 0xE0U, 0x40U);
    for (unsigned byte = 1; byte < 4; ++byte) {
      EXPECT_EQ(answers[i].frame.data.at(byte), requests[i].data.at(byte)) << "answer " << i;
    }
  }
}

TEST(ChipCan, FramesThatDoNotMatterCostNoInstruction) {
  std::vector<CanFrame> foreign;
  for (const unsigned identifier : {0x001U, 0x081U, 0x084U, 0x100U, 0x182U, 0x184U, 0x204U, 0x284U, 0x304U, 0x384U,
                                    0x404U, 0x584U, 0x604U, 0x682U, 0x691U, 0x6FFU, 0x704U, 0x77EU, 0x784U, 0x7E4U}) {
    foreign.push_back({static_cast<std::uint16_t>(identifier), 8, {1, 2, 3, 4, 5, 6, 7, 8}});
  }
  EXPECT_EQ(instructions(foreign, 300 * us), instructions({}, 0));
}

TEST(ChipCan, EachFrameThatMattersIsProcessed) {
  const std::uint64_t idle = instructions({}, 0);
  for (const unsigned identifier : {0x000U, 0x080U, 0x203U, 0x603U, 0x680U, 0x681U, 0x690U, 0x77FU, 0x7E5U}) {
    EXPECT_GT(instructions({{static_cast<std::uint16_t>(identifier), 0, {}}}, 300 * us), idle + 100)
        << std::hex << identifier;
  }
}

TEST(ChipCan, ReceivesTheHeartbeatOfTheNodeThatItExpectsAndOfTheHost) {
  constexpr std::uint32_t never = 0xFFFF;  // ms: no timeout in this test
  const auto cost = [](std::uint16_t identifier, std::uint32_t expected) {
    const auto prepare = [expected](ChipRig& rig) {
      rig.write(0x1016, 1, 4, 4U << 16U | never);
      rig.write(0x1016, 1, 4, expected);
    };
    return instructions({{identifier, 1, {0x05}}}, 300 * us, prepare) - instructions({}, 0, prepare);
  };
  for (const std::uint32_t node : {5U, 126U}) {
    EXPECT_GT(cost(static_cast<std::uint16_t>(0x700 + node), node << 16U | never), 100U);
    EXPECT_EQ(cost(0x704, node << 16U | never), 0U) << "the node that was expected before";
    EXPECT_GT(cost(0x77F, node << 16U | never), 100U) << "it has the lease";
  }
  for (const std::uint32_t none : {0U, 5U << 16U, never, 127U << 16U | never}) {
    EXPECT_EQ(cost(0x705, none), 0U);
    EXPECT_GT(cost(0x77F, none), 100U);
  }
  const auto reset = [](ChipRig& rig) {
    rig.write(0x1016, 1, 4, 4U << 16U | never);
    rig.host.send({0x000, 2, {0x82, ChipRig::node}});  // reset communication
    rig.run_for(100 * ms);
  };
  EXPECT_EQ(instructions({{0x704, 1, {0x05}}}, 300 * us, reset), instructions({}, 0, reset));
}

TEST(ChipCan, ReceivesTheStateFramesOfItsNeighboursOnly) {
  const auto prepare = [](ChipRig& rig) {
    constexpr std::uint32_t coupled = 4;
    rig.write(0x2001, 2, 1, 3);
    rig.write(0x2001, 4, 1, 4);
    rig.write(0x1411, 1, 4, 0x184);
    rig.write(0x1412, 1, 4, 0x185);
    rig.write(0x2006, 1, 1, coupled);
    rig.write(0x2007, 1, 4, 7);
    rig.write(0x2005, 6, 1, 1);
  };
  const CanFrame neighbour{0x184, 8, {0, 0, 0, 0, 0, 0, 0x80, 0}};
  const CanFrame one_further{0x185, 8, {0, 0, 0, 0, 0, 0, 0x80, 0}};
  const std::uint64_t idle = instructions({}, 0, prepare);
  EXPECT_GT(instructions({neighbour}, 300 * us, prepare), idle + 100);
  EXPECT_EQ(instructions({one_further}, 300 * us, prepare), idle);
}

TEST(ChipCan, DetectsAnotherModuleOnItsOwnIdentifiersAndStops) {
  for (const unsigned identifier : {0x083U, 0x183U, 0x283U, 0x383U, 0x583U, 0x703U}) {
    ChipRig rig;
    rig.boot();
    const BusTime start = rig.bus.now();
    rig.host.send({static_cast<std::uint16_t>(identifier), 1, {0x05}});
    rig.run_for(5 * ms);
    std::vector<LoggedFrame> emergencies = rig.frames(0x083, start);
    std::erase_if(emergencies, [](const LoggedFrame& logged) { return logged.by_host; });
    ASSERT_EQ(emergencies.size(), 1U) << std::hex << identifier;
    EXPECT_EQ(emergency_code(emergencies[0]), 0x8150U);
    EXPECT_EQ(emergencies[0].frame.data[3] | emergencies[0].frame.data[4] << 8, static_cast<int>(identifier));
  }
}

class BusOff : public testing::Test {
 protected:
  BusOff() {
    rig_.boot();
    rig_.write(0x1017, 0, 2, 20);
    rig_.run_for(50 * ms);
  }
  /// Destroys its frames until it is in bus-off; returns when that was.
  BusTime destroy() {
    unsigned destroyed = 0;
    rig_.bus.set_error_rule([&destroyed](const CanFrame& frame, std::uint64_t) {
      destroyed += frame.identifier == 0x703 ? 1U : 0U;
      return frame.identifier == 0x703;
    });
    constexpr unsigned attempts = 32;  // ISO 11898-1: 8 for each, bus-off from 256 on
    EXPECT_TRUE(rig_.run_until_true([&] { return destroyed == attempts; }, 200 * ms));
    const BusTime last_attempt = rig_.bus.now();
    EXPECT_TRUE(rig_.run_until_true([&] { return rig_.host.last_error > last_attempt; }, ms));
    rig_.bus.set_error_rule({});
    return rig_.host.last_error;
  }
  ChipRig rig_;
};

TEST_F(BusOff, IsBackAfterTenMillisecondsAndReportsHowLongItWasAway) {
  const BusTime off = destroy();
  rig_.run_for(100 * ms);
  const std::vector<LoggedFrame> emergencies = rig_.frames(0x083);
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergency_code(emergencies[0]), 0x8140U);
  // 10 ms, 128 times 11 bits of 1 us, and up to 1 ms until the program looks.
  const BusTime away = emergencies[0].time - off;
  EXPECT_GE(away, 10 * ms + 128 * 11 * us);
  EXPECT_LE(away, 10 * ms + 128 * 11 * us + 2 * ms + 300 * us);
  const auto reported = static_cast<BusTime>(emergencies[0].frame.data[3]);
  EXPECT_LE(reported, away / ms);
  EXPECT_GE(reported + 1, away / ms);
  std::vector<LoggedFrame> between = rig_.log;
  std::erase_if(between,
                [&](const LoggedFrame& logged) { return logged.time <= off || logged.time >= emergencies[0].time; });
  EXPECT_TRUE(between.empty());
  EXPECT_GE(rig_.frames(0x703, off).size(), 3U) << "its heartbeat continues";
}

TEST_F(BusOff, EachTimeWithoutTenGoodSecondsBetweenItWaitsTwiceAsLong) {
  for (const BusTime pause : {10 * ms, 20 * ms, 40 * ms, 80 * ms}) {
    const BusTime off = destroy();
    ASSERT_TRUE(rig_.run_until_true([&] { return !rig_.frames(0x083, off).empty(); }, 2'000 * ms));
    const BusTime away = rig_.frames(0x083, off)[0].time - off;
    EXPECT_GE(away, pause + 128 * 11 * us);
    EXPECT_LE(away, pause + 128 * 11 * us + 2 * ms + 300 * us);
    rig_.run_for(50 * ms);
  }
}

TEST_F(BusOff, AfterTenGoodSecondsTheNextOneWaitsAsLongAsTheFirst) {
  destroy();
  rig_.run_for(10'200 * ms);
  const std::vector<LoggedFrame> emergencies = rig_.frames(0x083);
  ASSERT_EQ(emergencies.size(), 2U);
  EXPECT_EQ(emergency_code(emergencies[1]), 0U) << "over";
  const BusTime off = destroy();
  ASSERT_TRUE(rig_.run_until_true([&] { return !rig_.frames(0x083, off).empty(); }));
  EXPECT_LE(rig_.frames(0x083, off)[0].time - off, 14 * ms);
}

/// The module's program stands still, while the interrupts of the controller fill its ring of 64 events.
class FullRing : public BusOff {
 protected:
  static constexpr unsigned ring_size = 64;
  void flood(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      rig_.host.send(shortest);
    }
  }
};

TEST_F(FullRing, ABusOffThatFindsNoRoomEndsWithinASecond) {
  // The heartbeat is in a mailbox when the program stops.
  bool destroys = false;
  rig_.bus.set_error_rule([&destroys](const CanFrame& frame, std::uint64_t) {
    destroys = destroys || frame.identifier == 0x703;
    return frame.identifier == 0x703;
  });
  ASSERT_TRUE(rig_.run_until_true([&] { return destroys; }));
  rig_.break_program({branch_to_itself});
  flood(ring_size + 10);
  rig_.run_for(60 * ms);
  rig_.mend_program();
  rig_.bus.set_error_rule({});
  const BusTime mended = rig_.bus.now();
  EXPECT_TRUE(rig_.events.empty()) << "no reset";
  ASSERT_TRUE(rig_.run_until_true([&] { return rig_.frames(0x703, mended).size() >= 2; }));
  rig_.run_for(10 * ms);
  EXPECT_LE(rig_.frames(0x703, mended)[0].time, mended + 1'000 * ms);
  const std::vector<LoggedFrame> emergencies = rig_.frames(0x083, mended);
  EXPECT_TRUE(std::ranges::any_of(emergencies, [](const LoggedFrame& it) { return emergency_code(it) == 0x8140; }));
}

TEST_F(FullRing, FramesThatFindNoRoomAreCountedAndReported) {
  EXPECT_EQ(rig_.read(0x200B, 1), 0U);
  const BusTime start = rig_.bus.now();
  rig_.break_program({branch_to_itself});
  flood(ring_size + 36);
  ASSERT_TRUE(rig_.run_until_true([this] { return rig_.host.is_done(); }, 50 * ms));
  rig_.mend_program();
  rig_.run_for(100 * ms);
  const std::uint32_t lost = rig_.read(0x200B, 1);
  EXPECT_GE(lost, 36U);
  EXPECT_LE(lost, 36U + 3U) << "events of its own frames";
  const std::vector<LoggedFrame> emergencies = rig_.frames(0x083, start);
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergency_code(emergencies[0]), 0x8110U);
  EXPECT_EQ(emergencies[0].frame.data[3], lost);
}

TEST_F(BusOff, ThatComesAgainAtOnceEndsWithinASecond) {
  rig_.bus.set_error_rule([](const CanFrame& frame, std::uint64_t) { return (frame.identifier & 0x7FU) == 3; });
  rig_.run_for(150 * ms);
  rig_.bus.set_error_rule({});
  const BusTime mended = rig_.bus.now();
  EXPECT_TRUE(rig_.run_until_true([&] { return !rig_.frames(0x703, mended).empty(); }));
}

TEST(ChipCan, SyncDoesNotWaitForFramesThatOthersOutbid) {
  ChipRig rig;
  rig.start_robot(20'000);
  rig.write(0x1017, 0, 2, 20);
  rig.run_for(50 * ms);
  // Lower than the state frame, the monitoring and the heartbeat of the module, and not urgent: the bus is full of it.
  const CanFrame outbids{0x100, 8, {}};
  const BusTime start = rig.bus.now();
  rig.host.send({0x603, 8, {0x40, 0x00, 0x10, 0x00}});  // its answer waits, too
  for (unsigned i = 0; i < 700; ++i) {
    rig.host.send(outbids);
  }
  ASSERT_TRUE(rig.run_until_true([&] { return rig.host.is_done(); }));
  const BusTime end = rig.bus.now();
  EXPECT_GT(end - start, 80 * ms);
  const std::size_t syncs = rig.frames(0x080, start).size();
  EXPECT_GE(syncs, (end - start) / (10 * ms) - 1);
}

}  // namespace
}  // namespace proleg::sim
