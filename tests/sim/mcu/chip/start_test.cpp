// From power on to the first output: clocks (docs/board.md), console, boot-up message, identity.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "shared/kernel/fingerprint.hpp"
#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

std::string boot_line(const std::string& who, const std::string& cause) {
  std::array<char, 16> core{};
  std::snprintf(core.data(), core.size(), "%08x", core_fingerprint);
  return "proleg module, " + who + ", board 1, core " + core.data() + ", started by " + cause + "\r\n";
}

const std::string without_node_id = "no node id, waits for LSS (docs/board.md)";

/// CRC-32 as in Ethernet, bit by bit.
std::uint32_t crc32(std::span<const std::uint32_t> words) {
  std::uint32_t crc = ~0U;
  for (const std::uint32_t word : words) {
    for (unsigned i = 0; i < 32; ++i) {
      const bool feedback = (((crc ^ (word >> i)) & 1U) != 0);
      crc = (crc >> 1U) ^ (feedback ? 0xEDB8'8320U : 0U);
    }
  }
  return ~crc;
}

TEST(ChipStart, TheConsolePrintsItsIdentityByteForByte) {
  ChipRig rig;
  rig.boot();
  EXPECT_EQ(rig.board.console, boot_line("node 3", "power on"));
  EXPECT_TRUE(rig.events.empty());
}

class Crystal : public testing::TestWithParam<std::int32_t> {
 protected:
  Crystal() {
    settings_.chip.crystal_parts_per_billion = GetParam();
    rig_.emplace(settings_);
  }
  /// The true time of a duration on the chip's clock.
  [[nodiscard]] static double truly(double duration) { return duration / (1.0 + GetParam() * 1e-9); }

  RigSettings settings_;
  std::optional<ChipRig> rig_;
};

TEST_P(Crystal, AByteOfTheConsoleTakesTheTimeOfItsDivider) {
  rig_->boot();
  // 42 MHz / 115,200 = 364.58, to nearest 365; start bit, 8 bits, stop bit.
  constexpr double byte_us = 10 * 365 / 42.0;
  const std::vector<BusTime>& times = rig_->board.byte_times;
  ASSERT_GT(times.size(), 60U);
  const auto bytes = static_cast<double>(times.size() - 1);
  EXPECT_NEAR(static_cast<double>(times.back() - times.front()) * 1e-3, truly(byte_us * bytes), 1.0);
}

TEST_P(Crystal, TheMicrosecondClockRunsAsFastAsTheCrystal) {
  rig_->boot();
  rig_->write(0x1017, 0, 2, 1'000);
  const BusTime start = rig_->bus.now();
  rig_->run_for(10'500 * ms);
  const std::vector<LoggedFrame> beats = rig_->frames(0x703, start);
  ASSERT_GE(beats.size(), 10U);
  const double seconds = static_cast<double>(beats[9].time - beats[1].time) * 1e-9;
  // A heartbeat is sent some microseconds after its deadline; 100 ppm of 8 s are 800 us. The first one had to wait for
  // the answer to the SDO.
  EXPECT_NEAR(seconds, truly(8.0), 10e-6);
}

TEST_P(Crystal, SendsAtOneMegabit) {
  rig_->boot();
  ASSERT_EQ(rig_->frames(0x703).size(), 1U);
  EXPECT_EQ(rig_->frames(0x703)[0].frame, (CanFrame{0x703, 1, {0}}));
  // 2 ms for the crystal, 0.2 for the PLL, then the delay of the module, 1 to 16 ms.
  EXPECT_GT(rig_->log[0].time, 3 * ms);
  EXPECT_LT(rig_->log[0].time, 20 * ms);
}

INSTANTIATE_TEST_SUITE_P(Errors, Crystal, testing::Values(0, 100'000, -100'000), [](const auto& error) {
  return error.param == 0 ? "exact" : error.param > 0 ? "fast" : "slow";
});

TEST(ChipStart, RejectsABusOfAnotherBitRate) {
  RigSettings settings;
  settings.bit_rate = 500'000;
  ChipRig rig(settings);
  rig.power_on();
  rig.run_for(20 * ms);
  ASSERT_EQ(rig.events.size(), 1U);
  EXPECT_EQ(rig.events[0].kind, ChipEvent::Kind::unmodelled);
  EXPECT_NE(rig.events[0].text.find("1000000"), std::string::npos) << rig.events[0].text;
}

TEST(ChipStart, ItsUniqueIdAndWhatFollowsFromItAreRead) {
  const RigSettings settings;
  ChipRig rig(settings);
  rig.boot();
  for (std::uint8_t i = 0; i < 3; ++i) {
    EXPECT_EQ(rig.read(0x2003, static_cast<std::uint8_t>(i + 1)), settings.chip.unique_id.at(i));
  }
  EXPECT_EQ(rig.read(0x1018, 4), crc32(settings.chip.unique_id));
  EXPECT_EQ(rig.read(0x1018, 2), 1U) << "board id";
  EXPECT_EQ(rig.read(0x2000, 3), core_fingerprint);
}

TEST(ChipStart, TwoModulesWithOneNodeIdBootAtDifferentTimes) {
  RigSettings other;
  other.chip.unique_id = {0x7654'3210, 0x1111'1111, 0x0BAD'CAFE};
  ChipRig one;
  ChipRig two(other);
  one.boot();
  two.boot();
  EXPECT_NE(one.log[0].time, two.log[0].time);
}

class NoRecord : public testing::Test {
 protected:
  NoRecord() : rig_(settings()) {}
  static RigSettings settings() {
    RigSettings settings;
    settings.record.reset();
    return settings;
  }
  ChipRig rig_;
};

TEST_F(NoRecord, IsReportedAndTheModuleAcknowledgesFramesInSilenceForSecondsAndFeedsItsWatchdog) {
  rig_.power_on();
  rig_.run_for(20 * ms);
  const std::uint64_t errors = rig_.bus.statistics().errors;
  for (unsigned i = 0; i < 50; ++i) {
    rig_.host.send({0x000, 2, {0x81, 0x00}});
    rig_.host.send({0x000, 2, {0x01, 0x00}});
    rig_.host.send({0x080, 1, {static_cast<std::uint8_t>(i + 1)}});
    rig_.host.send({0x600, 8, {0x40, 0x18, 0x10, 0x01}});
    rig_.run_for(100 * ms);
  }
  EXPECT_EQ(rig_.board.console, boot_line(without_node_id, "power on"));
  EXPECT_TRUE(rig_.events.empty()) << "no reset";
  EXPECT_EQ(rig_.log.size(), 4U * 50U) << "the frames of the host only";
  EXPECT_EQ(rig_.bus.statistics().errors, errors) << "each is acknowledged";
  EXPECT_FALSE(rig_.chip.pulse_time(1));
}

TEST_F(NoRecord, ARecordThatIsDamagedIsNone) {
  std::array<std::uint8_t, 32> record = firmware::encode({3, false, 0, 0}, 1);
  record[5] ^= 1U;
  rig_.chip.write(ChipRig::settings_address, record);
  rig_.power_on();
  rig_.run_for(50 * ms);
  EXPECT_EQ(rig_.board.console, boot_line(without_node_id, "power on"));
  EXPECT_TRUE(rig_.log.empty());
}

TEST(ChipStart, TwoRunsAreEqualInEveryInstructionFrameAndByte) {
  const auto run = [] {
    ChipRig rig;
    rig.start_robot(3'000);
    rig.enable_servo(1 << 29);
    rig.run_for(500 * ms);
    std::vector<std::uint64_t> all{rig.chip.instructions()};
    for (const LoggedFrame& logged : rig.log) {
      all.push_back(logged.time);
    }
    all.insert(all.end(), rig.board.byte_times.begin(), rig.board.byte_times.end());
    return all;
  };
  const std::vector<std::uint64_t> first = run();
  EXPECT_GT(first.size(), 150U);
  EXPECT_EQ(first, run());
}

}  // namespace
}  // namespace proleg::sim
