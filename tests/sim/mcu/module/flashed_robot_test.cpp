// A robot of chips that were flashed takes another image from a host, as the robot on the table does.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "changed_image.hpp"
#include "firmware/module/module_identity.hpp"
#include "shared/broadcast/image_sender.hpp"
#include "sim/hardware_loop/module_rack.hpp"
#include "sim/live/live_robot.hpp"
#include "sim/mcu/module/flashed_chip.hpp"
#include "virtual_robot.hpp"

namespace proleg::test {
namespace {

using broadcast::ImageSender;
using broadcast::ReceiverState;
using sim::BusTime;

constexpr std::array<unsigned, 2> chips{1, 3};
constexpr std::uint32_t slot_a = 0x0802'0000;  // docs/board.md
constexpr std::uint32_t slot_b = 0x0808'0000;
constexpr std::uint8_t session = 7;

/// The host's controller, behind the adapter of the robot.
class Adapter final : public CanPort {
 public:
  explicit Adapter(sim::LiveRobot& robot) : robot_(robot) {}
  [[nodiscard]] bool send(const CanFrame& frame) override {
    constexpr std::size_t mailboxes = 3;
    return robot_.waiting() < mailboxes && robot_.send(frame);
  }
  [[nodiscard]] CanStatus status() override { return {}; }
  void recover() override {}

 private:
  sim::LiveRobot& robot_;
};

class FlashedRobot : public testing::Test {
 protected:
  sim::LiveRobotOptions options() {
    sim::LiveRobotOptions made;
    made.make_module = [this](const sim::ModuleParts& parts) -> std::unique_ptr<sim::JointModule> {
      if (std::ranges::find(chips, parts.joint) == chips.end()) {
        return nullptr;
      }
      sim::VirtualModuleOptions module;
      module.flash = &flashed.flash;
      return std::make_unique<sim::VirtualModule>(parts, sim::flashed_image(), module);
    };
    made.on_frame = [this](const sim::Transmission& transmission, bool is_own) {
      if (!is_own && sender != nullptr) {
        sender->receive(transmission.end / 1'000, transmission.frame);
      }
    };
    made.on_sent = [this](BusTime time, const CanFrame& /*frame*/, std::uint32_t /*source*/) {
      if (sender != nullptr) {
        sender->transmitted(time / 1'000);
      }
    };
    return made;
  }

  [[nodiscard]] sim::VirtualModule& chip(unsigned joint) {
    return dynamic_cast<sim::VirtualModule&>(robot.module(joint));
  }
  [[nodiscard]] std::vector<std::uint8_t> memory(unsigned joint, std::uint32_t address, std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    chip(joint).chip().read(address, bytes);
    return bytes;
  }
  void run_until_state(ImageSender::State state) {
    const BusTime end = robot.now() + 30'000'000'000U;
    while (sender->state() != state && robot.now() < end) {
      const Microseconds deadline = sender->next_deadline();
      robot.advance_to_frame(std::min(end, deadline == never ? end : deadline * 1'000));
      if (sender->next_deadline() <= robot.now() / 1'000) {
        sender->poll(robot.now() / 1'000);
      }
    }
    ASSERT_EQ(sender->state(), state);
  }

  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  const sim::FlashedChip flashed = sim::flash_chip(sim::flashed_image(), PROLEG_BOOTLOADER, {});
  ImageSender* sender = nullptr;
  sim::LiveRobot robot{scenario, options()};
};

TEST_F(FlashedRobot, TakesAnotherImageByBroadcastWhileItsProgramsRun) {
  const std::vector<std::uint8_t> before = sim::flashed_image().image();
  const std::vector<std::uint8_t> after = sim::changed(sim::flashed_image(), sim::newer_version());
  std::vector<broadcast::Target> targets;
  for (const unsigned joint : chips) {
    targets.push_back({.serial = firmware::serial_number(sim::make_identity(scenario, joint))});
  }
  robot.advance_to(1'000'000'000);
  Adapter adapter(robot);
  ImageSender host(adapter, after, targets, {.session = session});
  sender = &host;
  host.start(robot.now() / 1'000);
  run_until_state(ImageSender::State::complete);
  host.install(robot.now() / 1'000);
  run_until_state(ImageSender::State::done);
  for (const broadcast::Target& target : targets) {
    EXPECT_FALSE(target.is_lost);
    EXPECT_EQ(target.status.state, ReceiverState::installed);
  }
  ASSERT_TRUE(robot.send(broadcast::leave_frame(session)));
  robot.advance_to(robot.now() + 1'000'000'000);
  for (const unsigned joint : chips) {
    EXPECT_EQ(memory(joint, slot_a, after.size()), after);
    EXPECT_EQ(memory(joint, slot_b, before.size()), before) << "the backup";
    EXPECT_EQ(memory(joint, slot_a + 128 * 1024 - 16, 4), (std::vector<std::uint8_t>{0x0D, 0x60, 0x0D, 0x60}))
        << "it runs, and has confirmed itself";
  }
}

}  // namespace
}  // namespace proleg::test
