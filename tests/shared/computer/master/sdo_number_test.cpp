#include <gtest/gtest.h>

#include "device_memory.hpp"
#include "frame_text.hpp"
#include "shared/canopen/sdo_frame.hpp"
#include "tests/support/number_transfer.hpp"

namespace proleg::canopen {
namespace {

using test::frame;
using test::NumberTransfer;

constexpr Address period{0x1006, 0};

TEST(SdoNumber, HasTheRequestsOfTheStandard) {
  NumberTransfer client;
  EXPECT_EQ(client.state(), NumberTransfer::State::idle);
  EXPECT_EQ(client.read(0, 3, {0x6041, 0}), frame("603 [8] 40 41 60 00 00 00 00 00"));
  EXPECT_EQ(client.state(), NumberTransfer::State::running);
  EXPECT_EQ(client.write(0, 3, {0x2001, 1}, 1, 5), frame("603 [8] 2F 01 20 01 05 00 00 00"));
  EXPECT_EQ(client.write(0, 3, {0x6060, 0}, 1, 0xFFFFFFFF), frame("603 [8] 2F 60 60 00 FF 00 00 00"));
  EXPECT_EQ(client.write(0, 3, {0x1017, 0}, 2, 100), frame("603 [8] 2B 17 10 00 64 00 00 00"));
  EXPECT_EQ(client.write(0, 127, period, 4, 0x01020304), frame("67F [8] 23 06 10 00 04 03 02 01"));
}

TEST(SdoNumber, ReadsEveryEntryAndWritesEveryOneThatCanBeWritten) {
  constexpr std::uint32_t seed = 3;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  test::DeviceMemory device;
  NumberTransfer client;
  constexpr std::uint8_t node = 77;
  SdoServer server(node, device);
  const auto exchange = [&](const CanFrame& request) {
    const std::optional<CanFrame> answer = server.receive(0, request);
    return answer && client.receive(*answer);
  };
  for_each_object([&](const Object& object) {
    if (is_long(object.type)) {
      return;
    }
    const std::uint8_t size = size_of(object.type);
    const std::uint32_t value = random() % 2 == 0 ? object.minimum : object.maximum;
    ASSERT_TRUE(exchange(client.write(0, node, object.address, size, value)));
    if (object.access == Access::read_write) {
      ASSERT_EQ(client.state(), NumberTransfer::State::done) << object.name;
    } else {
      ASSERT_EQ(client.state(), NumberTransfer::State::aborted) << object.name;
      ASSERT_EQ(client.abort_code(),
                object.access == Access::by_pdo ? AbortCode::unsupported_access : AbortCode::read_only);
    }
    ASSERT_TRUE(exchange(client.read(0, node, object.address)));
    ASSERT_EQ(client.state(), NumberTransfer::State::done) << object.name;
    ASSERT_EQ(client.size(), size) << object.name;
    const std::uint32_t known =
        fixed_value(object, node).value_or(object.access == Access::read_write ? value : object.default_value);
    ASSERT_EQ(extend(object.type, client.value()), known) << object.name;
    ASSERT_EQ(client.next_deadline(), never);
  });
}

TEST(SdoNumber, ReportsAnAbortWithItsCode) {
  NumberTransfer client;
  static_cast<void>(client.read(0, 3, period));
  EXPECT_TRUE(client.receive(frame("583 [8] 80 06 10 00 22 00 00 08")));
  EXPECT_EQ(client.state(), NumberTransfer::State::aborted);
  EXPECT_EQ(client.abort_code(), AbortCode::refused_by_state);
}

TEST(SdoNumber, GivesUpWhenItsTimeIsOver) {
  NumberTransfer client;
  EXPECT_EQ(client.next_deadline(), never);
  static_cast<void>(client.write(1'000, 3, period, 4, 10'000, 250));
  EXPECT_EQ(client.next_deadline(), 1'250U);
  client.poll(1'249);
  EXPECT_EQ(client.state(), NumberTransfer::State::running);
  client.poll(1'250);
  EXPECT_EQ(client.state(), NumberTransfer::State::aborted);
  EXPECT_EQ(client.abort_code(), AbortCode::timeout);
  EXPECT_EQ(client.next_deadline(), never);
  EXPECT_FALSE(client.receive(frame("583 [8] 60 06 10 00 00 00 00 00"))) << "too late";
  EXPECT_EQ(client.state(), NumberTransfer::State::aborted);
}

TEST(SdoNumber, PassesOverWhatIsNotTheAnswer) {
  NumberTransfer client;
  static_cast<void>(client.read(0, 3, period));
  for (const char* foreign : {
           "584 [8] 43 06 10 00 10 27 00 00",  // another node
           "583 [8] 43 05 10 00 80 00 00 00",  // another index
           "583 [8] 43 06 10 01 80 00 00 00",  // another sub-index
           "583 [8] 80 05 10 00 00 00 04 05",  // another transfer's abort
           "583 [7] 43 06 10 00 10 27 00",     // too short
           "603 [8] 43 06 10 00 10 27 00 00",  // no answer
           "583 [8] 60 06 10 00 00 00 00 00",  // of a write that was given up
           "583 [8] 00 06 10 00 00 00 00 00",  // a segment
       }) {
    EXPECT_FALSE(client.receive(frame(foreign))) << foreign;
    EXPECT_EQ(client.state(), NumberTransfer::State::running) << foreign;
  }
  EXPECT_TRUE(client.receive(frame("583 [8] 43 06 10 00 10 27 00 00")));
  EXPECT_EQ(client.value(), 10'000U);

  static_cast<void>(client.write(0, 3, period, 4, 10'000));
  EXPECT_FALSE(client.receive(frame("583 [8] 43 06 10 00 10 27 00 00"))) << "of a read that was given up";
  EXPECT_TRUE(client.receive(frame("583 [8] 60 06 10 00 00 00 00 00")));
  EXPECT_EQ(client.state(), NumberTransfer::State::done);
}

TEST(SdoNumber, MayHaveAnUnspecifiedSize) {
  NumberTransfer client;
  static_cast<void>(client.read(0, 3, period));
  EXPECT_TRUE(client.receive(frame("583 [8] 42 06 10 00 04 03 02 01")));
  EXPECT_EQ(client.value(), 0x01020304U);
  EXPECT_EQ(client.size(), 4);
  static_cast<void>(client.read(0, 3, period));
  EXPECT_TRUE(client.receive(frame("583 [8] 47 06 10 00 04 03 02 01")));
  EXPECT_EQ(client.value(), 0x00020304U) << "three bytes";
}

TEST(SdoNumber, EndsATransferByItsAnswerOnlyAmongOtherFrames) {
  constexpr std::uint32_t seed = 9;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int run = 0; run < 2'000; ++run) {
    NumberTransfer client;
    static_cast<void>(run % 2 == 0 ? client.read(0, 3, period) : client.write(0, 3, period, 4, 1));
    for (int i = 0; i < 50; ++i) {
      CanFrame noise = test::random_frame(random, random() % 2 == 0 ? 0x583 : random() % 0x800);
      if (random() % 2 == 0 && noise.length == 8) {
        noise.data[1] = 0x06;
        noise.data[2] = 0x10;
        noise.data[3] = 0x00;
        noise.data[0] |= sdo::expedited;  // an answer in segments would go on with frames that have no address
      }
      const NumberTransfer::State before = client.state();
      const bool ended = client.receive(noise);
      ASSERT_EQ(ended, before == NumberTransfer::State::running && client.state() != NumberTransfer::State::running);
      if (ended) {
        ASSERT_EQ(noise.identifier, 0x583);
        ASSERT_EQ(noise.data[1] | noise.data[2] << 8 | noise.data[3] << 16, 0x001006);
      }
    }
  }
}

TEST(SdoNumber, WaitsForAModuleThatErasesFlash) {
  // docs/protocol.md, Settings that a module keeps: up to 0.5 s, and 1 s if the flash fails.
  struct Storing {
    Address address;
    const char* answer;
  };
  for (const auto& [address, answer] : {Storing{{0x1010, 1}, "583 [8] 60 10 10 01 00 00 00 00"},
                                        Storing{{0x1011, 1}, "583 [8] 60 11 10 01 00 00 00 00"}}) {
    NumberTransfer client;
    (void)client.write(0, 3, address, 4, signature_save);
    client.poll(1'010'000);
    EXPECT_EQ(client.state(), NumberTransfer::State::running);
    EXPECT_TRUE(client.receive(frame(answer)));
    EXPECT_EQ(client.state(), NumberTransfer::State::done);
    (void)client.write(0, 3, address, 4, signature_save, 100'000);
    client.poll(1'010'000);
    EXPECT_EQ(client.state(), NumberTransfer::State::running)
        << "a short time for other objects is not enough for these";
    client.poll(1'500'000);
    EXPECT_EQ(client.state(), NumberTransfer::State::aborted) << "it does not wait for ever";
    EXPECT_EQ(client.abort_code(), AbortCode::timeout);
    (void)client.read(0, 3, address);
    EXPECT_EQ(client.next_deadline(), 500'000U) << "it is quick to read";
  }
}

}  // namespace
}  // namespace proleg::canopen
