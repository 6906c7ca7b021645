// What can be seen without a device: tests/lab/gamepad.lab.py has some.

#include "host/remote/event_devices.hpp"

#include <gtest/gtest.h>

#include "shared/computer/output/output.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::host {
namespace {

// As Linux shows them in /sys/class/input/eventN/device/capabilities on a 64-bit computer.
constexpr const char* keyboard = "402000000 3803078f800d001 feffffdfffefffff fffffffffffffffe";
constexpr const char* mouse = "ffff0000 0 0 0 0";
constexpr const char* xbox_pad = "7cdb000000000000 0 0 0 0";
constexpr const char* joystick = "fff00000000 0 0 0 0";
constexpr const char* touchpad = "e520 10000 0 0 0 0";

TEST(InputCapabilities, FindTheBitsOfTheKernelsBitmap) {
  EXPECT_TRUE(has_bit("1", 0));
  EXPECT_TRUE(has_bit("8000000000000000", 63));
  EXPECT_TRUE(has_bit("1 0", 64));
  EXPECT_FALSE(has_bit("1 0", 0));
  EXPECT_FALSE(has_bit("1", 64));
  EXPECT_FALSE(has_bit("", 0));
  EXPECT_FALSE(has_bit("no number", 0));
}

TEST(InputCapabilities, TellGamepadsFromKeyboardsAndMice) {
  EXPECT_TRUE(is_remote_control({"Microsoft X-Box 360 pad", xbox_pad, "0"}));
  EXPECT_TRUE(is_remote_control({"Logitech Extreme 3D", joystick, "0"}));
  EXPECT_FALSE(is_remote_control({"AT Translated Set 2 keyboard", keyboard, "0"}));
  EXPECT_FALSE(is_remote_control({"Logitech Mouse", mouse, "903"}));
  EXPECT_FALSE(is_remote_control({"SynPS/2 Touchpad", touchpad, "0"}));
  EXPECT_FALSE(is_remote_control({"Gaming mouse", xbox_pad, "3"}));
}

TEST(InputCapabilities, KnowAllPartsOfAWiimote) {
  EXPECT_TRUE(is_remote_control({"Nintendo Wii Remote", "", ""}));
  EXPECT_TRUE(is_remote_control({"Nintendo Wii Remote Accelerometer", "", ""}));
}

TEST(InputCapabilities, AreReadFromTheFolderOfTheKernel) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "capabilities");
  write_file(folder / "name", "Pad\n");
  write_file(folder / "capabilities/key", "1 0\n");
  const InputCapabilities capabilities = read_capabilities(folder.path());
  EXPECT_EQ(capabilities.name, "Pad");
  EXPECT_EQ(capabilities.keys, "1 0");
  EXPECT_EQ(capabilities.relatives, "");
}

class Listener final : public DeviceListener {
 public:
  void plugged(const InputDevice& device) override { FAIL() << device.name; }
  void moved(const ElementPlace& /*element*/, double /*position*/) override {}
  void unplugged(DeviceId /*device*/) override {}
  void problems_changed(const std::vector<std::string>& lines) override { problems = lines; }

  std::vector<std::string> problems;
};

class Devices : public testing::Test {
 protected:
  void declare(const std::string& name, const std::string& title) {
    std::filesystem::create_directories(folder / ("class/" + name + "/device/capabilities"));
    write_file(folder / ("class/" + name + "/device/name"), title + "\n");
  }

  const TemporaryFolder folder;
  Listener listener;
  EventDevices devices{listener, {folder / "input", folder / "class"}};
};

TEST_F(Devices, AreLookedForUntilTheirFolderIsThere) {
  devices.read();
  EXPECT_FALSE(devices.is_watching());
  std::filesystem::create_directory(folder / "input");
  devices.read();
  EXPECT_TRUE(devices.is_watching());
  std::filesystem::remove(folder / "input");
  devices.read();
  EXPECT_FALSE(devices.is_watching());
}

TEST_F(Devices, ThatAreNoneAreNamedWithAReason) {
  std::filesystem::create_directory(folder / "input");
  devices.read();
  declare("event3", "Nintendo Wii Remote");
  write_file(folder / "input/event3", "");
  devices.read();
  ASSERT_EQ(listener.problems.size(), 1U);
  EXPECT_EQ(listener.problems[0],
            (folder / "input/event3").string() + " (Nintendo Wii Remote): Inappropriate ioctl for device");
  std::filesystem::remove(folder / "input/event3");
  devices.read();
  EXPECT_TRUE(listener.problems.empty());
}

TEST_F(Devices, ThatAreNoGamepadsAreNotOpened) {
  std::filesystem::create_directory(folder / "input");
  declare("event4", "A keyboard");
  write_file(folder / "input/event4", "");
  devices.read();
  EXPECT_TRUE(listener.problems.empty());
}

}  // namespace
}  // namespace proleg::host
