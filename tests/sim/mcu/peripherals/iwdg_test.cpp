#include "sim/mcu/peripherals/iwdg.hpp"

#include <random>
#include <stdexcept>

#include "support/bench.hpp"

namespace proleg::sim {
namespace {

class IwdgTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kr = 0x00;
  static constexpr std::uint32_t pr = 0x04;
  static constexpr std::uint32_t rlr = 0x08;
  static constexpr std::uint32_t sr = 0x0C;
  static constexpr LocalTime lsi = 31'500;  ///< local time in a cycle of 32 kHz
  static constexpr LocalTime ms = 1000 * local_time_per_us;

  /// Started, with these settings in effect, and reloaded now.
  void start(std::uint32_t prescaler, std::uint32_t reload) {
    dog.write(kr, 0xCCCC);
    dog.write(kr, 0x5555);
    dog.write(pr, prescaler);
    dog.write(rlr, reload);
    chip.run_until(chip.time + 5 * lsi, dog);
    EXPECT_EQ(dog.read(sr), 0U);
    dog.write(kr, 0xAAAA);
  }

  test::BenchChip chip;
  Iwdg dog{chip};
};

// RM0090 rev 21, 21.4.
TEST_F(IwdgTest, ResetValuesAreThoseOfTheManual) {
  start(3, 0x123);
  dog.reset();
  test::expect_values(dog, {{kr, 0}, {pr, 0}, {rlr, 0xFFF}, {sr, 0}});
  EXPECT_EQ(dog.next_event(), never_on_chip);
}

// RM0090 rev 21, table 108; PR = 7 is the same as 6 (21.4.2).
TEST_F(IwdgTest, TimeoutsAreThoseOfTheTable) {
  const std::vector<std::pair<double, double>> table = {{0.125, 512}, {0.25, 1024}, {0.5, 2048}, {1, 4096},
                                                        {2, 8192},    {4, 16384},   {8, 32768},  {8, 32768}};
  for (std::uint32_t prescaler = 0; prescaler < table.size(); ++prescaler) {
    for (const auto& [reload, milliseconds] :
         {std::pair{0U, table[prescaler].first}, std::pair{0xFFFU, table[prescaler].second}}) {
      dog.reset();
      chip.resets.clear();
      start(prescaler, reload);
      const LocalTime due = chip.time + static_cast<LocalTime>(milliseconds * static_cast<double>(ms));
      EXPECT_EQ(dog.next_event(), due) << prescaler;
      chip.run_until(due - 1, dog);
      EXPECT_TRUE(chip.resets.empty());
      chip.run_until(due + 10 * ms, dog);
      ASSERT_EQ(chip.resets.size(), 1U);
      EXPECT_EQ(chip.resets[0], std::pair(due, ResetCause::independent_watchdog));
    }
  }
}

TEST_F(IwdgTest, StartsWithTheLongestCountOfTheShortestPrescaler) {
  dog.write(kr, 0xCCCC);
  EXPECT_TRUE(dog.is_running());
  EXPECT_EQ(dog.next_event(), 512 * ms);
}

TEST_F(IwdgTest, AReloadRestartsTheCount) {
  start(4, 99);  // 200 ms
  for (int i = 0; i < 20; ++i) {
    chip.run_until(chip.time + 199 * ms, dog);
    dog.write(kr, 0xAAAA);
  }
  EXPECT_TRUE(chip.resets.empty());
  chip.run_until(chip.time + 200 * ms, dog);
  EXPECT_EQ(chip.resets.size(), 1U);
}

TEST_F(IwdgTest, AChangeOfThePrescalerKeepsTheCount) {
  dog.write(kr, 0xCCCC);
  chip.run_until(100 * ms, dog);  // 800 of 4096 counts
  dog.write(kr, 0x5555);
  dog.write(pr, 1);
  chip.run_until(100 * ms + 5 * lsi, dog);
  // One more count passed during the update.
  EXPECT_EQ(dog.next_event(), 100 * ms + 5 * lsi + (4096 - 801) * 8 * lsi);
}

TEST_F(IwdgTest, AnUpdateTakesFiveCyclesOfLsi) {
  dog.write(kr, 0xCCCC);
  dog.write(kr, 0x5555);
  dog.write(pr, 2);
  chip.time += 2 * lsi;
  dog.write(rlr, 7);
  EXPECT_EQ(dog.read(sr), 3U);
  chip.run_until(5 * lsi - 1, dog);
  EXPECT_EQ(dog.read(sr), 3U);
  EXPECT_EQ(dog.read(pr), 0U);
  chip.run_until(5 * lsi, dog);
  EXPECT_EQ(dog.read(sr), 2U);
  EXPECT_EQ(dog.read(pr), 2U);
  chip.run_until(7 * lsi, dog);
  EXPECT_EQ(dog.read(sr), 0U);
  EXPECT_EQ(dog.read(rlr), 7U);
}

TEST_F(IwdgTest, AnUpdateWaitsForLsi) {
  dog.write(kr, 0x5555);
  dog.write(rlr, 7);
  chip.run_until(1000 * ms, dog);
  EXPECT_EQ(dog.read(sr), 2U);
  dog.lsi_switched(true);
  chip.run_until(chip.time + 5 * lsi, dog);
  EXPECT_EQ(dog.read(sr), 0U);
  EXPECT_EQ(dog.read(rlr), 7U);
}

TEST_F(IwdgTest, FollowsTheFrequencyOfItsOscillator) {
  for (const std::uint32_t hz : {17'000U, 33'333U, 47'000U}) {
    Iwdg other(chip, hz);
    chip.time = 0;
    other.write(kr, 0xCCCC);
    const double expected = 4096.0 * 4 / hz * 1e6 * 1008;
    EXPECT_NEAR(static_cast<double>(other.next_event()), expected, 1) << hz;
  }
  EXPECT_THROW(Iwdg(chip, 16'999), std::invalid_argument);
  EXPECT_THROW(Iwdg(chip, 47'001), std::invalid_argument);
}

TEST_F(IwdgTest, RejectsProtectedWritesByName) {
  EXPECT_EQ(test::rejection([&] { dog.write(pr, 3); }),
            "IWDG_PR = 0x3 at offset 0x4: write-protected: IWDG_KR = 0x5555 comes first");
  dog.write(kr, 0x5555);
  dog.write(kr, 0xAAAA);
  EXPECT_NE(test::rejection([&] { dog.write(rlr, 3); }), "");
  dog.write(kr, 0x5555);
  dog.write(rlr, 3);
  EXPECT_EQ(test::rejection([&] { dog.write(rlr, 4); }),
            "IWDG_RLR = 0x4 at offset 0x8: the update before is not over (IWDG_SR)");
}

}  // namespace
}  // namespace proleg::sim
