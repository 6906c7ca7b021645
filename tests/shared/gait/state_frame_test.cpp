#include "shared/gait/state_frame.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>

#include "robot.hpp"

namespace proleg {
namespace {

constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t highest = std::numeric_limits<std::int32_t>::max();

constexpr InternalValue values[] = {
    {"angle", Unit::degree, 0, "an angle"},
    {"phase", Unit::phase_degree, 0, "a phase"},
    {"count", Unit::count, 0, "a count"},
};
constexpr FrameField two_bytes_each[] = {{0, 2}, {1, 2}, {2, 2}};
constexpr FrameField one_byte_each[] = {{0, 1}, {1, 1}, {2, 1}};
constexpr FrameField phase_in_full[] = {{1, 4}, {2, 2}};
constexpr FrameField three_byte_angle[] = {{0, 3}, {1, 3}};
constexpr Declaration narrow{100, "narrow", "test", {}, values, two_bytes_each};
constexpr Declaration narrowest{101, "narrowest", "test", {}, values, one_byte_each};
constexpr Declaration full{102, "full", "test", {}, values, phase_in_full};
constexpr Declaration wide{103, "wide", "test", {}, values, three_byte_angle};

using Values = std::array<std::int32_t, 3>;

StateFrame packed(const Declaration& declaration, const Values& state) {
  StateFrame frame;
  pack(declaration, state.data(), frame);
  return frame;
}

// docs/protocol.md: an angle on 16 bits has 90 degrees = 16384; little-endian.
TEST(StateFrame, HasTheBytesOfTheWorkedExample) {
  const StateFrame frame = packed(narrow, {test::degrees(45), test::phase(-90), 0x1234});
  const std::array<std::uint8_t, 8> expected = {0x00, 0x20, 0x00, 0xC0, 0x34, 0x12, 0x00, 0x00};
  EXPECT_EQ(frame.bytes, expected);
}

// 55 degrees of phase on four bytes and 40 degrees of amplitude on two: 40 / 90 * 16384 = 7281.8.
TEST(StateFrame, OfTheCoupledOscillatorHasTheBytesOfTheWorkedExample) {
  const Declaration& declaration = test::algorithm(test::coupled).declaration();
  std::array<std::int32_t, max_internal_values> state{};
  state[0] = test::phase(55);
  state[3] = test::degrees(40);
  StateFrame frame;
  pack(declaration, state.data(), frame);
  const std::array<std::uint8_t, 8> expected = {0xC7, 0x71, 0x1C, 0x27, 0x72, 0x1C, 0x00, 0x00};
  EXPECT_EQ(frame.bytes, expected);
}

TEST(StateFrame, LeavesContactsFlagsAndLabelAlone) {
  StateFrame frame;
  frame.bytes = {1, 2, 3, 4, 5, 6, 0xA5, 0x5A};
  pack(narrow, Values{}.data(), frame);
  EXPECT_EQ(frame.flags(), 0xA5);
  EXPECT_EQ(frame.label(), 0x5A);
}

TEST(StateFrame, RoundsAnglesToTheNearestStepOfTheWire) {
  std::mt19937 random(1);
  for (const Declaration* declaration : {&narrow, &narrowest, &wide}) {
    const unsigned dropped = 32U - 8U * declaration->frame[0].bytes;
    for (int i = 0; i < 20000; ++i) {
      const auto angle = static_cast<std::int32_t>(random()) / 2;
      const std::int64_t heard = unpack(*declaration, 0, packed(*declaration, {angle, 0, 0}));
      ASSERT_LE(std::abs(heard - angle), std::int64_t{1} << (dropped - 1)) << angle;
    }
  }
}

TEST(StateFrame, RoundsHalfAStepUp) {
  const auto heard = [](std::int32_t angle) { return unpack(narrow, 0, packed(narrow, {angle, 0, 0})) >> 16; };
  EXPECT_EQ(heard(0x7FFF), 0);
  EXPECT_EQ(heard(0x8000), 1);
  EXPECT_EQ(heard(-0x8000), 0);
  EXPECT_EQ(heard(-0x8001), -1);
}

TEST(StateFrame, SaturatesAnglesAtTheEndsOfTheWire) {
  EXPECT_EQ(unpack(narrow, 0, packed(narrow, {highest, 0, 0})), 0x7FFF0000);
  EXPECT_EQ(unpack(narrow, 0, packed(narrow, {lowest, 0, 0})), lowest);
  EXPECT_EQ(unpack(narrowest, 0, packed(narrowest, {highest, 0, 0})), 0x7F000000);
  EXPECT_EQ(unpack(wide, 0, packed(wide, {highest, 0, 0})), 0x7FFFFF00);
}

TEST(StateFrame, WrapsPhasesAroundTheTurn) {
  std::mt19937 random(2);
  for (int i = 0; i < 20000; ++i) {
    const auto phase = static_cast<std::int32_t>(random());
    const std::int32_t heard = unpack(narrow, 1, packed(narrow, {0, phase, 0}));
    const auto away = static_cast<std::int32_t>(static_cast<std::uint32_t>(heard) - static_cast<std::uint32_t>(phase));
    ASSERT_LE(std::abs(away), 1 << 15) << phase;
  }
  EXPECT_EQ(unpack(narrow, 1, packed(narrow, {0, highest, 0})), lowest);
  EXPECT_EQ(unpack(narrow, 1, packed(narrow, {0, -1, 0})), 0);
}

TEST(StateFrame, CarriesAPhaseOfFourBytesInFull) {
  std::mt19937 random(3);
  for (int i = 0; i < 1000; ++i) {
    const auto phase = static_cast<std::int32_t>(random());
    ASSERT_EQ(unpack(full, 0, packed(full, {0, phase, 0})), phase);
  }
}

TEST(StateFrame, CarriesTheLowBytesOfCountsAndSaturatesThem) {
  const auto heard = [](std::int32_t count) { return unpack(narrow, 2, packed(narrow, {0, 0, count})); };
  EXPECT_EQ(heard(0), 0);
  EXPECT_EQ(heard(1), 1);
  EXPECT_EQ(heard(0xFFFF), 0xFFFF);
  EXPECT_EQ(heard(0x10000), 0xFFFF);
  EXPECT_EQ(heard(highest), 0xFFFF);
  EXPECT_EQ(heard(-1), 0);
  EXPECT_EQ(unpack(narrowest, 2, packed(narrowest, {0, 0, 256})), 255);
}

// A value that was received and is sent again must not change, or a neighbour's neighbour would receive another value.
TEST(StateFrame, IsUnchangedByUnpackingAndPackingAgain) {
  std::mt19937 random(4);
  for (const Declaration* declaration : {&narrow, &narrowest, &full, &wide}) {
    for (int i = 0; i < 5000; ++i) {
      const StateFrame frame =
          packed(*declaration, {static_cast<std::int32_t>(random()), static_cast<std::int32_t>(random()),
                                static_cast<std::int32_t>(random())});
      StateFrame again = frame;
      for (std::size_t field = 0; field < declaration->frame.size(); ++field) {
        repack(*declaration, field, unpack(*declaration, field, frame), again);
      }
      ASSERT_EQ(again, frame) << declaration->name;
    }
  }
}

TEST(StateFrame, RepackChangesNoOtherField) {
  const StateFrame before = packed(narrow, {test::degrees(10), test::phase(20), 30});
  StateFrame after = before;
  repack(narrow, 1, test::phase(77), after);
  EXPECT_EQ(unpack(narrow, 0, after), unpack(narrow, 0, before));
  EXPECT_NE(unpack(narrow, 1, after), unpack(narrow, 1, before));
  EXPECT_EQ(unpack(narrow, 2, after), unpack(narrow, 2, before));
}

}  // namespace
}  // namespace proleg
