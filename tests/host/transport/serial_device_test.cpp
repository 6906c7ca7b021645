#include "host/transport/serial_device.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "host/transport/descriptor.hpp"

namespace proleg::host {
namespace {

TEST(SerialDevice, IsSeenWithTheProgramsThatHaveItOpen) {
  const Descriptor master(posix_openpt(O_RDWR | O_NOCTTY));
  ASSERT_TRUE(master.is_open());
  ASSERT_EQ(unlockpt(master.number()), 0);
  const std::string path = ptsname(master.number());
  const std::string own = "(process " + std::to_string(getpid()) + ")";
  const auto is_own = [&own](const std::string& program) { return program.ends_with(own); };
  SerialDevice device = read_serial_device(path);
  EXPECT_TRUE(device.exists);
  EXPECT_TRUE(device.is_character_device);
  EXPECT_TRUE(device.may_use);
  EXPECT_FALSE(device.group.empty());
  EXPECT_TRUE(std::ranges::none_of(device.programs, is_own)) << "it is not opened";
  const Descriptor line(open(path.c_str(), O_RDWR | O_NOCTTY));
  ASSERT_TRUE(line.is_open());
  device = read_serial_device(path);
  EXPECT_TRUE(std::ranges::any_of(device.programs, is_own));
}

TEST(SerialDevice, ThatDoesNotExistOrIsAFile) {
  EXPECT_FALSE(read_serial_device("/dev/missing").exists);
  const SerialDevice file = read_serial_device("/etc/passwd");
  EXPECT_TRUE(file.exists);
  EXPECT_FALSE(file.is_character_device);
}

}  // namespace
}  // namespace proleg::host
