// What is wrong with a module, from what it says of itself, and what can be done about it.

#include "host/flash/module_fault.hpp"

#include <gtest/gtest.h>

namespace proleg::test {
namespace {

using host::FlashCandidate;
using host::ModuleFault;
using host::ModuleFaultKind;
using host::RecoveryMeans;
using host::Remedy;
namespace flag = broadcast::module_flag;

constexpr unsigned good_flags = flag::runs_program | flag::has_image | flag::is_confirmed | flag::has_bootloader;

image::Header image_of(std::uint16_t minor, std::uint8_t schema = 2, std::uint16_t board = 1) {
  image::Header header;
  header.board_id = board;
  header.highest_revision = 0xFF;
  header.version = {0, minor, 0};
  header.settings_schema = schema;
  return header;
}

/// Of version 0.1.0, unless its flags say that there is no image.
FlashCandidate module_with(unsigned flags, std::uint8_t node = 3, std::uint32_t serial = 0x1234) {
  FlashCandidate module{{serial, true, {}, {}}, node, 1, true};
  module.program.status.condition = {static_cast<std::uint8_t>(flags), node};
  if ((flags & flag::has_image) != 0) {
    module.program.image = image_of(1);
  }
  return module;
}

class ModuleFaultTest : public testing::Test {
 protected:
  /// Of the first module on the bus.
  std::vector<ModuleFault> find(const std::vector<FlashCandidate>& all) {
    return find_module_faults(all.front(), all, means);
  }
  /// The only one of a module that is alone.
  ModuleFault of(const FlashCandidate& module) {
    const std::vector<ModuleFault> found = find({module});
    EXPECT_EQ(found.size(), 1U);
    return found.empty() ? ModuleFault{} : found.front();
  }
  void expect(const FlashCandidate& module, ModuleFaultKind kind, Remedy remedy) {
    const ModuleFault found = of(module);
    EXPECT_EQ(code_of(found.kind), code_of(kind));
    EXPECT_EQ(found.remedy, remedy) << found.to_do;
    EXPECT_FALSE(found.text.empty());
    EXPECT_FALSE(found.to_do.empty());
  }

  const image::Header image = image_of(2);
  RecoveryMeans means;
};

TEST_F(ModuleFaultTest, AModuleThatRunsAConfirmedProgramIsWell) {
  EXPECT_TRUE(find({module_with(good_flags)}).empty());
  EXPECT_TRUE(find({module_with(good_flags | flag::is_gateway)}).empty());
  means.image = &image;
  means.resets_settings = true;
  EXPECT_TRUE(find({module_with(good_flags), module_with(good_flags, 4, 0x1235)}).empty());
}

TEST_F(ModuleFaultTest, WithoutAProgramItNeedsAnImage) {
  const FlashCandidate empty = module_with(flag::has_bootloader);
  expect(empty, ModuleFaultKind::no_program, Remedy::by_hand);
  EXPECT_NE(of(empty).to_do.find("proleg recover IMAGE.pimg"), std::string::npos);
  means.image = &image;
  expect(empty, ModuleFaultKind::no_program, Remedy::flash);
  EXPECT_NE(of(empty).to_do.find("0.2.0"), std::string::npos);
}

TEST_F(ModuleFaultTest, AProgramThatWasGivenUpNeedsAnotherOneEvenIfThatIsOlder) {
  const FlashCandidate given_up =
      module_with(flag::has_bootloader | flag::has_image | flag::is_confirmed | flag::starts_badly);
  expect(given_up, ModuleFaultKind::starts_badly, Remedy::by_hand);
  for (const image::Header& other : {image_of(2), image_of(0)}) {
    means.image = &other;
    expect(given_up, ModuleFaultKind::starts_badly, Remedy::flash);
  }
  const image::Header same = image_of(1);
  means.image = &same;
  expect(given_up, ModuleFaultKind::starts_badly, Remedy::by_hand);
  EXPECT_NE(of(given_up).to_do.find("another one"), std::string::npos) << "the same would not start either";
}

TEST_F(ModuleFaultTest, AProgramThatMayStartIsStartedBeforeAnythingIsFlashed) {
  for (const unsigned confirmed : {0U, unsigned{flag::is_confirmed}}) {
    const FlashCandidate waiting = module_with(flag::has_bootloader | flag::has_image | confirmed);
    const ModuleFaultKind kind = confirmed != 0 ? ModuleFaultKind::in_bootloader : ModuleFaultKind::never_confirmed;
    means = {};
    expect(waiting, kind, Remedy::start);
    means.image = &image;
    expect(waiting, kind, Remedy::start);
    means.has_tried_start = true;
    expect(waiting, kind, Remedy::flash);
    means.image = nullptr;
    expect(waiting, kind, Remedy::by_hand);
  }
}

TEST_F(ModuleFaultTest, AProgramThatWasSilentIsReplacedAndNotStarted) {
  means.was_silent = true;
  const FlashCandidate held = module_with(flag::has_bootloader | flag::has_image | flag::is_confirmed);
  expect(held, ModuleFaultKind::silent_program, Remedy::by_hand);
  means.image = &image;
  expect(held, ModuleFaultKind::silent_program, Remedy::flash);
  EXPECT_TRUE(find({module_with(good_flags)}).empty()) << "it answers now";
  expect(module_with(flag::has_bootloader | flag::has_image), ModuleFaultKind::never_confirmed, Remedy::start);
}

TEST_F(ModuleFaultTest, AProgramOnTrialThatRunsGetsTimeToConfirmItself) {
  expect(module_with(flag::has_bootloader | flag::has_image | flag::runs_program), ModuleFaultKind::never_confirmed,
         Remedy::start);
}

TEST_F(ModuleFaultTest, AnUnconfirmedProgramMayBeSentAgain) {
  const image::Header same = image_of(1);
  means.image = &same;
  means.has_tried_start = true;
  expect(module_with(flag::has_bootloader | flag::has_image), ModuleFaultKind::never_confirmed, Remedy::flash);
}

TEST_F(ModuleFaultTest, WithoutABootloaderOrAnAnswerItNeedsAProbe) {
  means.image = &image;
  const FlashCandidate without = module_with(good_flags & ~unsigned{flag::has_bootloader});
  expect(without, ModuleFaultKind::no_bootloader, Remedy::by_hand);
  FlashCandidate old = module_with(0);
  old.program = {0x1234, false, {}, {}};
  expect(old, ModuleFaultKind::no_update_protocol, Remedy::by_hand);
  for (const FlashCandidate& module : {without, old}) {
    EXPECT_NE(of(module).to_do.find("proleg flash --bare"), std::string::npos);
  }
}

TEST_F(ModuleFaultTest, AnImageForAnotherBoardIsNotFlashed) {
  const image::Header other = image_of(2, 2, 7);
  means.image = &other;
  const FlashCandidate empty = module_with(flag::has_bootloader);
  expect(empty, ModuleFaultKind::no_program, Remedy::by_hand);
  EXPECT_NE(of(empty).to_do.find("board 7"), std::string::npos) << of(empty).to_do;
  EXPECT_NE(of(empty).to_do.find("'proleg flash'"), std::string::npos) << "which can send it anyway";
}

TEST_F(ModuleFaultTest, WithoutANodeIdItGetsAFreeOne) {
  expect(module_with(good_flags, 0), ModuleFaultKind::no_node_id, Remedy::number);
  EXPECT_EQ(find({module_with(good_flags, 0), module_with(good_flags, 0, 0x99)}).size(), 1U)
      << "two without one have nothing in common";
}

TEST_F(ModuleFaultTest, OfModulesWithOneNodeIdOneKeepsIt) {
  const FlashCandidate low = module_with(good_flags, 3, 10);
  const FlashCandidate high = module_with(good_flags, 3, 20);
  const FlashCandidate other = module_with(good_flags, 4, 5);
  const auto remedy_of = [this](std::vector<FlashCandidate> all) {
    const std::vector<ModuleFault> found = find(all);
    EXPECT_EQ(code_of(found.back().kind), code_of(ModuleFaultKind::duplicate_node_id));
    return found.back().remedy;
  };
  EXPECT_EQ(remedy_of({low, high, other}), Remedy::keep_number);
  EXPECT_EQ(remedy_of({high, low, other}), Remedy::renumber);
  EXPECT_TRUE(find({other, low, high}).empty());
  const FlashCandidate empty = module_with(flag::has_bootloader, 3, 1);
  EXPECT_EQ(remedy_of({empty, low, high}), Remedy::renumber) << "one that runs has priority";
  EXPECT_EQ(remedy_of({low, empty, high}), Remedy::keep_number);
}

TEST_F(ModuleFaultTest, AStoppedModuleIsRestartedOnceItHasItsNodeIdAlone) {
  FlashCandidate stopped = module_with(good_flags);
  stopped.serves_objects = false;
  expect(stopped, ModuleFaultKind::stopped, Remedy::restart);
  FlashCandidate other = module_with(good_flags, 3, 0x99);
  other.serves_objects = false;
  const std::vector<ModuleFault> found = find({stopped, other});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(code_of(found.front().kind), code_of(ModuleFaultKind::duplicate_node_id)) << "which explains it";
}

TEST_F(ModuleFaultTest, NewerSettingsNeedAProgramWithAHigherSchemaOrAreReset) {
  const FlashCandidate newer = module_with(good_flags | flag::has_newer_settings);
  const image::Header higher = image_of(2, 3);
  expect(newer, ModuleFaultKind::newer_settings, Remedy::by_hand);
  EXPECT_NE(of(newer).to_do.find("--reset-settings"), std::string::npos);
  means.image = &higher;
  expect(newer, ModuleFaultKind::newer_settings, Remedy::flash);
  means.image = &image;
  expect(newer, ModuleFaultKind::newer_settings, Remedy::by_hand);
  EXPECT_NE(of(newer).to_do.find("schema 2"), std::string::npos) << of(newer).to_do;
  means.resets_settings = true;
  expect(newer, ModuleFaultKind::newer_settings, Remedy::reset_settings);
  means.image = &higher;
  expect(newer, ModuleFaultKind::newer_settings, Remedy::flash);
}

TEST_F(ModuleFaultTest, AnOlderProgramIsNoRemedyForOneThatRuns) {
  const image::Header older = image_of(0, 3);
  means.image = &older;
  expect(module_with(good_flags | flag::has_newer_settings), ModuleFaultKind::newer_settings, Remedy::by_hand);
}

TEST_F(ModuleFaultTest, AModuleMayHaveSeveral) {
  const std::vector<ModuleFault> found = find({module_with(flag::has_bootloader, 0)});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(code_of(found[0].kind), code_of(ModuleFaultKind::no_program));
  EXPECT_EQ(code_of(found[1].kind), code_of(ModuleFaultKind::no_node_id));
}

}  // namespace
}  // namespace proleg::test
