// What the bootloader does after a reset, depending on what the start before has left.

#include "firmware/bootloader/handover.hpp"

#include <gtest/gtest.h>

#include "updated_module.hpp"

namespace proleg::bootloader {
namespace {

using namespace test;

TEST(Handover, AConfirmedProgramStartsAndOneOnTrialOnlyWhenItsTrialWasCounted) {
  UpdatedModule module;
  EXPECT_EQ(next_step(module.slots, {}), NextStep::prepare) << "no program";
  EXPECT_EQ(next_step(module.slots, {HandoverAction::start, 0}), NextStep::prepare) << "no program";
  ASSERT_EQ(module.install(first), InstallResult::ok);
  EXPECT_EQ(next_step(module.slots, {}), NextStep::prepare);
  EXPECT_EQ(next_step(module.slots, {HandoverAction::start, 0}), NextStep::start_program);
  ASSERT_TRUE(module.slots.confirm());
  for (const HandoverAction left : {HandoverAction::none, HandoverAction::start, HandoverAction::runs,
                                    HandoverAction::started, HandoverAction::pin_seen}) {
    EXPECT_EQ(next_step(module.slots, {left, 0}), NextStep::start_program);
  }
}

TEST(Handover, TheBootloaderStaysIfItIsAskedTo) {
  UpdatedModule module;
  module.install_proven(first);
  EXPECT_EQ(next_step(module.slots, {HandoverAction::stay, 0}), NextStep::serve_bus);
  EXPECT_EQ(next_step(module.slots, {HandoverAction::install, 0}), NextStep::serve_bus);
}

TEST(Handover, AProgramThatStopsFiveTimesInARowBeforeItRunsWellIsGivenUp) {
  UpdatedModule module;
  module.install_proven(first);
  Handover left;
  for (unsigned start = 1; start <= max_bad_starts; ++start) {
    ASSERT_EQ(next_step(module.slots, left), NextStep::start_program) << start;
    left = started_after(left);
    EXPECT_EQ(left.argument, start);
  }
  EXPECT_EQ(next_step(module.slots, left), NextStep::serve_bus);
  EXPECT_TRUE(starts_badly(left));
  EXPECT_EQ(started_after({HandoverAction::runs, 0}).argument, 1U) << "it has run well meanwhile";
}

TEST(Handover, TheWindowAfterPowerOnKeepsTheDecisionAndTheCountOfBadStarts) {
  for (const std::uint32_t bad_starts : {0U, 1U, max_bad_starts}) {
    for (const bool starts_program : {false, true}) {
      const Handover left = left_by_window({HandoverAction::started, bad_starts}, starts_program);
      EXPECT_EQ(left.action, HandoverAction::window_over);
      EXPECT_EQ(WindowEnd::of(left.argument).starts_program, starts_program);
      EXPECT_EQ(started_after(left_before_window(left)).argument, bad_starts + 1);
    }
  }
  const Handover left = left_by_window({HandoverAction::runs, 7}, true);
  EXPECT_EQ(started_after(left_before_window(left)).argument, 1U) << "it has run well before";
}

TEST(Handover, AnImageInRamKeepsItsSizeItsSessionAndWhereItsHostIs) {
  for (const ImageInRam image : {ImageInRam{0, 0, false}, ImageInRam{65'536, 255, true}, ImageInRam{90'112, 1, false},
                                 ImageInRam{40, 7, false, true}, ImageInRam{0x3F'FFFF, 128, true, true}}) {
    const ImageInRam read = ImageInRam::of(image.argument());
    EXPECT_EQ(read.size, image.size);
    EXPECT_EQ(read.session, image.session);
    EXPECT_EQ(read.ends_line, image.ends_line);
    EXPECT_EQ(read.may_be_key, image.may_be_key);
  }
}

}  // namespace
}  // namespace proleg::bootloader
