// The images of all boards, each in a chip with the crystal and the pins of its board; and images in chips of other
// boards.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "firmware/stm32f405/boards/boards.hpp"
#include "shared/image/board_names.hpp"
#include "shared/image/image_header.hpp"
#include "sim/mcu/module/flashed_chip.hpp"
#include "tests/support/message_of.hpp"
#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

using stm32f405::BoardProfile;
namespace boards = stm32f405::boards;

constexpr std::array<std::uint32_t, 3> chip_id{0x0123'4567, 0x89AB'CDEF, 0x5A5A'0F0F};

/// A file that the preset stm32f405 builds for a board.
std::filesystem::path built(const BoardProfile& board, const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(PROLEG_IMAGE).parent_path();
  return (board.id == boards::reference.id ? folder : folder / image::board_name(board.id)) / name;
}

FirmwareImage image_of(const BoardProfile& board) { return FirmwareImage(built(board, "proleg_stm32f405.elf")); }

class EveryBoard : public testing::TestWithParam<const BoardProfile*> {};

TEST_P(EveryBoard, HasAnImageThatNamesIt) {
  const FirmwareImage image = image_of(*GetParam());
  EXPECT_EQ(&image.board(), GetParam());
  EXPECT_EQ(image::decode(image.image()).header.board_id, GetParam()->id);
}

TEST_P(EveryBoard, IsFlashedThroughItsBootloader) {
  const FlashedChip chip = flash_chip(image_of(*GetParam()), built(*GetParam(), "proleg_boot_stm32f405.elf"), chip_id);
  EXPECT_TRUE(chip.start_time.has_value());
  EXPECT_TRUE(chip.problems.empty());
}

TEST_P(EveryBoard, MovesItsJointsAsTheReferenceBoardDoes) {
  const FirmwareImage image = image_of(*GetParam());
  const Scenario scenario = shipped("obstacle/reflex");  // with touch sensors
  constexpr std::uint32_t ticks = 300;
  VirtualRobot robot(scenario, {}, VirtualRobot::all, nullptr, image);
  robot.run_to(ticks);
  VirtualRobot reference(scenario);
  reference.run_to(ticks);
  EXPECT_EQ(robot.loop().differences(), 0U);
  EXPECT_EQ(robot.loop().setpoint_hash().hex(), reference.loop().setpoint_hash().hex());
  EXPECT_EQ(robot.loop().servo_hash().hex(), reference.loop().servo_hash().hex());
  EXPECT_TRUE(robot.loop().failures().empty());
}

INSTANTIATE_TEST_SUITE_P(Boards, EveryBoard, testing::ValuesIn(boards::all), [](const auto& tested) {
  std::string name(image::board_name(tested.param->id));
  std::ranges::replace(name, '-', '_');
  return name;
});

/// What a robot reports whose chips are on another board than the image is for; nothing may move.
std::string problems_of(const BoardProfile& image_board, const BoardProfile& chip_board) {
  const FirmwareImage image = image_of(image_board);
  Bus bus;
  const auto readings = [] { return ServoReadings{}; };
  firmware::ModuleIdentity identity;
  identity.node = 1;
  identity.unique_id = chip_id;
  VirtualModule module({bus, 0, identity, Crystal(), [] { return std::uint8_t{0}; }, readings, readings, false}, image,
                       {.board = &chip_board});
  unsigned frames = 0;
  bus.set_frame_listener([&frames](const Transmission& /*transmission*/) { ++frames; });
  module.power_on(0);
  constexpr BusTime end = 300'000'000;
  while (bus.now() < end) {
    const BusTime next = std::min({end, bus.next_event(), module.next_event()});
    bus.advance_to(next);
    if (module.next_event() <= next) {
      module.advance_to(next, bus.earliest_delivery());
    }
  }
  EXPECT_FALSE(module.pulse().has_value());
  std::string text = std::to_string(frames) + " frames";
  while (const auto problem = module.take_problem()) {
    text += "; " + *problem;
  }
  return text;
}

TEST(Boards, AnImageForASlowerCrystalIsStoppedBecauseItsClockWouldBeTooFast) {
  const std::string text = problems_of(boards::reference, boards::feather_stm32f405);
  EXPECT_EQ(text.find("0 frames; "), 0U) << text;
  EXPECT_NE(text.find("VCO input of 3 MHz: expected 1 to 2 MHz"), std::string::npos) << text;
}

TEST(Boards, AnImageForAFasterCrystalHasNoClockForCan) {
  const std::string text = problems_of(boards::feather_stm32f405, boards::reference);
  EXPECT_EQ(text.find("0 frames"), 0U) << text;
}

TEST(Boards, AnImageIsNotFlashedThroughTheBootloaderOfAnotherBoard) {
  for (const BoardProfile* const board : boards::all) {
    if (board == &boards::reference) {
      continue;
    }
    const std::string message = message_of<ElfError>([board] {
      static_cast<void>(flash_chip(image_of(*board), built(boards::reference, "proleg_boot_stm32f405.elf"), chip_id));
    });
    EXPECT_NE(message.find("found an image for board " + std::to_string(board->id) + " (" +
                           std::string(image::board_name(board->id)) + "), expected one for board 1 (reference)"),
              std::string::npos)
        << message;
  }
}

}  // namespace
}  // namespace proleg::sim
