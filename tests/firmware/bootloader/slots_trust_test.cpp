// Modules with a key: which images they install and start, and what confirmed images change.

#include <gtest/gtest.h>

#include <array>

#include "firmware/bootloader/handover.hpp"
#include "signed_module.hpp"

namespace proleg::bootloader {
namespace {

using namespace test;
using image::Error;

class SignedImages : public testing::Test {
 protected:
  SignedImages() {
    module.install_proven(first);  // a module without a key takes any image
    EXPECT_TRUE(module.slots.trust().append({maker().key, {}}));
  }

  [[nodiscard]] Error check(const Image& image) const { return module.slots.check(image.bytes()); }
  [[nodiscard]] image::Trust trust() { return module.slots.trust().read(); }
  /// What a chip does after a reset, as firmware/stm32f405/bootloader does it.
  void start_program() {
    if (next_step(module.slots, {}) == NextStep::prepare) {
      static_cast<void>(module.start());
    }
  }

  UpdatedModule module;
};

TEST_F(SignedImages, AreTakenFromTheMakerOnly) {
  EXPECT_EQ(check(signed_by(maker(), second)), Error::none);
  EXPECT_EQ(check(second), Error::not_signed);
  EXPECT_EQ(check(signed_by(stranger(), second)), Error::other_key);
  Image forged = signed_by(stranger(), second);
  forged.header.key_id = maker().id();
  EXPECT_EQ(check(forged), Error::wrong_signature);
  Image changed = signed_by(maker(), second);
  changed.body.back() ^= 1;
  EXPECT_EQ(check(changed), Error::damaged_body);
  image::describe_body(changed.header, changed.body);
  EXPECT_EQ(check(changed), Error::wrong_signature);
}

TEST_F(SignedImages, DoNotStopAProgramThatRanBeforeTheKeyWasSet) {
  EXPECT_EQ(next_step(module.slots, {}), NextStep::start_program);
  EXPECT_EQ(module.start(), 1U);
}

// The chip may have been written by another way, or damaged, since the image was installed.
TEST_F(SignedImages, AreCheckedAtEachStartOnTrial) {
  ASSERT_EQ(module.install(second), InstallResult::ok);  // nobody has checked it
  EXPECT_FALSE(module.slots.attempts() != 0);
  EXPECT_EQ(module.start(), 1U) << "the one before returns";
  EXPECT_TRUE(module.slots.is_confirmed(FlashSlot::a));

  ASSERT_EQ(module.install(signed_by(maker(), second)), InstallResult::ok);
  EXPECT_EQ(module.start(), 2U);
  ASSERT_TRUE(module.slots.trust().append({stranger().key, {}}));
  EXPECT_EQ(module.start(), 1U);
}

TEST_F(SignedImages, WithoutABackupLeaveTheBootloaderOnTheBus) {
  UpdatedModule empty;
  ASSERT_TRUE(empty.slots.trust().append({maker().key, {}}));
  ASSERT_EQ(empty.install(first), InstallResult::ok);
  EXPECT_FALSE(empty.slots.may_start());
  EXPECT_EQ(empty.start(), 0U);
  ASSERT_EQ(empty.install(signed_by(maker(), second)), InstallResult::ok);
  EXPECT_TRUE(empty.slots.may_start());
  EXPECT_EQ(empty.start(), 2U);
}

TEST_F(SignedImages, RaiseTheLowestVersionWhenTheyHaveProvenThemselves) {
  Image image = second;
  image.header.minimum_version = {2, 0, 0};
  ASSERT_EQ(module.install(signed_by(maker(), image)), InstallResult::ok);
  start_program();
  EXPECT_EQ(trust().minimum_version, image::Version{}) << "it is on trial";
  EXPECT_TRUE(module.slots.confirm());
  EXPECT_EQ(next_step(module.slots, {HandoverAction::started, 1}), NextStep::start_program) << "it may stop again";
  EXPECT_EQ(next_step(module.slots, {HandoverAction::runs, 0}), NextStep::prepare);
  EXPECT_EQ(next_step(module.slots, {}), NextStep::prepare);
  start_program();
  EXPECT_EQ(trust().minimum_version, image.header.minimum_version);
  EXPECT_EQ(next_step(module.slots, {}), NextStep::start_program);
  // An old image that its maker has signed once is not taken again.
  EXPECT_EQ(check(signed_by(maker(), first)), Error::version_too_old);
  EXPECT_EQ(check(signed_by(maker(), third)), Error::none);
}

TEST_F(SignedImages, ThatFailTheirTrialChangeNothing) {
  Image image = second;
  image.header.minimum_version = {2, 0, 0};
  image.header.next_key = stranger().key;
  const image::Trust before = trust();
  ASSERT_EQ(module.install(signed_by(maker(), image)), InstallResult::ok);
  for (unsigned start = 0; start < Slots::max_attempts; ++start) {
    EXPECT_EQ(module.start(), 2U);
  }
  EXPECT_EQ(module.start(), 1U);
  EXPECT_EQ(trust(), before);
}

TEST_F(SignedImages, ExchangeTheKeyWhenTheyHaveProvenThemselves) {
  Image image = second;
  image.header.next_key = stranger().key;
  module.install_proven(signed_by(maker(), image));
  start_program();
  EXPECT_EQ(trust().key, stranger().key);
  EXPECT_EQ(check(signed_by(maker(), third)), Error::other_key);
  EXPECT_EQ(check(signed_by(stranger(), third)), Error::none);
  // The image that has brought the key is signed with the one before. It stays, and changes nothing any more.
  EXPECT_EQ(next_step(module.slots, {}), NextStep::start_program);
  EXPECT_EQ(module.start(), 2U);
  // And it is the backup of the next one.
  ASSERT_EQ(module.install(signed_by(stranger(), third)), InstallResult::ok);
  for (unsigned start = 0; start < Slots::max_attempts; ++start) {
    EXPECT_EQ(module.start(), 3U);
  }
  EXPECT_EQ(module.start(), 2U);
  EXPECT_EQ(trust().key, stranger().key);
}

TEST_F(SignedImages, WithAKeyOfSmallOrderAreRefused) {
  Image image = second;
  image.header.next_key = {1};
  EXPECT_EQ(check(signed_by(maker(), image)), Error::unusable_key);
}

// The image before the signatures was not signed, so it may say what it likes.
TEST_F(SignedImages, AloneChangeTheTrust) {
  UpdatedModule other;
  Image image = first;
  image.header.minimum_version = {9, 0, 0};
  image.header.next_key = stranger().key;
  other.install_proven(image);
  static_cast<void>(other.start());
  EXPECT_EQ(other.slots.trust().read(), image::Trust{});
  ASSERT_TRUE(other.slots.trust().append({maker().key, {}}));
  static_cast<void>(other.start());
  EXPECT_EQ(other.slots.trust().read(), (image::Trust{maker().key, {}}));
}

TEST_F(SignedImages, ThatChangeTheTrustAreRefusedWhenItsFlashIsFull) {
  while (!module.slots.trust().is_full()) {
    ASSERT_TRUE(module.slots.trust().append({maker().key, {}}));
  }
  Image image = second;
  EXPECT_EQ(check(signed_by(maker(), image)), Error::none);
  image.header.minimum_version = {1, 0, 0};
  EXPECT_EQ(check(signed_by(maker(), image)), Error::no_room_for_key);
}

}  // namespace
}  // namespace proleg::bootloader
