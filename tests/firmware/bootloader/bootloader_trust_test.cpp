// A module with a key on the bus: what it refuses, and how it gets the key.

#include "bootloader_rig.hpp"
#include "signed_module.hpp"

namespace proleg::bootloader {
namespace {

using namespace test;
using image::Error;

class BootloaderTrust : public BootloaderTest {
 protected:
  BootloaderTrust() : node(add(tool_node)) {
    node.module.install_proven(second);
    node.restart(0);
  }

  void set_key(const image::Version& minimum = {}) {
    ASSERT_TRUE(node.module.slots.trust().append({maker().key, minimum}));
  }
  /// Sends a key as a host does.
  void send_key(const image::PublicKey& key) {
    const auto message = image::encode_key(key);
    flash(message);
  }
  void expect_refused(Error error) {
    EXPECT_EQ(targets[0].status.state, ReceiverState::refused);
    EXPECT_EQ(static_cast<Error>(targets[0].status.error), error);
  }
  [[nodiscard]] image::Trust trust() { return node.module.slots.trust().read(); }

  Node& node;
};

TEST_F(BootloaderTrust, RefusesForItsReasonBeforeAnythingIsErased) {
  set_key({2, 0, 0});
  Image forged = signed_by(maker(), third);
  forged.header.signature[40] ^= 1;
  std::vector<std::uint8_t> cut = signed_by(maker(), third).bytes();
  cut.resize(cut.size() - 4);
  Image small_key = third;
  small_key.header.next_key = {1};
  const struct {
    std::vector<std::uint8_t> bytes;
    Error error;
  } cases[]{{third.bytes(), Error::not_signed},
            {signed_by(stranger(), third).bytes(), Error::other_key},
            {forged.bytes(), Error::wrong_signature},
            {cut, Error::wrong_length},
            {signed_by(maker(), first).bytes(), Error::version_too_old},
            {signed_by(maker(), small_key).bytes(), Error::unusable_key}};
  const int operations = node.module.flash.operations;
  for (const auto& one : cases) {
    node.restart(now());
    flash(one.bytes);
    expect_refused(one.error);
    EXPECT_EQ(download({0x1F50, 1}, one.bytes), canopen::AbortCode::general_incompatibility);
    EXPECT_EQ(upload(object::flash_status) >> 8U, static_cast<std::uint32_t>(one.error));
  }
  EXPECT_EQ(node.module.flash.operations, operations);
  node.restart(now());
  flash(signed_by(maker(), third).bytes());
  EXPECT_EQ(targets[0].status.state, ReceiverState::installed);
  EXPECT_EQ(node.module.start(), 3U);
}

// The next image may come before the start at which a confirmed image's lowest version is kept.
TEST_F(BootloaderTrust, FollowsAConfirmedImageBeforeItChecksAnotherOne) {
  set_key();
  Image image = second;
  image.header.minimum_version = {2, 0, 0};
  image.body[0] ^= 1;
  image::describe_body(image.header, image.body);
  node.module.install_proven(signed_by(maker(), image));
  node.restart(now());
  flash(signed_by(maker(), first).bytes());
  expect_refused(Error::version_too_old);
  EXPECT_EQ(trust().minimum_version, image.header.minimum_version);
}

TEST_F(BootloaderTrust, ReportsTheKeyAndTheLowestVersion) {
  EXPECT_EQ(ask_header_word(node, 128), 0U);
  EXPECT_EQ(upload(canopen::object::update_key), 0U);
  set_key({2, 3, 4});
  EXPECT_EQ(ask_header_word(node, 128), maker().id());
  EXPECT_EQ(ask_header_word(node, 129), 0x0003'0002U);
  EXPECT_EQ(ask_header_word(node, 130), 4U);
  EXPECT_EQ(ask_header_word(node, 131), 0U);
  EXPECT_EQ(upload(canopen::object::update_key), maker().id());
}

TEST_F(BootloaderTrust, KeepsTheFirstKeyThatComesOverTheBus) {
  send_key(maker().key);
  EXPECT_EQ(targets[0].status.state, ReceiverState::installed);
  EXPECT_EQ(trust(), (image::Trust{maker().key, {}}));
  EXPECT_EQ(node.module.start(), 2U) << "the program stays";
  node.restart(now());
  send_key(stranger().key);
  expect_refused(Error::has_key);
  EXPECT_EQ(trust().key, maker().key);
}

TEST_F(BootloaderTrust, TakesNoKeyThatFitsSignaturesOfAnybody) {
  send_key({1});
  expect_refused(Error::unusable_key);
  EXPECT_EQ(trust(), image::Trust{});
}

TEST_F(BootloaderTrust, TakesTheFirstKeyForTenMinutes) {
  const auto send_after = [this](Microseconds time) {
    node.restart(now());
    // The bootloader stays as long as a host asks for something.
    for (const Microseconds end = now() + time; now() < end; run_for(std::min<Microseconds>(5'000'000, end - now()))) {
      EXPECT_TRUE(controller.send(broadcast::status_frame(node.serial)));
    }
    send_key(maker().key);
  };
  send_after(601'000'000);
  expect_refused(Error::key_too_late);
  EXPECT_EQ(trust(), image::Trust{});
  send_after(595'000'000);
  EXPECT_EQ(targets[0].status.state, ReceiverState::installed);
}

TEST_F(BootloaderTrust, TakesTheFirstKeyFromAProgramThatRunsForLessThanTenMinutes) {
  const auto message = image::encode_key(maker().key);
  std::ranges::copy(message, node.buffer.begin());
  for (const bool is_early : {false, true}) {
    node.restart(now(), {HandoverAction::install, ImageInRam{message.size(), 1, false, is_early}.argument()});
    run_for(1'000);
    EXPECT_EQ(trust().key.has_value(), is_early);
  }
}

}  // namespace
}  // namespace proleg::bootloader
