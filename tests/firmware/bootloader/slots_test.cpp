// Tests which image runs after a start, and that a module still has its program after a cut of the power at any
// operation.

#include "firmware/bootloader/slots.hpp"

#include <gtest/gtest.h>

#include "updated_module.hpp"

namespace proleg::bootloader {
namespace {

using namespace test;

TEST(SlotsTest, AnEmptyChipHasNothingToRun) {
  UpdatedModule module;
  EXPECT_EQ(module.slots.prepare_start(), StartResult::nothing);
  EXPECT_EQ(module.flash.operations, 0);
}

TEST(SlotsTest, TheFirstImageRunsOnTrialUntilItIsConfirmed) {
  UpdatedModule module;
  ASSERT_EQ(module.install(first), InstallResult::ok);
  EXPECT_EQ(module.slots.prepare_start(), StartResult::run_on_trial);
  EXPECT_TRUE(module.slots.confirm());
  EXPECT_TRUE(module.slots.confirm());
  for (int start = 0; start < 10; ++start) {
    EXPECT_EQ(module.slots.prepare_start(), StartResult::run);
  }
  EXPECT_EQ(module.slots.attempts(), 1U);
}

TEST(SlotsTest, AnImageThatIsThereAlreadyIsNotWrittenAgain) {
  UpdatedModule module;
  module.install_proven(first);
  const int operations = module.flash.operations;
  EXPECT_EQ(module.install(first), InstallResult::already_there);
  EXPECT_EQ(module.flash.operations, operations);
}

TEST(SlotsTest, AnImageThatIsNotConfirmedInThreeStartsGivesWayToTheOneBefore) {
  UpdatedModule module;
  module.install_proven(first);
  ASSERT_EQ(module.install(second), InstallResult::ok);
  for (unsigned attempt = 1; attempt <= Slots::max_attempts; ++attempt) {
    EXPECT_EQ(module.slots.prepare_start(), StartResult::run_on_trial);
    EXPECT_EQ(number_in(module.slots, FlashSlot::a), 2U);
  }
  EXPECT_EQ(module.slots.prepare_start(), StartResult::run) << "it has proven itself before";
  EXPECT_EQ(number_in(module.slots, FlashSlot::a), 1U);
}

TEST(SlotsTest, AFirstImageThatFailsIsNotStartedForEver) {
  UpdatedModule module;
  ASSERT_EQ(module.install(first), InstallResult::ok);
  for (unsigned attempt = 1; attempt <= Slots::max_attempts; ++attempt) {
    EXPECT_EQ(module.start(), 1U);
  }
  EXPECT_EQ(module.slots.prepare_start(), StartResult::nothing) << "the bootloader waits for another image";
  EXPECT_EQ(module.install(second), InstallResult::ok);
  EXPECT_EQ(module.start(), 2U);
}

TEST(SlotsTest, TheBackupIsTheLastImageThatHasProvenItself) {
  UpdatedModule module;
  module.install_proven(first);
  ASSERT_EQ(module.install(second), InstallResult::ok);
  EXPECT_EQ(module.start(), 2U);
  // The second image was never confirmed, so the third one does not replace the first one in slot B.
  ASSERT_EQ(module.install(third), InstallResult::ok);
  EXPECT_EQ(number_in(module.slots, FlashSlot::b), 1U);
  module.start();
  ASSERT_TRUE(module.slots.confirm());
  ASSERT_EQ(module.install(second), InstallResult::ok);
  EXPECT_EQ(number_in(module.slots, FlashSlot::b), 3U);
}

TEST(SlotsTest, ASlotWhoseEraseWasCutHoldsNothingEvenIfItReadsAsBefore) {
  UpdatedModule module;
  module.install_proven(first);
  module.install_proven(second);
  module.flash.erases_leave_all = true;
  // Slot A holds an image that slot B has not: first B is cleared and erased, then A.
  for (const auto& [slot, other] : {std::pair(FlashSlot::b, FlashSlot::a), std::pair(FlashSlot::a, FlashSlot::b)}) {
    UpdatedModule cut(module.flash);
    for (int operation = module.flash.operations; number_in(cut.slots, slot) != 0; ++operation) {
      cut.flash = module.flash;
      cut.flash.cut_at = operation;
      EXPECT_THROW(static_cast<void>(cut.install(third)), PowerCut);
    }
    EXPECT_NE(number_in(cut.slots, other), 0U);
    EXPECT_NE(cut.start(), 0U);
  }
}

TEST(SlotsTest, MayStartSaysWhetherSomethingWouldRun) {
  UpdatedModule module;
  EXPECT_FALSE(module.slots.may_start()) << "nothing there";
  ASSERT_EQ(module.install(first), InstallResult::ok);
  for (unsigned attempt = 1; attempt <= Slots::max_attempts; ++attempt) {
    EXPECT_TRUE(module.slots.may_start());
    EXPECT_EQ(module.start(), 1U);
  }
  EXPECT_FALSE(module.slots.may_start()) << "it has failed";
  module.install_proven(second);
  EXPECT_TRUE(module.slots.may_start());
}

TEST(SlotsTest, AnImageForAnotherBoardDoesNotRunEvenIfAProbeWroteIt) {
  UpdatedModule module;
  Image foreign = first;
  foreign.header.board_id = 2;
  ASSERT_EQ(module.install(foreign), InstallResult::ok);
  EXPECT_EQ(module.slots.prepare_start(), StartResult::nothing);
}

TEST(SlotsTest, ABitThatHasChangedInSlotABringsTheBackupBack) {
  UpdatedModule module;
  module.install_proven(first);
  module.install_proven(second);
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    SlotMemory damaged = module.flash;
    const std::size_t byte = random() % (image::header_size + second.body.size());
    damaged.slots[0].at(byte) ^= static_cast<std::uint8_t>(1U << random() % 8);
    Slots slots(damaged, place);
    EXPECT_EQ(slots.prepare_start(), StartResult::run);
    EXPECT_EQ(number_in(slots, FlashSlot::a), 1U) << "byte " << byte;
  }
}

}  // namespace
}  // namespace proleg::bootloader
