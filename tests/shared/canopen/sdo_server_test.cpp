#include <gtest/gtest.h>

#include <string>

#include "device_memory.hpp"
#include "frame_text.hpp"

namespace proleg::canopen {
namespace {

using test::frame;
using test::text;

class SdoService : public testing::Test {
 protected:
  /// The answer of node 3 as text; "" without an answer.
  std::string answer(const std::string& request) {
    const std::optional<CanFrame> reply = server.receive(0, frame(request));
    return reply ? text(*reply) : "";
  }

  test::DeviceMemory device;
  SdoServer server{3, device};
};

TEST_F(SdoService, AnswersAsDocumented) {
  const std::string stage = "603 [8] 23 80 40 01 8E E3 38 0E";
  const std::string staged = "583 [8] 60 80 40 01 00 00 00 00";
  EXPECT_TRUE(test::is_documented(stage));
  EXPECT_TRUE(test::is_documented(staged));
  EXPECT_EQ(answer(stage), staged);
  EXPECT_EQ(device.value({0x4080, 1}), 0x0E38E38EU) << "20 degrees";
}

// Requests and answers by the tables of CiA 301, 7.2.4.3.
TEST_F(SdoService, ReadsEverySize) {
  device.values[{0x2001, 7}] = 0x12345678;
  device.values[{0x6041, 0}] = 0x0237;
  device.values[{0x6061, 0}] = 0xFFFFFFFF;
  EXPECT_EQ(answer("603 [8] 40 01 20 07 00 00 00 00"), "583 [8] 43 01 20 07 78 56 34 12");
  EXPECT_EQ(answer("603 [8] 40 41 60 00 00 00 00 00"), "583 [8] 4B 41 60 00 37 02 00 00");
  EXPECT_EQ(answer("603 [8] 40 61 60 00 00 00 00 00"), "583 [8] 4F 61 60 00 FF 00 00 00");
  EXPECT_EQ(answer("603 [8] 40 61 60 00 11 22 33 44"), "583 [8] 4F 61 60 00 FF 00 00 00") << "reserved bytes";
  EXPECT_EQ(answer("603 [8] 40 00 10 00 00 00 00 00"), "583 [8] 43 00 10 00 92 01 02 00");
  EXPECT_EQ(answer("603 [8] 40 18 10 00 00 00 00 00"), "583 [8] 4F 18 10 00 04 00 00 00");
  EXPECT_EQ(answer("603 [8] 40 00 12 01 00 00 00 00"), "583 [8] 43 00 12 01 03 06 00 00");
}

TEST_F(SdoService, WritesEverySizeIndicatedOrNot) {
  EXPECT_EQ(answer("603 [8] 23 06 10 00 20 4E 00 00"), "583 [8] 60 06 10 00 00 00 00 00");
  EXPECT_EQ(device.value({0x1006, 0}), 20'000U);
  EXPECT_EQ(answer("603 [8] 2B 17 10 00 64 00 AA AA"), "583 [8] 60 17 10 00 00 00 00 00") << "unused bytes";
  EXPECT_EQ(device.value({0x1017, 0}), 100U);
  EXPECT_EQ(answer("603 [8] 2F 01 20 01 05 AA AA AA"), "583 [8] 60 01 20 01 00 00 00 00");
  EXPECT_EQ(device.value({0x2001, 1}), 5U);
  EXPECT_EQ(answer("603 [8] 2F 60 60 00 FF 00 00 00"), "583 [8] 60 60 60 00 00 00 00 00");
  EXPECT_EQ(device.value({0x6060, 0}), 0xFFFFFFFFU) << "-1";
  EXPECT_EQ(answer("603 [8] 22 01 20 01 06 AA AA AA"), "583 [8] 60 01 20 01 00 00 00 00") << "the object's own size";
  EXPECT_EQ(device.value({0x2001, 1}), 6U);
  EXPECT_EQ(answer("603 [8] 22 06 10 00 10 27 00 00"), "583 [8] 60 06 10 00 00 00 00 00");
  EXPECT_EQ(device.value({0x1006, 0}), 10'000U);
}

TEST_F(SdoService, GivesTheReasonOfARefusal) {
  EXPECT_EQ(answer("603 [8] 40 00 30 01 00 00 00 00"), "583 [8] 80 00 30 01 00 00 02 06") << "no such object";
  EXPECT_EQ(answer("603 [8] 23 00 40 01 00 00 00 00"), "583 [8] 80 00 40 01 00 00 02 06");
  EXPECT_EQ(answer("603 [8] 40 80 40 05 00 00 00 00"), "583 [8] 80 80 40 05 11 00 09 06") << "no such sub-index";
  EXPECT_EQ(answer("603 [8] 40 00 10 01 00 00 00 00"), "583 [8] 80 00 10 01 11 00 09 06");
  EXPECT_EQ(answer("603 [8] 2B 41 60 00 00 00 00 00"), "583 [8] 80 41 60 00 02 00 01 06") << "read-only";
  EXPECT_EQ(answer("603 [8] 23 00 10 00 92 01 02 00"), "583 [8] 80 00 10 00 02 00 01 06") << "constant";
  EXPECT_EQ(answer("603 [8] 2F 18 10 00 04 00 00 00"), "583 [8] 80 18 10 00 02 00 01 06") << "sub-index 0";
  EXPECT_EQ(answer("603 [8] 23 00 21 01 00 00 00 00"), "583 [8] 80 00 21 01 00 00 01 06") << "for a PDO to write";
  EXPECT_EQ(answer("603 [8] 2B 06 10 00 10 27 00 00"), "583 [8] 80 06 10 00 10 00 07 06") << "two bytes for four";
  EXPECT_EQ(answer("603 [8] 23 17 10 00 64 00 00 00"), "583 [8] 80 17 10 00 10 00 07 06") << "four bytes for two";
  EXPECT_EQ(answer("603 [8] 27 06 10 00 10 27 00 00"), "583 [8] 80 06 10 00 10 00 07 06") << "three bytes";
  EXPECT_EQ(answer("603 [8] 23 80 40 01 01 00 00 40"), "583 [8] 80 80 40 01 31 00 09 06") << "above 90 degrees";
  EXPECT_EQ(answer("603 [8] 23 80 40 01 FF FF FF FF"), "583 [8] 80 80 40 01 32 00 09 06") << "below 0";
  EXPECT_EQ(device.writes, 0U);
}

TEST_F(SdoService, RefusesACommandThatDoesNotExistOrBelongsToNoTransfer) {
  for (const char* command :
       {"00", "0F", "26", "2A", "33", "41", "5F", "60", "70", "A1", "A2", "A3", "C1", "E0", "FF"}) {
    EXPECT_EQ(answer(std::string("603 [8] ") + command + " 06 10 00 10 27 00 00"), "583 [8] 80 06 10 00 01 00 04 05")
        << command;
  }
  EXPECT_EQ(device.reads + device.writes, 0U);
}

TEST_F(SdoService, HandsOnWhatTheDeviceRefuses) {
  device.refusal = AbortCode::refused_by_state;
  EXPECT_EQ(answer("603 [8] 40 41 60 00 00 00 00 00"), "583 [8] 80 41 60 00 22 00 00 08");
  EXPECT_EQ(answer("603 [8] 23 06 10 00 20 4E 00 00"), "583 [8] 80 06 10 00 22 00 00 08");
}

TEST_F(SdoService, IsSilentToWhatIsNoRequestToIt) {
  EXPECT_EQ(answer("603 [8] 80 06 10 00 00 00 04 05"), "") << "the client gives up";
  EXPECT_EQ(answer("603 [7] 40 06 10 00 00 00 00"), "");
  EXPECT_EQ(answer("603 [0]"), "");
  EXPECT_EQ(answer("604 [8] 40 06 10 00 00 00 00 00"), "") << "to another node";
  EXPECT_EQ(answer("583 [8] 40 06 10 00 00 00 00 00"), "") << "an answer";
  EXPECT_EQ(device.reads + device.writes, 0U);
}

TEST_F(SdoService, AnswersAnyRequestValidlyAndWritesOnlyAllowedValues) {
  constexpr std::uint32_t seed = 41;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::vector<Address> addresses;
  for_each_object([&](const Object& object) { addresses.push_back(object.address); });
  constexpr std::uint8_t commands[] = {0x40, 0x22, 0x23, 0x27, 0x2B, 0x2F};
  unsigned aborted = 0;
  for (int run = 0; run < 300'000; ++run) {
    const auto node = static_cast<std::uint8_t>(1 + random() % 127);
    CanFrame request = test::random_frame(random, static_cast<std::uint16_t>(0x600 + node));
    if (request.length == 8 && random() % 4 != 0) {
      const Address address = addresses[random() % addresses.size()];
      request.data[0] = commands[random() % std::size(commands)];
      request.data[1] = static_cast<std::uint8_t>(address.index);
      request.data[2] = static_cast<std::uint8_t>(address.index >> 8U);
      request.data[3] = static_cast<std::uint8_t>(address.sub + (random() % 16 == 0 ? 1 : 0));
      if (random() % 2 == 0) {
        request.data[5] = request.data[6] = request.data[7] = static_cast<std::uint8_t>(random() % 2 == 0 ? 0 : 0xFF);
      }
    }
    SdoServer any_node(node, device);
    const std::optional<CanFrame> reply = any_node.receive(0, request);
    const bool is_request = request.length == 8 && request.data[0] >> 5U != 4;
    ASSERT_EQ(reply.has_value(), is_request) << text(request);
    if (!reply) {
      continue;
    }
    ASSERT_EQ(reply->identifier, 0x580 + node);
    ASSERT_EQ(reply->length, 8);
    for (unsigned i = 1; i <= 3; ++i) {
      ASSERT_EQ(reply->data[i], request.data[i]) << "of another entry: " << text(*reply);
    }
    const std::uint8_t kind = reply->data[0];
    if (kind == 0x80) {
      ++aborted;
    } else if (request.data[0] == 0x40) {
      ASSERT_TRUE(kind == 0x43 || kind == 0x4B || kind == 0x4F || kind == 0x41) << text(*reply);
    } else if (request.data[0] >> 5U == 6) {
      ASSERT_EQ(kind, 0xA4) << text(request);
    } else if (request.data[0] >> 5U == 5) {
      ASSERT_TRUE(kind == 0xC6 || kind >> 5U == 2) << text(request);
    } else {
      ASSERT_EQ(kind, 0x60) << text(request);
    }
  }
  EXPECT_GT(aborted, 1000U);
  EXPECT_GT(device.writes, 1000U) << "and all were checked by the device";
}

}  // namespace
}  // namespace proleg::canopen
