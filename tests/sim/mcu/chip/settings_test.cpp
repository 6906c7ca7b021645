// A chip without a node id gets one by LSS (CiA 305), and keeps its settings in its flash, as the flashed image does
// it.

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

CanFrame lss(std::uint8_t service, std::uint8_t first = 0) { return {0x7E5, 8, {service, first}}; }

class ChipSettingsTest : public testing::Test {
 protected:
  /// node: of the board record; 0: the flash is erased.
  void make(std::uint8_t node) {
    RigSettings settings;
    settings.record.reset();
    if (node != 0) {
      settings.record = firmware::BoardRecord{node, false, 0, 0};
    }
    rig.emplace(settings);
  }
  /// Fills the sectors of the log, so that the next record needs an erase.
  void fill_log(std::uint8_t node) {
    for (std::uint32_t i = 0; i < 1024; ++i) {
      // In the second sector, which counts, are the higher sequence numbers.
      rig->chip.write(ChipRig::settings_address + i * std::uint32_t{firmware::BoardRecord::size},
                      firmware::encode({node, false, 0, 0}, i + 1));
    }
  }
  void power_on() {
    rig->power_on();
    rig->run_for(50 * ms);
  }
  /// The first two bytes of the answer's data after the service.
  unsigned ask(const CanFrame& request, BusTime timeout = 5 * ms) {
    const BusTime start = rig->bus.now();
    rig->host.send(request);
    EXPECT_TRUE(rig->run_until_true([&] { return !rig->frames(0x7E4, start).empty(); }, timeout));
    const auto answers = rig->frames(0x7E4, start);
    return answers.empty() ? ~0U : answers[0].frame.data[1] | unsigned{answers[0].frame.data[2]} << 8U;
  }
  [[nodiscard]] std::optional<firmware::BoardRecord> in_flash() const {
    const auto bytes = rig->memory(ChipRig::settings_address, ChipRig::settings_size);
    return firmware::newest(bytes, {});
  }

  std::optional<ChipRig> rig;
};

TEST_F(ChipSettingsTest, AFreshChipBootsWithTheNodeIdThatLssHasGivenIt) {
  make(0);
  power_on();
  rig->host.send(lss(0x04, 1));
  EXPECT_EQ(ask(lss(0x11, 3)), 0U);
  EXPECT_EQ(ask(lss(0x17)), 0U) << "store";
  rig->host.send(lss(0x04, 0));
  rig->run_for(50 * ms);
  ASSERT_EQ(rig->frames(0x703).size(), 1U) << "boot-up";
  EXPECT_EQ(rig->read(0x1014, 0), 0x83U) << "its filters pass SDO of the new node id";
  EXPECT_EQ(in_flash(), (firmware::BoardRecord{3, false, 0, 0}));
  power_on();
  EXPECT_EQ(rig->frames(0x703).size(), 2U);
  EXPECT_NE(rig->board.console.find("no node id"), std::string::npos);
  EXPECT_NE(rig->board.console.find("node 3,"), std::string::npos);
  EXPECT_TRUE(rig->events.empty());
}

TEST_F(ChipSettingsTest, AnotherNodeIdHasOtherFilters) {
  make(9);
  power_on();
  rig->host.send(lss(0x04, 1));
  EXPECT_EQ(ask(lss(0x11, 3)), 0U);
  rig->host.send({0x000, 2, {0x82, 9}});
  rig->run_for(50 * ms);
  EXPECT_EQ(rig->frames(0x703).size(), 1U);
  EXPECT_EQ(rig->read(0x1014, 0), 0x83U);
  const auto instructions_of = [this](bool with_frames) {
    const std::uint64_t before = rig->chip.instructions();
    for (unsigned i = 0; i < 100; ++i) {
      if (with_frames) {
        rig->host.send({0x609, 8, {0x40, 0x14, 0x10}});
      }
      rig->run_for(ms);
    }
    return rig->chip.instructions() - before;
  };
  const std::uint64_t idle = instructions_of(false);
  EXPECT_LT(instructions_of(true), idle + 1'000U) << "each of 100 SDOs of the old node id is discarded";
}

TEST_F(ChipSettingsTest, StoringANodeIdErasesAFullLogWithoutAReset) {
  make(9);
  fill_log(9);
  power_on();
  rig->host.send(lss(0x04, 1));
  EXPECT_EQ(ask(lss(0x11, 10)), 0U);
  const BusTime start = rig->bus.now();
  EXPECT_EQ(ask(lss(0x17), 1'000 * ms), 0U);
  EXPECT_GT(rig->bus.now() - start, 200 * ms) << "an erase, during which the watchdog is fed";
  EXPECT_LT(rig->bus.now() - start, 600 * ms);
  EXPECT_TRUE(rig->events.empty());
  power_on();
  EXPECT_EQ(rig->frames(0x70A).size(), 1U);
}

TEST_F(ChipSettingsTest, SavesItsParametersAndKeepsThemOverARestart) {
  make(ChipRig::node);
  fill_log(ChipRig::node);
  power_on();
  rig->write(0x200A, 1, 2, 1234);
  rig->write(0x2020, 2, 1, 1);
  rig->write(0x2020, 3, 2, 0);
  rig->write(0x2020, 4, 2, 4095);
  const BusTime start = rig->bus.now();
  rig->host.send({0x603, 8, {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'}});
  ASSERT_TRUE(rig->run_until_true([&] { return !rig->frames(0x583, start).empty(); }));
  EXPECT_EQ(rig->frames(0x583, start)[0].frame.data[0], 0x60) << "written";
  EXPECT_GT(rig->bus.now() - start, 200 * ms) << "an erase";
  EXPECT_TRUE(rig->events.empty());
  rig->board.uv[11] = 3'300'000 / 4 * 3;  // 3/4 of the potentiometer: 45 degrees
  power_on();
  EXPECT_EQ(rig->read(0x200A, 1), 1234U);
  EXPECT_EQ(rig->read(0x2000, 5), 1U) << "it measures the angle";
  rig->run_for(50 * ms);
  EXPECT_NEAR(static_cast<std::int32_t>(rig->read(0x6064, 0)), 1 << 29, 1 << 20);
  // A reset by NMT is enough for what was saved.
  rig->write(0x2020, 2, 1, 0);
  rig->write(0x1010, 1, 4, 0x65766173);
  rig->host.send({0x000, 2, {0x81, 3}});
  rig->run_for(50 * ms);
  EXPECT_EQ(rig->read(0x2000, 5), 0U);
  EXPECT_EQ(rig->read(0x6064, 0), 0x80000000U) << "not measured";
}

TEST_F(ChipSettingsTest, AWeakCellOfTheFlashIsNoticedAndTheRecordBeforeStays) {
  make(ChipRig::node);
  power_on();
  rig->write(0x200A, 1, 2, 1234);
  // The second word of the next record; the first record is at the beginning of the log.
  rig->chip.set_weak_word(ChipRig::settings_address + firmware::BoardRecord::size + 4, 0xFFFF'FFFF);
  const BusTime start = rig->bus.now();
  rig->host.send({0x603, 8, {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'}});
  ASSERT_TRUE(rig->run_until_true([&] { return !rig->frames(0x583, start).empty(); }));
  EXPECT_EQ(rig->frames(0x583, start)[0].frame.data[0], 0x80) << "aborted";
  EXPECT_TRUE(rig->events.empty());
  power_on();
  EXPECT_EQ(rig->frames(0x703).size(), 2U) << "its node id";
  EXPECT_NE(rig->read(0x200A, 1), 1234U);
}

/// Cuts while the log is searched, while a record is written and while a sector is erased.
TEST_F(ChipSettingsTest, APowerCutAtAnyInstantOfASaveLeavesTheOldSettingsOrTheNew) {
  constexpr unsigned seed = 2020;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  constexpr std::uint32_t old_limit = 2000;
  constexpr std::uint32_t new_limit = 1234;
  unsigned old_ones = 0;
  unsigned new_ones = 0;
  for (const bool needs_erase : {false, true}) {
    make(ChipRig::node);
    const auto prepare = [&] {
      if (needs_erase) {
        fill_log(ChipRig::node);
      } else {
        rig->chip.write(ChipRig::settings_address, std::vector<std::uint8_t>(ChipRig::settings_size, 0xFF));
        rig->chip.write(ChipRig::settings_address, firmware::encode({ChipRig::node, false, 0, 0}, 1));
      }
      power_on();
      rig->write(0x200A, 1, 2, new_limit);
    };
    const auto request_save = [&] {
      rig->host.send({0x603, 8, {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'}});
      return rig->bus.now();
    };
    prepare();
    const BusTime start = request_save();
    ASSERT_TRUE(rig->run_until_true([&] { return !rig->frames(0x583, start).empty(); }));
    const BusTime duration = rig->bus.now() - start;
    for (unsigned cut = 0; cut < 20; ++cut) {
      prepare();
      request_save();
      // The record is written at the end.
      rig->run_for(cut % 2 == 0 ? std::uniform_int_distribution<BusTime>(0, duration)(random)
                                : duration - std::uniform_int_distribution<BusTime>(0, 400 * us)(random));
      power_on();
      const std::uint32_t found = rig->read(0x200A, 1);
      ASSERT_TRUE(found == old_limit || found == new_limit) << found;
      (found == old_limit ? old_ones : new_ones) += 1;
    }
  }
  EXPECT_GT(old_ones, 0U);
  EXPECT_GT(new_ones, 0U);
  EXPECT_TRUE(rig->events.empty());
}

}  // namespace
}  // namespace proleg::sim
