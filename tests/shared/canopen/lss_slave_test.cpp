// The slave of the layer setting services, byte by byte as CiA 305 defines it.

#include "shared/canopen/lss_slave.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

#include "frame_text.hpp"

namespace proleg::canopen {
namespace {

using Bytes = std::array<std::uint8_t, 8>;

constexpr LssAddress slave_address{0x50524F4C, 0x00000001, 0x00010000, 0x89ABCDEF};

struct Storage final : LssStorage {
  [[nodiscard]] Result store_node(std::uint8_t node) override {
    stored.push_back(node);
    return result;
  }
  std::vector<std::uint8_t> stored;
  Result result;
};

class LssSlaveTest : public testing::Test {
 protected:
  /// Data of the answer; nothing without an answer.
  std::optional<Bytes> ask(const Bytes& data) {
    const std::optional<CanFrame> answer = slave.serve({0x7E5, 8, data}, slave_address, node, storage);
    if (!answer) {
      return std::nullopt;
    }
    EXPECT_EQ(answer->identifier, 0x7E4);
    EXPECT_EQ(answer->length, 8);
    return answer->data;
  }
  [[nodiscard]] bool is_selected() { return ask({0x5E}).has_value(); }
  void select() { ask({0x04, 1}); }
  void select_by_address() {
    EXPECT_EQ(ask({0x40, 0x4C, 0x4F, 0x52, 0x50}), std::nullopt);
    EXPECT_EQ(ask({0x41, 0x01}), std::nullopt);
    EXPECT_EQ(ask({0x42, 0x00, 0x00, 0x01}), std::nullopt);
    EXPECT_EQ(ask({0x43, 0xEF, 0xCD, 0xAB, 0x89}), Bytes{0x44});
  }

  LssSlave slave;
  Storage storage;
  std::uint8_t node = 0;
};

TEST_F(LssSlaveTest, SwitchStateGlobalSelectsAndReleasesItWithoutAnAnswer) {
  EXPECT_FALSE(is_selected());
  EXPECT_EQ(ask({0x04, 1}), std::nullopt);
  EXPECT_TRUE(is_selected());
  EXPECT_EQ(ask({0x04, 2}), std::nullopt) << "there are two states";
  EXPECT_TRUE(is_selected());
  EXPECT_EQ(ask({0x04, 0}), std::nullopt);
  EXPECT_FALSE(is_selected());
}

TEST_F(LssSlaveTest, SwitchStateSelectiveSelectsItByTheFourNumbersInTheirOrder) {
  select_by_address();
  EXPECT_TRUE(is_selected());
}

TEST_F(LssSlaveTest, SwitchStateSelectiveSelectsNoOtherSlave) {
  const std::array<Bytes, 4> right{
      {{0x40, 0x4C, 0x4F, 0x52, 0x50}, {0x41, 0x01}, {0x42, 0x00, 0x00, 0x01}, {0x43, 0xEF, 0xCD, 0xAB, 0x89}}};
  for (std::size_t wrong = 0; wrong < 4; ++wrong) {
    for (std::size_t i = 0; i < 4; ++i) {
      Bytes request = right.at(i);
      request[1] ^= i == wrong ? 1U : 0U;
      EXPECT_EQ(ask(request), std::nullopt);
    }
    for (std::size_t i = 0; i < 4; ++i) {  // one of the four numbers is missing
      if (i != wrong) {
        EXPECT_EQ(ask(right.at(i)), std::nullopt);
      }
    }
  }
  EXPECT_FALSE(is_selected());
  select_by_address();
}

TEST_F(LssSlaveTest, ConfigureNodeIdIsAnsweredWithAnErrorIfTheIdIsOutOfRange) {
  select();
  for (unsigned id = 0; id < 256; ++id) {
    // 127 is the host's; 255: none.
    const bool is_right = (id >= 1 && id <= 126) || id == 255;
    const std::uint8_t before = slave.pending_node();
    EXPECT_EQ(ask({0x11, static_cast<std::uint8_t>(id)}), (Bytes{0x11, static_cast<std::uint8_t>(is_right ? 0 : 1)}));
    EXPECT_EQ(slave.pending_node(), is_right ? id % 255U : before);
  }
  EXPECT_TRUE(storage.stored.empty());
}

TEST_F(LssSlaveTest, ConfigureBitTimingAcceptsOneMegabitOnly) {
  select();
  EXPECT_EQ(ask({0x13, 0, 0}), (Bytes{0x13, 0}));
  for (std::uint8_t index = 1; index < 10; ++index) {
    EXPECT_EQ(ask({0x13, 0, index}), (Bytes{0x13, 1})) << int{index};
  }
  EXPECT_EQ(ask({0x13, 128, 0}), (Bytes{0x13, 1})) << "another table";
  EXPECT_EQ(ask({0x15, 10, 0}), std::nullopt) << "activate bit timing has no answer";
  EXPECT_TRUE(is_selected());
}

TEST_F(LssSlaveTest, StoreConfigurationKeepsTheConfiguredNodeId) {
  select();
  ask({0x11, 42});
  EXPECT_EQ(ask({0x17}), (Bytes{0x17, 0}));
  ask({0x11, 255});
  EXPECT_EQ(ask({0x17}), (Bytes{0x17, 0}));
  EXPECT_EQ(storage.stored, (std::vector<std::uint8_t>{42, 0}));
  storage.result = {2, 0};
  EXPECT_EQ(ask({0x17}), (Bytes{0x17, 2})) << "access to the storage failed";
  storage.result = {255, 1};
  EXPECT_EQ(ask({0x17}), (Bytes{0x17, 255, 1}));
}

TEST_F(LssSlaveTest, InquireGivesTheFourNumbersAndTheNodeIdInUse) {
  select();
  EXPECT_EQ(ask({0x5A}), (Bytes{0x5A, 0x4C, 0x4F, 0x52, 0x50}));
  EXPECT_EQ(ask({0x5B}), (Bytes{0x5B, 0x01}));
  EXPECT_EQ(ask({0x5C}), (Bytes{0x5C, 0x00, 0x00, 0x01}));
  EXPECT_EQ(ask({0x5D}), (Bytes{0x5D, 0xEF, 0xCD, 0xAB, 0x89}));
  EXPECT_EQ(ask({0x5E}), (Bytes{0x5E, 0xFF}));
  node = 9;
  ask({0x11, 10});
  EXPECT_EQ(ask({0x5E}), (Bytes{0x5E, 9})) << "the configured one is not in use yet";
}

TEST_F(LssSlaveTest, OnlyASelectedSlaveIsConfigured) {
  for (const int service : {0x11, 0x13, 0x15, 0x17, 0x5A, 0x5B, 0x5C, 0x5D, 0x5E}) {
    EXPECT_EQ(ask({static_cast<std::uint8_t>(service)}), std::nullopt) << service;
  }
  EXPECT_EQ(slave.pending_node(), 0);
  EXPECT_TRUE(storage.stored.empty());
}

TEST_F(LssSlaveTest, IdentifyRemoteSlaveIsAnsweredIfRevisionAndSerialAreWithinTheLimits) {
  struct Limits {
    std::uint8_t lowest_revision, highest_revision;  // upper halves
    std::uint8_t lowest_serial, highest_serial;      // highest bytes
    bool is_within;
  };
  for (const Limits& limits :
       {Limits{1, 1, 0x89, 0x8A, true}, Limits{0, 2, 0x00, 0xFF, true}, Limits{2, 3, 0x00, 0xFF, false},
        Limits{0, 0, 0x00, 0xFF, false}, Limits{0, 2, 0x8A, 0xFF, false}, Limits{0, 2, 0x00, 0x89, false}}) {
    EXPECT_EQ(ask({0x46, 0x4C, 0x4F, 0x52, 0x50}), std::nullopt);
    EXPECT_EQ(ask({0x47, 0x01}), std::nullopt);
    EXPECT_EQ(ask({0x48, 0, 0, limits.lowest_revision}), std::nullopt);
    EXPECT_EQ(ask({0x49, 0, 0, limits.highest_revision}), std::nullopt);
    EXPECT_EQ(ask({0x4A, 0, 0, 0, limits.lowest_serial}), std::nullopt);
    EXPECT_EQ(ask({0x4B, 0, 0, 0, limits.highest_serial}),
              limits.is_within ? std::optional(Bytes{0x4F}) : std::nullopt);
  }
  EXPECT_EQ(ask({0x4B, 0, 0, 0, 0xFF}), std::nullopt) << "the last condition alone";
  EXPECT_FALSE(is_selected());
}

TEST_F(LssSlaveTest, IdentifyNonConfiguredIsAnsweredWithoutANodeIdOnly) {
  EXPECT_EQ(ask({0x4C}), Bytes{0x50});
  node = 5;
  EXPECT_EQ(ask({0x4C}), std::nullopt);
  node = 0;
  select();
  ask({0x11, 5});
  EXPECT_EQ(ask({0x4C}), std::nullopt) << "it has one";
}

TEST_F(LssSlaveTest, FastscanFindsTheAddressBitByBit) {
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 0x80}), Bytes{0x4F});
  for (std::uint8_t sub = 0; sub < 4; ++sub) {
    std::uint32_t number = 0;
    const auto scan = [&](std::uint8_t bit, std::uint8_t next) {
      return ask({0x51, static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8U),
                  static_cast<std::uint8_t>(number >> 16U), static_cast<std::uint8_t>(number >> 24U), bit, sub, next});
    };
    for (std::uint8_t bit = 32; bit-- > 0;) {
      const std::optional<Bytes> answer = scan(bit, sub);
      EXPECT_TRUE(!answer || *answer == Bytes{0x4F});
      number |= answer ? 0U : std::uint32_t{1} << bit;
    }
    EXPECT_EQ(number, slave_address.at(sub));
    EXPECT_FALSE(is_selected());
    EXPECT_EQ(scan(0, static_cast<std::uint8_t>((sub + 1) % 4)), Bytes{0x4F});
  }
  EXPECT_TRUE(is_selected());
}

TEST_F(LssSlaveTest, FastscanAsksForOneNumberAfterTheOther) {
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 0x80}), Bytes{0x4F});
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 31, 1, 1}), std::nullopt) << "the vendor comes first";
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 31, 0, 0}), Bytes{0x4F});
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 32, 0, 0}), std::nullopt) << "no bit";
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 31, 4, 4}), std::nullopt) << "no number";
  EXPECT_EQ(ask({0x51, 0x4C, 0x4F, 0x52, 0x50, 0, 0, 4}), std::nullopt) << "no number";
}

TEST_F(LssSlaveTest, FastscanIsForWaitingSlavesWithoutANodeId) {
  node = 1;
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 0x80}), std::nullopt);
  node = 0;
  select();
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 0x80}), std::nullopt);
}

TEST_F(LssSlaveTest, FramesThatAreNotOfTheMasterAreIgnored) {
  select();
  EXPECT_FALSE(slave.serve({0x7E4, 8, {0x5E}}, slave_address, node, storage));
  EXPECT_FALSE(slave.serve({0x7E5, 7, {0x5E}}, slave_address, node, storage));
  EXPECT_FALSE(slave.serve({0x7E5, 0, {}}, slave_address, node, storage));
}

TEST_F(LssSlaveTest, ServesTheExamplesOfTheProtocol) {
  struct Example {
    std::string request;
    std::string answer;
  };
  const auto serve = [this](const Example& example) {
    EXPECT_TRUE(test::is_documented(example.request)) << example.request;
    EXPECT_TRUE(example.answer.empty() || test::is_documented(example.answer)) << example.answer;
    const std::optional<CanFrame> answer = slave.serve(test::frame(example.request), slave_address, node, storage);
    EXPECT_EQ(answer ? test::text(*answer) : "", example.answer);
  };
  serve({"7E5 [8] 51 00 00 00 00 80 00 00", "7E4 [8] 4F 00 00 00 00 00 00 00"});
  serve({"7E5 [8] 51 4C 4F 52 50 00 00 01", "7E4 [8] 4F 00 00 00 00 00 00 00"});
  select();
  serve({"7E5 [8] 11 03 00 00 00 00 00 00", "7E4 [8] 11 00 00 00 00 00 00 00"});
  serve({"7E5 [8] 17 00 00 00 00 00 00 00", "7E4 [8] 17 00 00 00 00 00 00 00"});
  serve({"7E5 [8] 04 00 00 00 00 00 00 00", ""});
  EXPECT_EQ(slave.pending_node(), 3);
}

TEST_F(LssSlaveTest, AnyBytesLeaveItInAStateThatTheStandardHas) {
  constexpr unsigned seed = 305;
  std::mt19937 random(seed);
  const std::set<unsigned> answers{0x11, 0x13, 0x17, 0x44, 0x4F, 0x50, 0x5A, 0x5B, 0x5C, 0x5D, 0x5E};
  for (unsigned i = 0; i < 200'000; ++i) {
    Bytes data{};
    for (std::uint8_t& byte : data) {
      byte = static_cast<std::uint8_t>(random() % 3 == 0 ? random() : random() % 4);
    }
    if (i % 2 == 0) {  // a service, often with the slave's own number
      data[0] = static_cast<std::uint8_t>(random() % 0x60);
      const std::uint32_t number = slave_address.at(random() % 4);
      for (unsigned byte = 0; byte < 4; ++byte) {
        data.at(1 + byte) = static_cast<std::uint8_t>(number >> (8 * byte));
      }
    }
    node = static_cast<std::uint8_t>(random() % 3);
    storage.stored.clear();
    const bool was_selected = slave.state() == lss::State::configuration;
    const std::optional<Bytes> answer = ask(data);
    ASSERT_TRUE(!answer || answers.contains((*answer)[0])) << "seed " << seed << ", frame " << i;
    ASSERT_LE(slave.pending_node(), max_node_id);
    ASSERT_TRUE(storage.stored.empty() || was_selected);
  }
}

}  // namespace
}  // namespace proleg::canopen
