// Cuts of the power at every operation of the flash: during an update, during the restart after it, and during a
// repetition of the update. After each cut the module must run the old or the new image, and it must be possible to
// update it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>

#include "signed_module.hpp"

namespace proleg::bootloader {
namespace {

using namespace test;

constexpr std::uint32_t cut_seed = 7;

/// Operations on a module; the power may fail meanwhile.
using Work = std::function<void(UpdatedModule&)>;

struct Scenario {
  const char* name;
  Work before;                    ///< operations without a cut
  Work work;                      ///< operations with a cut at each operation of the flash
  std::vector<unsigned> allowed;  ///< images of which one must run afterwards; 0: none
  bool has_proven;                ///< whether the module had an image that has proven itself, before the work
  /// Of pairs of cuts only one of this many is tried: the check of a signature takes long.
  unsigned step = 1;
};

/// An image of this scenario's maker that is newer than all others.
Image update_image(UpdatedModule& module) {
  return module.slots.trust().read().key == stranger().key ? signed_by(stranger(), second) : signed_by(maker(), second);
}

void update(UpdatedModule& module) {
  static_cast<void>(module.install(update_image(module)));
  static_cast<void>(module.slots.prepare_start());
  static_cast<void>(module.slots.confirm());
}

/// The image brings another key and a lowest version, which the start after its confirmation keeps.
void update_with_key(UpdatedModule& module) {
  Image image = second;
  image.header.next_key = stranger().key;
  image.header.minimum_version = {2, 0, 0};
  static_cast<void>(module.install(signed_by(maker(), image)));
  static_cast<void>(module.slots.prepare_start());
  static_cast<void>(module.slots.confirm());
  static_cast<void>(module.slots.prepare_start());
}

void set_key(UpdatedModule& module) { EXPECT_TRUE(module.slots.trust().append({maker().key, {}})); }

void start(UpdatedModule& module) { static_cast<void>(module.slots.prepare_start()); }

const Scenario scenarios[]{
    {"the first image",
     [](UpdatedModule&) {},
     [](UpdatedModule& module) { static_cast<void>(module.install(first)); },
     {0, 1},
     false},
    {"an update", [](UpdatedModule& module) { module.install_proven(first); }, update, {1, 2}, true},
    {"an update of a module with a backup",
     [](UpdatedModule& module) {
       module.install_proven(third);
       module.install_proven(first);
     },
     update,
     {1, 2},
     true},
    {"an update of an image that has not proven itself",
     [](UpdatedModule& module) {
       module.install_proven(first);
       static_cast<void>(module.install(third));
       static_cast<void>(module.start());
     },
     update,
     {1, 2, 3},
     true},
    {"an update of a first image that has not proven itself",
     [](UpdatedModule& module) {
       static_cast<void>(module.install(first));
       static_cast<void>(module.start());
     },
     update,
     {1, 2},
     false},
    {"the return to the image before",
     [](UpdatedModule& module) {
       module.install_proven(first);
       static_cast<void>(module.install(second));
       for (unsigned attempt = 0; attempt < Slots::max_attempts; ++attempt) {
         static_cast<void>(module.start());
       }
     },
     start,
     {1},
     true},
    {"the return after a start of the update was cut",
     [](UpdatedModule& module) {
       module.install_proven(first);
       module.flash.cut_at = module.flash.operations + 150;
       EXPECT_THROW(static_cast<void>(module.install(second)), PowerCut);
     },
     start,
     {1},
     true},
    {"an update of a module with a key",
     [](UpdatedModule& module) {
       module.install_proven(first);
       set_key(module);
     },
     update,
     {1, 2},
     true,
     16},
    {"an update that brings another key",
     [](UpdatedModule& module) {
       module.install_proven(first);
       set_key(module);
     },
     update_with_key,
     {1, 2},
     true,
     16},
};

/// Switches the power on again.
void expect_to_run(const Scenario& scenario, const SlotMemory& flash) {
  UpdatedModule module(flash);
  const unsigned running = module.start();
  EXPECT_FALSE(module.slots.has_new_trust()) << "what a confirmed image says is kept";
  EXPECT_NE(std::ranges::find(scenario.allowed, running), scenario.allowed.end()) << "image " << running << " runs";
}

void expect_to_accept_an_update(const SlotMemory& flash) {
  UpdatedModule module(flash);
  static_cast<void>(module.start());
  const Image image = update_image(module);
  EXPECT_EQ(module.slots.check(image.bytes()), image::Error::none);
  const InstallResult result = module.install(image);
  EXPECT_TRUE(result == InstallResult::ok || result == InstallResult::already_there);
  EXPECT_EQ(module.start(), 2U);
  EXPECT_TRUE(module.slots.confirm());
}

/// Whether the power has failed. Operations count from the first one of the work.
bool is_cut(SlotMemory& flash, int operation, const Work& work) {
  UpdatedModule module(flash);
  module.flash.cut_at = module.flash.operations + operation;
  bool failed = false;
  try {
    work(module);
  } catch (const PowerCut&) {
    failed = true;
  }
  flash = module.flash;
  return failed;
}

class PowerCuts : public testing::TestWithParam<Scenario> {
 protected:
  PowerCuts() {
    UpdatedModule module;
    GetParam().before(module);
    prepared_ = module.flash;
  }

  /// The prepared flash, with the noise of this number for the bits that a cut leaves.
  [[nodiscard]] SlotMemory prepared(unsigned number) const {
    SlotMemory flash = prepared_;
    flash.noise.seed(cut_seed + number);
    return flash;
  }

 private:
  SlotMemory prepared_{slot_size};
};

TEST_P(PowerCuts, AtEveryOperationAndAtEveryOperationOfTheRestartLeaveAModuleThatRuns) {
  const Scenario& scenario = GetParam();
  unsigned cuts = 0;
  unsigned second_cuts = 0;
  for (SlotMemory flash = prepared(0); is_cut(flash, static_cast<int>(cuts), scenario.work); flash = prepared(++cuts)) {
    SCOPED_TRACE(testing::Message() << "cut at operation " << cuts << ", seed " << cut_seed);
    expect_to_run(scenario, flash);
    expect_to_accept_an_update(flash);
    SlotMemory restarted = flash;
    const unsigned step = PROLEG_CUT_STEP * scenario.step;
    for (unsigned cut = cuts % step; is_cut(restarted, static_cast<int>(cut), start); restarted = flash) {
      SCOPED_TRACE(testing::Message() << "and at operation " << cut << " of the restart");
      expect_to_run(scenario, restarted);
      cut += step;
      ++second_cuts;
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(cuts, 0U);
  std::printf("%s: %u cuts, and %u second ones while the module restarts\n", scenario.name, cuts, second_cuts);
}

TEST_P(PowerCuts, OneAfterTheOtherLeaveAModuleThatRuns) {
  const Scenario& scenario = GetParam();
  std::mt19937 random(cut_seed);
  constexpr unsigned rounds = 500;
  for (unsigned round = 0; round < rounds; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round << ", seed " << cut_seed);
    SlotMemory flash = prepared(round);
    static_cast<void>(is_cut(flash, static_cast<int>(random() % 500), scenario.work));
    for (int step = 0; step < 5; ++step) {
      static_cast<void>(is_cut(flash, static_cast<int>(random() % 500), random() % 2 == 0 ? start : update));
    }
    UpdatedModule module(flash);
    // Starts that were cut count as well, so without a proven image there may be no image to return to.
    const unsigned running = module.start();
    EXPECT_TRUE(running != 0 || !scenario.has_proven);
    expect_to_accept_an_update(flash);
    ASSERT_FALSE(HasFailure());
  }
}

INSTANTIATE_TEST_SUITE_P(Scenarios, PowerCuts, testing::ValuesIn(scenarios),
                         [](const auto& instance) { return std::to_string(instance.index); });

}  // namespace
}  // namespace proleg::bootloader
