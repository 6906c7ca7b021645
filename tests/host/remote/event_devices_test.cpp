// What can be seen without a device: tests/lab/gamepad.lab.py has some.

#include "host/remote/event_devices.hpp"

#include <gtest/gtest.h>

#include "shared/computer/output/output.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::host {
namespace {

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
