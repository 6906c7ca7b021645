// What the kernel says of a CAN interface, from messages as rtnetlink(7) and linux/can/netlink.h define them.

#include "host/transport/can_interface.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

namespace proleg::host {
namespace {

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, const Bytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); }
Bytes word(std::uint32_t value) {
  Bytes bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}
Bytes half_word(std::uint16_t value) {
  Bytes bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}
Bytes text(const std::string& value) {
  Bytes bytes(value.size() + 1);
  std::memcpy(bytes.data(), value.c_str(), bytes.size());
  return bytes;
}

/// Length and type, 16 bits each, then the value, filled up to four bytes.
Bytes attribute(std::uint16_t type, const Bytes& value) {
  Bytes bytes = half_word(static_cast<std::uint16_t>(4 + value.size()));
  append(bytes, half_word(type));
  append(bytes, value);
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

// Numbers of the kernel's interface.
constexpr std::uint16_t new_link = 16;
constexpr std::uint16_t can_hardware = 280;
constexpr std::uint32_t up = 1;
constexpr std::uint16_t queue_length = 13;
constexpr std::uint16_t link_info = 18;
constexpr std::uint16_t info_kind = 1;
constexpr std::uint16_t info_data = 2;
constexpr std::uint16_t can_bit_timing = 1;
constexpr std::uint16_t can_state = 4;
constexpr std::uint16_t can_mode = 5;
constexpr std::uint16_t can_restart = 6;
constexpr std::uint16_t can_counters = 8;

Bytes message(std::uint16_t hardware, std::uint32_t flags, const Bytes& attributes) {
  Bytes body = half_word(0);  // family
  append(body, half_word(hardware));
  append(body, word(7));  // index
  append(body, word(flags));
  append(body, word(0));
  append(body, attributes);
  Bytes bytes = word(static_cast<std::uint32_t>(16 + body.size()));
  append(bytes, half_word(new_link));
  append(bytes, half_word(0));
  append(bytes, word(0));
  append(bytes, word(0));
  append(bytes, body);
  return bytes;
}

Bytes controller_message(std::uint32_t bit_rate, std::uint32_t mode_flags, std::uint32_t state) {
  Bytes timing = word(bit_rate);
  timing.resize(32);  // eight words
  Bytes mode = word(0xFFFFFFFF);
  append(mode, word(mode_flags));
  Bytes counters = half_word(96);
  append(counters, half_word(3));
  Bytes data = attribute(can_bit_timing, timing);
  append(data, attribute(can_mode, mode));
  append(data, attribute(can_state, word(state)));
  append(data, attribute(can_restart, word(100)));
  append(data, attribute(can_counters, counters));
  Bytes info = attribute(info_kind, text("can"));
  append(info, attribute(info_data, data));
  Bytes attributes = attribute(queue_length, word(10));
  append(attributes, attribute(link_info, info));
  return message(can_hardware, up, attributes);
}

TEST(CanInterface, IsReadFromTheMessageOfTheKernel) {
  constexpr std::uint32_t listen_only = 2;
  constexpr std::uint32_t passive = 2;
  const auto found = parse_link_message(controller_message(500'000, listen_only, passive));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->kind, "can");
  EXPECT_TRUE(found->is_can);
  EXPECT_TRUE(found->is_up);
  EXPECT_EQ(found->queue_length, 10U);
  EXPECT_EQ(found->bit_rate, 500'000U);
  EXPECT_TRUE(found->is_listen_only);
  EXPECT_EQ(found->state, CanState::error_passive);
  EXPECT_EQ(found->restart_ms, 100U);
  EXPECT_EQ(found->transmit_errors, 96U);
  EXPECT_EQ(found->receive_errors, 3U);
}

TEST(CanInterface, HasNoBitRateWhileNoneIsSetAndAVirtualOneNever) {
  EXPECT_EQ(parse_link_message(controller_message(0, 0, 0))->bit_rate, std::nullopt);
  const auto found =
      parse_link_message(message(can_hardware, up, attribute(link_info, attribute(info_kind, text("vcan")))));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->kind, "vcan");
  EXPECT_EQ(found->bit_rate, std::nullopt);
  EXPECT_EQ(found->state, std::nullopt);
}

TEST(CanInterface, DamagedMessagesDoNoHarm) {
  const std::uint64_t seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  const Bytes good = controller_message(1'000'000, 0, 0);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(parse_link_message(std::span(good).first(size)).has_value()) << size;
  }
  for (unsigned run = 0; run < 20'000; ++run) {
    Bytes bad = good;
    for (unsigned i = 0; i < 3; ++i) {
      bad.at(random() % bad.size()) = static_cast<std::byte>(random());
    }
    (void)parse_link_message(bad);
  }
}

TEST(CanInterface, TheLoopbackInterfaceIsNone) {
  const auto found = read_can_interface("lo");
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(found->is_can);
  EXPECT_FALSE(read_can_interface("missing77").has_value());
}

}  // namespace
}  // namespace proleg::host
