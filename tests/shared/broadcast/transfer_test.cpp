// An image goes to the bootloaders of many modules, on the simulated bus of 1 Mbit/s.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "shared/broadcast/image_receiver.hpp"
#include "shared/broadcast/image_sender.hpp"
#include "shared/fixed/crc32.hpp"
#include "sim/bus/bus.hpp"

namespace proleg::broadcast {
namespace {

using sim::BusTime;

constexpr BusTime us = 1'000;
constexpr std::uint32_t image_seed = 3;
constexpr std::size_t image_size = 65'536;

/// A bootloader without a flash.
class ReceivingModule final : sim::BusListener, ReceiverOwner {
 public:
  ReceivingModule(sim::Bus& bus, std::uint32_t serial)
      : controller(bus.attach(*this)), buffer(image_size), receiver(buffer, serial, *this) {}

  sim::Controller& controller;
  std::vector<std::uint8_t> buffer;
  ImageReceiver receiver;
  bool is_silent = false;

 private:
  void received(BusTime time, const CanFrame& frame) override {
    if (!is_silent) {
      if (const auto answer = receiver.receive(time / us, frame)) {
        EXPECT_TRUE(controller.send(*answer));
      }
      if (receiver.has_install_request()) {
        receiver.set_state(ReceiverState::installed);
      }
    }
  }
  void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override {}
  [[nodiscard]] ModuleCondition condition() const override { return {module_flag::has_bootloader, 5}; }
  [[nodiscard]] std::span<const std::uint8_t> image_header() const override { return {}; }
};

/// A host and some modules on their own bus.
class Transfer final : sim::BusListener {
 public:
  /// Each receiver misses each frame with the probability `lost`.
  Transfer(std::span<const std::uint8_t> image, unsigned count, double lost = 0, std::uint32_t noise = image_seed)
      : controller_(bus.attach(*this)), image_(image), random_(noise) {
    for (unsigned i = 0; i < count; ++i) {
      const auto serial = static_cast<std::uint32_t>(random_());
      modules.push_back(std::make_unique<ReceivingModule>(bus, serial));
      targets.push_back({serial, {}, false});
    }
    bus.set_loss_rule([this, lost](const CanFrame& /*frame*/, std::size_t /*receiver*/) {
      return std::bernoulli_distribution(lost)(random_);
    });
  }

  /// Runs until all modules have the image. Returns the duration in seconds.
  double send(const SenderOptions& options = {}) {
    sender = std::make_unique<ImageSender>(controller_, image_, targets, options);
    const BusTime begin = bus.now();
    sender->start(begin / us);
    run_until(ImageSender::State::complete);
    return static_cast<double>(bus.now() - begin) / 1e9;
  }
  void install() {
    sender->install(bus.now() / us);
    run_until(ImageSender::State::done);
  }
  [[nodiscard]] bool have_all(std::span<const std::uint8_t> image) const {
    return std::ranges::all_of(
        modules, [image](const auto& module) { return std::ranges::equal(module->receiver.image(), image); });
  }

  sim::Bus bus;
  std::vector<std::unique_ptr<ReceivingModule>> modules;
  std::vector<Target> targets;
  std::unique_ptr<ImageSender> sender;

 private:
  void run_until(ImageSender::State state) {
    const BusTime end = bus.now() + 60'000'000 * us;
    while (sender->state() != state && sender->state() != ImageSender::State::done) {
      const BusTime next = std::min(bus.next_event(), sender->next_deadline() * us);
      ASSERT_LE(next, end) << "a wait without an end";
      bus.advance_to(next);
      sender->poll(bus.now() / us);
    }
  }
  void received(BusTime time, const CanFrame& frame) override {
    if (sender) {
      sender->receive(time / us, frame);
    }
  }
  void transmitted(BusTime time, const CanFrame& /*frame*/) override { sender->transmitted(time / us); }

  sim::Controller& controller_;
  std::span<const std::uint8_t> image_;
  std::mt19937 random_;
};

std::vector<std::uint8_t> random_image(std::size_t size) {
  std::mt19937 random(image_seed);
  std::vector<std::uint8_t> image(size);
  std::ranges::generate(image, [&random] { return static_cast<std::uint8_t>(random()); });
  return image;
}

TEST(ImageTransfer, BringsAModule64KiBAtMoreThan50KilobytesASecond) {
  const auto image = random_image(image_size);
  Transfer transfer(image, 1);
  const double duration = transfer.send();
  EXPECT_TRUE(transfer.have_all(image));
  const double rate = image_size / duration / 1'000;
  std::printf("one module: %.3f s, %.1f kB/s\n", duration, rate);
  EXPECT_GT(rate, 50);
}

TEST(ImageTransfer, TakesTwelveModulesHardlyLongerAndATenthOfTheFramesLostLittleMore) {
  const auto image = random_image(image_size);
  const double one = Transfer(image, 1).send();
  Transfer twelve(image, 12);
  const double all = twelve.send();
  EXPECT_TRUE(twelve.have_all(image));
  EXPECT_LT(all / one, 1.15);
  double longest = 0;
  for (std::uint32_t noise = 1; noise <= 5; ++noise) {
    Transfer disturbed(image, 12, 0.1, noise);
    longest = std::max(longest, disturbed.send());
    EXPECT_TRUE(disturbed.have_all(image));
  }
  std::printf("twelve modules: %.3f times one; with 10 %% lost: at most %.3f (seeds 1 to 5)\n", all / one,
              longest / one);
  EXPECT_LT(longest / one, 1.4);
}

TEST(ImageTransfer, CompletesWithAnySizeAndManyLosses) {
  std::mt19937 random(image_seed);
  for (unsigned round = 0; round < 40; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round << ", seed " << image_seed);
    const auto image = random_image(1 + random() % 6'000);
    Transfer transfer(image, 1 + static_cast<unsigned>(random() % 5), 0.03 * (round % 12), round);
    transfer.send({.session = 9, .attempts = 100});
    ASSERT_EQ(transfer.sender->state(), ImageSender::State::complete);
    ASSERT_TRUE(transfer.have_all(image));
    transfer.install();
    for (const Target& target : transfer.targets) {
      EXPECT_EQ(target.status.state, ReceiverState::installed);
    }
  }
}

TEST(ImageTransfer, CompletesWithBurstsOfLossThatAllModulesShare) {
  // The frames are lost in bursts, as in an adapter whose queue is full: it drops frames of the host, of more than one
  // block or of the end of a block and the beginning of the next.
  constexpr unsigned longest_burst = 60'000;  // microseconds: 400 symbols
  for (std::uint32_t noise = 1; noise <= 60; ++noise) {
    SCOPED_TRACE(testing::Message() << "seed " << noise);
    std::mt19937 random(noise);
    const auto image = random_image(3'000 + random() % 30'000);
    Transfer transfer(image, 2);
    const unsigned longest = 1'000 + random() % longest_burst;
    bool is_lost = false;
    BusTime change_at = 0;
    transfer.bus.set_frame_listener([&](const sim::Transmission& transmission) {
      while (change_at <= transmission.end) {
        is_lost = !is_lost;
        change_at += (is_lost ? random() % longest : random() % (4 * longest)) * us;
      }
    });
    transfer.bus.set_loss_rule([&](const CanFrame& frame, std::size_t /*receiver*/) {
      return is_lost && frame.identifier == host_identifier;
    });
    transfer.send({.session = 9, .attempts = 100});
    ASSERT_EQ(transfer.sender->state(), ImageSender::State::complete);
    ASSERT_TRUE(transfer.have_all(image));
  }
}

TEST(ImageTransfer, LeavesAModuleBehindThatVanishes) {
  const auto image = random_image(20'000);
  for (const unsigned percent : {0U, 30U, 60U, 99U}) {
    Transfer transfer(image, 3);
    transfer.sender = nullptr;
    const auto silent_at = static_cast<unsigned>(image.size() / symbol_size * percent / 100);
    transfer.bus.set_frame_listener([&transfer, silent_at](const sim::Transmission& /*frame*/) {
      transfer.modules[1]->is_silent = transfer.sender->symbols_sent() >= silent_at;
    });
    transfer.send();
    EXPECT_EQ(transfer.sender->state(), ImageSender::State::complete);
    EXPECT_TRUE(transfer.targets[1].is_lost);
    for (const unsigned other : {0U, 2U}) {
      EXPECT_FALSE(transfer.targets[other].is_lost);
      EXPECT_TRUE(std::ranges::equal(transfer.modules[other]->receiver.image(), image)) << percent << " %";
    }
  }
}

TEST(ImageTransfer, EndsWithoutAModule) {
  const auto image = random_image(1'000);
  Transfer transfer(image, 2);
  transfer.modules[0]->is_silent = true;
  transfer.modules[1]->is_silent = true;
  transfer.send();
  EXPECT_EQ(transfer.sender->state(), ImageSender::State::done);
  EXPECT_TRUE(transfer.targets[0].is_lost && transfer.targets[1].is_lost);
}

TEST(ImageTransfer, EndsWhenTheBusTakesNoFrames) {
  const auto image = random_image(20'000);
  for (const unsigned symbols : {0U, 500U}) {
    Transfer transfer(image, 3);
    transfer.bus.set_frame_listener([&transfer, symbols](const sim::Transmission& /*frame*/) {
      if (transfer.sender->symbols_sent() >= symbols) {
        transfer.bus.set_error_rule([](const CanFrame& /*sent*/, std::uint64_t /*number*/) { return true; });
      }
    });
    transfer.send();
    EXPECT_EQ(transfer.sender->state(), ImageSender::State::done);
    EXPECT_TRUE(std::ranges::all_of(transfer.targets, &Target::is_lost));
  }
}

/// The answer of a module to `select`.
StatusAnswer select(ImageReceiver& receiver, Microseconds now, std::uint8_t session) {
  return decode_status(receiver.receive(now, select_frame(session, 7)).value(), Code::select, 7).value();
}

class Owner final : public ReceiverOwner {
 public:
  [[nodiscard]] ModuleCondition condition() const override { return now; }
  [[nodiscard]] std::span<const std::uint8_t> image_header() const override { return bytes; }

  ModuleCondition now{};
  std::vector<std::uint8_t> bytes;
};

TEST(ImageReception, BelongsToOneHostUntilItIsOverOrThatHostIsSilent) {
  std::vector<std::uint8_t> buffer(1'000);
  const Owner owner;
  ImageReceiver receiver(buffer, 7, owner);
  constexpr Microseconds begin = 1'000'000;
  EXPECT_EQ(select(receiver, begin, 5).session, 5);
  EXPECT_EQ(receiver.receive(begin, begin_frame(5, 7)), std::nullopt);
  EXPECT_EQ(select(receiver, begin + 10, 6).session, 5);
  EXPECT_EQ(select(receiver, begin + 20, 5).state, ReceiverState::receiving) << "a repeated request";
  constexpr Microseconds silent = begin + ImageReceiver::session_timeout_us;
  EXPECT_EQ(select(receiver, silent - 1, 6).session, 5);
  EXPECT_EQ(select(receiver, silent, 6).session, 6);
  EXPECT_EQ(receiver.state(), ReceiverState::selected);
  // Another session may begin when this one has ended.
  for (const CanFrame& frame : {begin_frame(6, 7), block_frame(6, 0, BlockKind::symbols), symbol_frame(0, {})}) {
    EXPECT_EQ(receiver.receive(silent, frame), std::nullopt);
  }
  EXPECT_EQ(receiver.state(), ReceiverState::complete);
  EXPECT_EQ(select(receiver, silent + 10, 8).session, 6);
  receiver.set_state(ReceiverState::refused, 3);
  EXPECT_EQ(select(receiver, silent + 20, 6).state, ReceiverState::refused);
  EXPECT_EQ(select(receiver, silent + 30, 8).state, ReceiverState::selected);
}

TEST(ImageReception, AnswersWhoRunsWithWhichHeaderOnlyToAHostThatNamesTheModule) {
  Owner owner;
  ImageReceiver receiver({}, 7, owner);
  owner.now = {module_flag::runs_program | module_flag::is_confirmed, 12};
  EXPECT_EQ(decode_status(receiver.receive(0, status_frame(7)).value(), Code::status, 7).value().condition, owner.now);
  EXPECT_FALSE(receiver.receive(0, status_frame(8)));
  EXPECT_EQ(decode_header_word(receiver.receive(0, header_frame(7, 1)).value(), 7).value().value, 0U) << "no image";
  owner.bytes = {1, 2, 3, 4, 5, 6, 7, 8};
  const auto word = decode_header_word(receiver.receive(0, header_frame(7, 1)).value(), 7).value();
  EXPECT_EQ(word.number, 1);
  EXPECT_EQ(word.value, 0x0807'0605U);
  EXPECT_EQ(decode_header_word(receiver.receive(0, header_frame(7, 2)).value(), 7).value().value, 0U) << "behind it";
  EXPECT_FALSE(receiver.receive(0, header_frame(8, 1)));
  EXPECT_FALSE(receiver.receive(0, enter_frame(8)));
  EXPECT_FALSE(receiver.take_enter_request());
  EXPECT_TRUE(receiver.receive(0, enter_frame(7)));
  EXPECT_TRUE(receiver.take_enter_request());
  EXPECT_FALSE(receiver.take_enter_request()) << "once";
}

/// A module that gets an image of two blocks, frame by frame.
class BlockReception : public testing::Test {
 protected:
  static constexpr std::uint8_t session = 5;
  static constexpr std::uint32_t serial = 7;

  BlockReception() {
    give(select_frame(session, serial));
    give(begin_frame(session, static_cast<std::uint32_t>(image.size())));
  }
  void give(const CanFrame& frame) { static_cast<void>(receiver.receive(0, frame)); }
  /// Sends symbols of a block.
  void give_symbols(unsigned block, unsigned first = 0, unsigned end = block_symbols) {
    const std::span<const std::uint8_t> bytes = block_of(std::span<const std::uint8_t>(image), block);
    for (unsigned number = first; number < end; ++number) {
      give(symbol_frame(number, symbol_of(bytes, number)));
    }
  }
  void begin_block(unsigned block) { give(block_frame(session, block, BlockKind::symbols)); }
  void give_checksum(unsigned block) {
    give(check_frame(session, block, crc32(block_of(std::span<const std::uint8_t>(image), block))));
  }
  [[nodiscard]] ReportAnswer report() {
    return decode_report(receiver.receive(0, report_frame(serial)).value(), serial).value();
  }
  [[nodiscard]] bool has_image() {
    return receiver.state() == ReceiverState::complete && std::ranges::equal(receiver.image(), image);
  }

  const std::vector<std::uint8_t> image = random_image(2 * block_size);
  std::vector<std::uint8_t> buffer = std::vector<std::uint8_t>(2 * block_size);
  const Owner owner;
  ImageReceiver receiver{buffer, serial, owner};
};

TEST_F(BlockReception, AsksForABlockAgainThatHasSymbolsOfAnother) {
  begin_block(0);
  give_checksum(0);
  give_symbols(0, 0, 100);
  give_symbols(1, 101);  // all frames between were lost
  begin_block(0);
  give_checksum(0);
  give_symbols(0, 100, 101);
  EXPECT_EQ(report().blocks, 2U);
  EXPECT_EQ(report().some[0], 0U | needs_symbols);
  for (const unsigned block : {0U, 1U}) {
    begin_block(block);
    give_checksum(block);
    give_symbols(block);
  }
  EXPECT_TRUE(has_image());
}

TEST_F(BlockReception, IgnoresSymbolsAfterAChecksumOfAnotherBlock) {
  begin_block(0);
  give_checksum(0);
  give_symbols(0, 0, 100);
  give_checksum(1);  // the frame that begins block 1 was lost
  give_symbols(1, 101);
  begin_block(0);
  give_checksum(0);
  give_symbols(0, 100);
  EXPECT_EQ(report().blocks, 1U);
}

TEST_F(BlockReception, TakesNoSymbolsBeforeTheChecksumOfAHostThatSendsThem) {
  begin_block(0);
  give_checksum(0);
  give_symbols(0);
  begin_block(1);
  give_symbols(1, 0, 10);
  give_checksum(1);
  give_symbols(1, 10);
  EXPECT_EQ(report().most, 10U);
  begin_block(1);
  give_checksum(1);
  give_symbols(1, 0, 10);
  EXPECT_TRUE(has_image());
}

TEST_F(BlockReception, ComputesTheChecksumOfABlockOnce) {
  // A block may take longer than a frame, and other modules may need many repair symbols.
  begin_block(0);
  give_checksum(0);
  give_symbols(0);
  EXPECT_EQ(report().blocks, 1U);
  buffer[0] ^= 1U;  // another check of the image would find that
  give(block_frame(session, 0, BlockKind::repairs));
  give_checksum(0);
  for (unsigned repair = 0; repair < 20; ++repair) {
    give(symbol_frame(repair, repair_symbol(block_of(std::span<const std::uint8_t>(image), 0), 0, repair)));
  }
  EXPECT_EQ(report().blocks, 1U);
}

TEST_F(BlockReception, ForgetsWhatCameBeforeTheFirstChecksum) {
  begin_block(0);
  give_symbols(0, 0, 100);
  give_symbols(1, 100);  // all frames between were lost, the checksums among them
  begin_block(1);
  give_checksum(1);
  begin_block(1);
  give_checksum(1);
  give_symbols(1);
  EXPECT_EQ(report().blocks, 1U);
  begin_block(0);
  give_checksum(0);
  give_symbols(0);
  EXPECT_TRUE(has_image());
}

TEST_F(BlockReception, NeedsNoChecksumsOfAHostThatSendsNone) {
  for (const unsigned block : {0U, 1U}) {
    begin_block(block);
    give_symbols(block);
  }
  EXPECT_TRUE(has_image());
}

TEST(ImageTransfer, IsNotDisturbedByAnotherHost) {
  const auto image = random_image(20'000);
  Transfer transfer(image, 2);
  ReceivingModule& module = *transfer.modules[0];
  bool asked = false;
  transfer.bus.set_frame_listener([&](const sim::Transmission& transmission) {
    if (!asked && transfer.sender->symbols_sent() > 500) {
      asked = true;
      const Microseconds now = transmission.end / us;
      const auto answer = module.receiver.receive(now, select_frame(77, transfer.targets[0].serial));
      EXPECT_NE(decode_status(answer.value(), Code::select, transfer.targets[0].serial).value().session, 77);
      EXPECT_FALSE(module.receiver.receive(now, begin_frame(77, 100)).has_value());
      EXPECT_FALSE(module.receiver.receive(now, leave_frame(77)).has_value());
    }
  });
  transfer.send();
  EXPECT_TRUE(asked);
  EXPECT_TRUE(transfer.have_all(image));
  EXPECT_FALSE(module.receiver.take_leave_request());
}

}  // namespace
}  // namespace proleg::broadcast
