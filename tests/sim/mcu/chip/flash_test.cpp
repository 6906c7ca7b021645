// The log of board records in the chip's flash, written by the image driver_tests, also when its power fails; and the
// console under a flood. exhaustive_flash_test.cpp does more of it.

#include <array>
#include <random>
#include <sstream>
#include <vector>

#include "tests/sim/mcu/chip/driver_tests.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t erased_word = 0xFFFF'FFFF;
constexpr BusTime max_start = 20 * ms;
constexpr BusTime max_append = 1'000 * ms;  ///< with an erase

TEST_F(DriverTests, AppendAcrossAnEraseWithoutAFailure) {
  nearly_fill_log();
  rig_.power_on();
  ASSERT_TRUE(rig_.run_until_true([this] { return result().phase == appending; }, max_start));
  ASSERT_TRUE(rig_.run_until_true([this] { return result().appended >= 3; }, max_append));
  const Result found = result();
  EXPECT_EQ(found.phase, appending);
  EXPECT_EQ(found.found, confirmed_);
  EXPECT_EQ(found.failed, 0U) << found.last_failure;
  EXPECT_LT(found.max_append_us, 1'000'000U);
  EXPECT_GT(found.max_append_us, 200'000U) << "an erase";
  EXPECT_GT(found.deadlines, 10U);
  EXPECT_EQ(newest_node(), node_after(node_after(node_after(confirmed_))));
  EXPECT_TRUE(rig_.events.empty());
}

TEST_F(DriverTests, SendWholeLinesInOrderWhenTheConsoleIsFlooded) {
  rig_.power_on();
  rig_.run_for(200 * ms);
  std::istringstream lines(rig_.board.console);
  // 512 bytes of memory: the first lines fit in whole. A text of three pieces may lose some of them later.
  for (unsigned i = 0; i < 9; ++i) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(line, "line " + std::to_string(i) + " of a text that is too long for its way\r");
  }
  EXPECT_GE(rig_.board.console.size(), 512U - 40U);
}

/// Cuts at the first and the last instant of each phase and at random ones between: before a record is written into the
/// last place of a sector; while it is written; while the other sector is erased; while the first record there is
/// written.
TEST_F(DriverTests, APowerCutInEachPhaseLeavesTheLastRecordOrTheOneThatWasBeingWritten) {
  constexpr unsigned seed = 405;
  std::cout << "seed " << seed << '\n';
  nearly_fill_log();
  const BusTime start = rig_.bus.now();
  rig_.power_on();
  const auto time_when = [&](std::uint32_t address, bool is_erased) {
    EXPECT_TRUE(rig_.run_until_true([&] { return (rig_.word(address) == erased_word) == is_erased; }, max_append));
    return rig_.bus.now() - start;
  };
  constexpr std::uint32_t check_sum = firmware::BoardRecord::size - 4;  // is written last
  const std::string erase = "erase";
  struct Phase {
    std::string name;
    BusTime end;
    unsigned random_cuts;
  };
  const std::array<Phase, 4> phases{{{"start", time_when(last_place, false), 2},
                                     {"record", time_when(last_place + check_sum, false), 6},
                                     {erase, time_when(second_sector, true), 3},
                                     {"record after the erase", time_when(second_sector + check_sum, false), 4}}};

  std::mt19937 random(seed);
  unsigned new_records = 0;
  unsigned old_records = 0;
  unsigned torn_records = 0;
  unsigned torn_sectors = 0;
  BusTime begin = 0;
  for (const Phase& phase : phases) {
    std::vector<BusTime> cuts{begin, phase.end};
    for (unsigned i = 0; i < phase.random_cuts; ++i) {
      cuts.push_back(std::uniform_int_distribution<BusTime>(begin, phase.end)(random));
    }
    begin = phase.end;
    for (const BusTime time : cuts) {
      SCOPED_TRACE(phase.name + ": cut after " + std::to_string(time) + " ns");
      nearly_fill_log();
      rig_.power_on();
      const Cut cut = cut_power_after(time);
      (cut.has_new_record ? new_records : old_records) += 1;
      torn_records +=
          rig_.word(last_place) != erased_word && rig_.word(last_place + check_sum) == erased_word ? 1U : 0U;
      const std::uint32_t sequence = rig_.word(second_sector);
      torn_sectors += phase.name == erase && sequence != oldest_sequence && sequence != erased_word ? 1U : 0U;
      ASSERT_TRUE(rig_.run_until_true([this] { return result().phase == appending; }, max_start));
      EXPECT_EQ(result().found, confirmed_) << "the program continues with the record that the cut left";
    }
  }
  EXPECT_GT(new_records, 0U);
  EXPECT_GT(old_records, 0U);
  EXPECT_GT(torn_records, 0U);
  EXPECT_GT(torn_sectors, 0U);
  EXPECT_TRUE(rig_.events.empty());
}

}  // namespace
}  // namespace proleg::sim
