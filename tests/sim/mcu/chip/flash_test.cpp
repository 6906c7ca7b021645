// The log of board records in the chip's flash, written by the image driver_tests, whose power fails at any instant;
// and the console under a flood.

#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "chip_rig.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t appending = 4;  ///< Phase of driver_tests.cpp

/// driver_test_result, as driver_tests.cpp declares it.
struct Result {
  std::uint32_t phase, found, appended, failed, last_failure, longest_us, deadlines;
};

class DriverTests : public testing::Test {
 protected:
  DriverTests() : rig_(settings()), result_(image("driver_tests").elf().symbol("driver_test_result").address) {}
  static RigSettings settings() {
    RigSettings settings;
    settings.image = "driver_tests";
    settings.record.reset();
    return settings;
  }
  [[nodiscard]] Result result() const {
    const auto word = [this](unsigned i) { return rig_.word(result_ + 4 * i); };
    return {word(0), word(1), word(2), word(3), word(4), word(5), word(6)};
  }
  [[nodiscard]] unsigned newest_node() const {
    const std::vector<std::uint8_t> log = rig_.memory(ChipRig::settings_address, ChipRig::settings_size);
    const std::span<const std::uint8_t> all(log);
    const auto record = firmware::newest(all.first(all.size() / 2), all.subspan(all.size() / 2));
    return record ? record->node : 0U;
  }

  ChipRig rig_;
  std::uint32_t result_;
};

TEST_F(DriverTests, RunForSecondsWithoutAFailure) {
  rig_.power_on();
  rig_.run_for(3'000 * ms);
  const Result found = result();
  EXPECT_EQ(found.phase, appending);
  EXPECT_EQ(found.found, 0U);
  EXPECT_EQ(found.failed, 0U) << found.last_failure;
  EXPECT_GT(found.appended, 512U) << "16 KiB of 32 bytes: more than a sector";
  EXPECT_LT(found.longest_us, 1'000'000U);
  EXPECT_GT(found.longest_us, 200'000U) << "an erase";
  EXPECT_GT(found.deadlines, 1'000U);
  EXPECT_EQ(newest_node(), found.appended % 126 == 0 ? 126 : found.appended % 126);
  EXPECT_TRUE(rig_.events.empty());
}

TEST_F(DriverTests, OfAFloodTheConsoleSendsWholeLinesInOrder) {
  rig_.power_on();
  rig_.run_for(200 * ms);
  std::istringstream lines(rig_.board.console);
  // 512 bytes of memory: the first lines find room as a whole. A text of three pieces may lose some of them later.
  for (unsigned i = 0; i < 9; ++i) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(line, "line " + std::to_string(i) + " of a text that is too long for its way\r");
  }
  EXPECT_GE(rig_.board.console.size(), 512U - 40U);
}

TEST_F(DriverTests, APowerCutAtAnyInstantLeavesTheLastRecordOrTheOneThatWasBeingWritten) {
  constexpr unsigned seed = 405;
  constexpr unsigned cuts = 200;
  std::mt19937 random(seed);
  unsigned cut_before_the_end = 0;
  unsigned new_ones = 0;
  unsigned erases = 0;
  rig_.power_on();
  unsigned confirmed = 0;
  for (unsigned cut = 0; cut < cuts; ++cut) {
    // Most soon after the start; some late enough for an erase to end.
    const BusTime longest = cut % 8 == 0 ? 600 * ms : 20 * ms;
    rig_.run_for(std::uniform_int_distribution<BusTime>(2 * ms, longest)(random));
    const Result before = result();
    if (before.phase == appending) {
      EXPECT_EQ(before.found, confirmed) << "seed " << seed << ", cut " << cut;
      EXPECT_EQ(before.failed, 0U) << "seed " << seed << ", cut " << cut;
      confirmed = before.appended == 0 ? before.found : (before.found + before.appended - 1) % 126 + 1;
      erases += before.longest_us > 200'000 ? 1 : 0;
      ++cut_before_the_end;
    }
    rig_.power_on();
    const unsigned found = newest_node();
    EXPECT_TRUE(found == confirmed || found == confirmed % 126 + 1)
        << "seed " << seed << ", cut " << cut << ": found " << found << ", expected " << confirmed << " or the next";
    new_ones += found != confirmed ? 1 : 0;
    confirmed = found;
  }
  EXPECT_GT(cut_before_the_end, cuts / 2);
  EXPECT_GT(new_ones, 0U);
  EXPECT_GT(erases, 0U);
  EXPECT_TRUE(rig_.events.empty());
  std::cout << "cuts while appending: " << cut_before_the_end << ", of which the new record was whole: " << new_ones
            << ", runs with an erase: " << erases << '\n';
}

}  // namespace
}  // namespace proleg::sim
