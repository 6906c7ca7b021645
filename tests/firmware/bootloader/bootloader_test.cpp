// Bootloaders on the simulated bus: a host sends them images by broadcast, a tool of another maker by SDO.

#include "bootloader_rig.hpp"
#include "shared/fixed/crc32.hpp"

namespace proleg::bootloader {
namespace {

using namespace test;

TEST_F(BootloaderTest, FiveModulesInstallAnImageAndRunItOnTrial) {
  for (std::uint8_t node = 1; node <= 5; ++node) {
    add(node);
  }
  flash(second.bytes());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    EXPECT_EQ(targets[i].status.state, ReceiverState::installed);
    EXPECT_EQ(nodes[i]->module.slots.prepare_start(), StartResult::run_on_trial);
    EXPECT_EQ(number_in(nodes[i]->module.slots, FlashSlot::a), 2U);
    EXPECT_FALSE(nodes[i]->bootloader->wants_restart()) << "the host asks for it";
  }
  EXPECT_TRUE(controller.send(broadcast::leave_frame(1)));
  run_for(1'000);
  for (const auto& node : nodes) {
    EXPECT_TRUE(node->bootloader->wants_restart());
  }
}

TEST_F(BootloaderTest, ModulesWithoutANodeIdTakePart) {
  Node& node = add(0);
  flash(first.bytes());
  EXPECT_EQ(targets[0].status.state, ReceiverState::installed);
  EXPECT_EQ(number_in(node.module.slots, FlashSlot::a), 1U);
}

TEST_F(BootloaderTest, AnImageThatIsNotRightIsRefusedForItsReasonBeforeAnythingIsErased) {
  Image foreign = second;
  foreign.header.board_id = 7;
  Image elsewhere = second;
  elsewhere.header.address += 0x200;
  Image revision = second;
  revision.header.lowest_revision = revision.header.highest_revision = 3;
  Image large = make_image(4, 1028);
  std::vector<std::uint8_t> damaged = second.bytes();
  damaged[600] ^= 1U;
  std::vector<std::uint8_t> damaged_header = second.bytes();
  damaged_header[20] ^= 1U;
  std::vector<std::uint8_t> cut = second.bytes();
  cut.resize(cut.size() - 4);
  const std::vector<std::uint8_t> text(700, 'x');
  const struct {
    std::vector<std::uint8_t> bytes;
    image::Error error;
  } cases[]{{foreign.bytes(), image::Error::other_board},
            {elsewhere.bytes(), image::Error::other_address},
            {revision.bytes(), image::Error::other_revision},
            {damaged, image::Error::damaged_body},
            {damaged_header, image::Error::damaged_header},
            {cut, image::Error::wrong_length},
            {text, image::Error::not_an_image},
            {std::vector<std::uint8_t>(100), image::Error::too_short}};
  Node& node = add(3);
  node.module.install_proven(first);
  const int operations = node.module.flash.operations;
  for (const auto& one : cases) {
    node.restart(now());
    flash(one.bytes);
    EXPECT_EQ(targets[0].status.state, ReceiverState::refused) << image::describe(one.error);
    EXPECT_EQ(static_cast<image::Error>(targets[0].status.error), one.error);
  }
  EXPECT_EQ(node.module.flash.operations, operations);
  EXPECT_EQ(node.module.start(), 1U);
}

TEST_F(BootloaderTest, AnInstallIsRefusedWhileTheSupplyIsTooLow) {
  Node& node = add(3);
  node.module.install_proven(first);
  const int operations = node.module.flash.operations;
  node.module.flash.has_supply = false;
  flash(second.bytes());
  EXPECT_EQ(targets[0].status.state, ReceiverState::refused);
  EXPECT_EQ(targets[0].status.error, broadcast::refused_supply);
  EXPECT_EQ(node.module.flash.operations, operations);
  node.restart(now());
  node.module.flash.has_supply = true;
  flash(second.bytes());
  EXPECT_EQ(targets[0].status.state, ReceiverState::installed);
}

TEST_F(BootloaderTest, AToolOfOthersDownloadsAnImageBySdo) {
  Node& node = add(tool_node);
  node.module.install_proven(first);
  node.restart(now());
  EXPECT_EQ(upload(canopen::object::vendor), canopen::placeholder_vendor);
  EXPECT_EQ(upload(object::device_type), 0U);
  EXPECT_EQ(upload(object::program_identification), crc32(image::encode(first.header)));
  const std::uint8_t stop[]{0};
  const std::uint8_t clear[]{3};
  const std::uint8_t go[]{1};
  EXPECT_EQ(download({0x1F51, 1}, stop), canopen::AbortCode::none);
  EXPECT_EQ(download({0x1F51, 1}, clear), canopen::AbortCode::none);
  EXPECT_EQ(node.module.start(), 1U) << "the old program stays until the new one is complete";
  EXPECT_EQ(download({0x1F50, 1}, second.bytes()), canopen::AbortCode::none);
  run_for(10'000);
  EXPECT_EQ(upload(object::flash_status), 0U);
  EXPECT_EQ(upload(object::program_identification), crc32(image::encode(second.header)));
  EXPECT_FALSE(node.bootloader->wants_restart());
  EXPECT_EQ(download({0x1F51, 1}, go), canopen::AbortCode::none);
  EXPECT_TRUE(node.bootloader->wants_restart());
  EXPECT_EQ(node.module.start(), 2U);
}

TEST_F(BootloaderTest, AWrongDownloadIsAbortedAndTheStatusSaysWhy) {
  Node& node = add(tool_node);
  node.module.install_proven(first);
  const int operations = node.module.flash.operations;
  std::vector<std::uint8_t> damaged = second.bytes();
  damaged[600] ^= 1U;
  EXPECT_EQ(download({0x1F50, 1}, damaged), canopen::AbortCode::general_incompatibility);
  EXPECT_EQ(upload(object::flash_status) & 0xFFU, object::status_wrong_data);
  EXPECT_EQ(download({0x1F50, 1}, std::vector<std::uint8_t>(5'000)), canopen::AbortCode::out_of_memory);
  EXPECT_EQ(download({0x1F50, 1}, std::vector<std::uint8_t>(600, 'x')), canopen::AbortCode::general_incompatibility);
  EXPECT_EQ(upload(object::flash_status) & 0xFFU, object::status_unknown_format);
  EXPECT_EQ(download({0x1F52, 1}, damaged), canopen::AbortCode::no_such_object);
  EXPECT_EQ(download({0x1F51, 2}, std::vector<std::uint8_t>(1)), canopen::AbortCode::no_such_sub_index);
  EXPECT_EQ(download({0x1F51, 1}, std::vector<std::uint8_t>{4}), canopen::AbortCode::above_maximum);
  EXPECT_EQ(node.module.flash.operations, operations);
  EXPECT_EQ(download({0x1F50, 1}, second.bytes()), canopen::AbortCode::none);
}

TEST_F(BootloaderTest, ShowsItselfOnTheNetworkAndLeavesByNmt) {
  Node& node = add(4);
  run_for(1'600'000);
  ASSERT_EQ(heard.size(), 4U);
  EXPECT_EQ(heard[0], canopen::encode(canopen::Heartbeat{4, canopen::NmtState::boot_up}));
  for (std::size_t i = 1; i < heard.size(); ++i) {
    EXPECT_EQ(heard[i], canopen::encode(canopen::Heartbeat{4, canopen::NmtState::pre_operational}));
  }
  EXPECT_TRUE(controller.send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, 5})));
  EXPECT_TRUE(controller.send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::start, 4})));
  run_for(1'000);
  EXPECT_FALSE(node.bootloader->wants_restart());
  EXPECT_TRUE(controller.send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, 4})));
  run_for(1'000);
  EXPECT_TRUE(node.bootloader->wants_restart());
}

TEST_F(BootloaderTest, InstallsAnImageThatTheProgramHasReceived) {
  Node& node = add(3);
  node.module.install_proven(first);
  const std::vector<std::uint8_t> bytes = second.bytes();
  std::ranges::copy(bytes, node.buffer.begin());
  const ImageInRam image{static_cast<std::uint32_t>(bytes.size()), 77, false};
  node.restart(now(), {HandoverAction::install, image.argument()});
  const broadcast::StatusAnswer status = ask_status(node);
  EXPECT_EQ(status.state, ReceiverState::installed);
  EXPECT_EQ(status.session, 77);
  EXPECT_EQ(number_in(node.module.slots, FlashSlot::a), 2U);
  EXPECT_FALSE(node.bootloader->wants_restart()) << "the host asks for it";
  EXPECT_TRUE(controller.send(broadcast::leave_frame(77)));
  run_for(1'000);
  EXPECT_TRUE(node.bootloader->wants_restart());
}

TEST_F(BootloaderTest, ComesBackByItselfIfTheHostIsOnTheModulesOwnLine) {
  Node& node = add(3);
  node.module.install_proven(first);
  const std::vector<std::uint8_t> bytes = second.bytes();
  for (const std::size_t damaged : {std::size_t{0}, std::size_t{600}}) {
    std::ranges::copy(bytes, node.buffer.begin());
    node.buffer[damaged] ^= damaged == 0 ? 0U : 1U;
    const ImageInRam image{static_cast<std::uint32_t>(bytes.size()), 77, true};
    node.restart(now(), {HandoverAction::install, image.argument()});
    run_for(200'000);
    EXPECT_TRUE(node.bootloader->wants_restart());
    EXPECT_EQ(node.module.start(), 2U);
  }
}

TEST_F(BootloaderTest, RefusesWhatARamWithOtherContentsHolds) {
  Node& node = add(3);
  node.module.install_proven(first);
  for (const std::uint32_t size : {0U, 100U, 1'000U, 0x7F'FFFFU}) {
    const ImageInRam image{size, 77, false};
    node.restart(now(), {HandoverAction::install, image.argument()});
    EXPECT_EQ(ask_status(node).state, ReceiverState::refused) << size;
    EXPECT_EQ(node.module.start(), 1U);
  }
}

TEST_F(BootloaderTest, SaysWhichImageItHasAndThatItsProgramStartsBadly) {
  namespace flag = broadcast::module_flag;
  Node& node = add(9);
  EXPECT_EQ(ask_status(node).condition, (broadcast::ModuleCondition{flag::has_bootloader, 9}));
  EXPECT_EQ(ask_header_word(node, 0), 0U);
  node.module.install_proven(first);
  node.restart(now(), {HandoverAction::started, max_bad_starts});
  EXPECT_EQ(ask_status(node).condition.flags,
            flag::has_bootloader | flag::has_image | flag::is_confirmed | flag::starts_badly);
  const image::HeaderBytes header = image::encode(first.header);
  for (std::uint8_t word = 0; word < image::header_size / 4; ++word) {
    EXPECT_EQ(ask_header_word(node, word), read_little_endian(header, 4 * word, 4)) << unsigned{word};
  }
  EXPECT_EQ(ask_header_word(node, 128), 0U);
  EXPECT_EQ(ask_header_word(node, 255), 0U);
}

TEST_F(BootloaderTest, GetsANodeIdByLss) {
  Node& node = add(0);
  std::vector<canopen::LssModule> modules(1);
  modules[0].node = 6;
  canopen::LssMaster master(controller, modules);
  struct Host {
    canopen::LssMaster& master;
    [[nodiscard]] Microseconds next_deadline() const { return master.next_deadline(); }
    void poll(Microseconds time) { master.poll(time); }
  };
  lss = &master;
  master.start(now());
  run_until([&] { return master.state() != canopen::LssMaster::State::working; }, Host{master});
  lss = nullptr;
  EXPECT_EQ(master.state(), canopen::LssMaster::State::done);
  EXPECT_EQ(node.stored_node, 6);
}

TEST_F(BootloaderTest, StartsAProgramThatIsThereAfterTenSecondsWithoutAHost) {
  Node& with_program = add(4);
  Node& without = add(5);
  with_program.module.install_proven(first);
  run_for(Bootloader::idle_timeout_us - 1'000);
  EXPECT_FALSE(with_program.bootloader->wants_restart());
  run_for(10'000);
  EXPECT_TRUE(with_program.bootloader->wants_restart());
  run_for(5 * Bootloader::idle_timeout_us);
  EXPECT_FALSE(without.bootloader->wants_restart()) << "there is nothing to start";
}

// No node acknowledges the heartbeats of the bootloader then.
TEST_F(BootloaderTest, StartsItsProgramAlsoAloneOnTheBus) {
  Node& node = add(4);
  node.module.install_proven(first);
  controller.switch_off();
  run_for(Bootloader::idle_timeout_us + 200'000);
  EXPECT_TRUE(node.bootloader->wants_restart());
}

TEST_F(BootloaderTest, RandomFramesWriteNoFlash) {
  Node& node = add(9);
  node.module.install_proven(first);
  const int operations = node.module.flash.operations;
  std::mt19937 random(seed);
  constexpr std::uint16_t identifiers[]{0x690, 0x609, 0x7E5, 0x000, 0x77F};
  for (unsigned i = 0; i < 300'000; ++i) {
    CanFrame frame{identifiers[random() % std::size(identifiers)], static_cast<std::uint8_t>(random() % 9), {}};
    for (std::uint8_t byte = 0; byte < frame.length; ++byte) {
      frame.data.at(byte) = static_cast<std::uint8_t>(byte < 2 ? random() % 12 : random());
    }
    node.bootloader->receive(i, frame);
    node.bootloader->poll(i);
    node.bootloader->transmitted(i, {});
    if (node.bootloader->wants_restart()) {
      node.restart(i);
    }
  }
  EXPECT_EQ(node.module.flash.operations, operations) << "seed " << seed;
}

}  // namespace
}  // namespace proleg::bootloader
