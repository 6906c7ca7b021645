// The log of board records in the chip's flash, for seconds and through hundreds of power cuts. flash_test.cpp has a
// sample of the same.

#include <random>

#include "tests/sim/mcu/chip/driver_tests.hpp"

namespace proleg::sim {
namespace {

TEST_F(DriverTests, RunForSecondsWithoutAFailure) {
  rig_.power_on();
  rig_.run_for(3'000 * ms);
  // To the end of an append: in the middle of one the newest record may be there and not be counted yet.
  const std::uint32_t before = result().appended;
  ASSERT_TRUE(rig_.run_until_true([&] { return result().appended > before; }, 1'000 * ms));
  const Result found = result();
  EXPECT_EQ(found.phase, appending);
  EXPECT_EQ(found.found, 0U);
  EXPECT_EQ(found.failed, 0U) << found.last_failure;
  EXPECT_GT(found.appended, 512U) << "16 KiB of 32 bytes: more than a sector";
  EXPECT_LT(found.max_append_us, 1'000'000U);
  EXPECT_GT(found.max_append_us, 200'000U) << "an erase";
  EXPECT_GT(found.deadlines, 1'000U);
  EXPECT_EQ(newest_node(), found.appended % 126 == 0 ? 126 : found.appended % 126);
  EXPECT_TRUE(rig_.events.empty());
}

TEST_F(DriverTests, APowerCutAtAnyInstantLeavesTheLastRecordOrTheOneThatWasBeingWritten) {
  constexpr unsigned seed = 405;
  constexpr unsigned cuts = 200;
  std::mt19937 random(seed);
  unsigned cuts_while_appending = 0;
  unsigned new_records = 0;
  unsigned erases = 0;
  rig_.power_on();
  for (unsigned i = 0; i < cuts; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", cut " + std::to_string(i));
    // Most come soon after the start, some late enough for an erase to end.
    const BusTime max_time = i % 8 == 0 ? 600 * ms : 20 * ms;
    const Cut cut = cut_power_after(std::uniform_int_distribution<BusTime>(2 * ms, max_time)(random));
    cuts_while_appending += cut.was_appending ? 1 : 0;
    new_records += cut.has_new_record ? 1 : 0;
    erases += cut.had_erased ? 1 : 0;
  }
  EXPECT_GT(cuts_while_appending, cuts / 2);
  EXPECT_GT(new_records, 0U);
  EXPECT_GT(erases, 0U);
  EXPECT_TRUE(rig_.events.empty());
  std::cout << "cuts while appending: " << cuts_while_appending << "; the new record was complete in " << new_records
            << "; runs with an erase: " << erases << '\n';
}

}  // namespace
}  // namespace proleg::sim
