#include "host/transport/bus_address.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

using Kind = BusAddress::Kind;

TEST(BusAddress, IsReadFromAWord) {
  const std::vector<std::pair<std::string, BusAddress>> examples{
      {"can0", {Kind::can, "can0", 0, {}}},
      {"vcan-proleg_12", {Kind::can, "vcan-proleg_12", 0, {}}},
      {"serial:/dev/ttyUSB0", {Kind::serial, "/dev/ttyUSB0", 1'000'000, {}}},
      {"serial:/dev/serial/by-id/usb-x@y-if00@115200", {Kind::serial, "/dev/serial/by-id/usb-x@y-if00", 115'200, {}}},
      {"bluetooth:00:AA:01:00:0f:42", {Kind::bluetooth, "", 1, {0, 0xAA, 1, 0, 0x0F, 0x42}}},
      {"bluetooth:00:AA:01:00:00:42/30", {Kind::bluetooth, "", 30, {0, 0xAA, 1, 0, 0, 0x42}}},
      {"tcp:robot.local:20000", {Kind::tcp, "robot.local", 20'000, {}}},
      {"tcp:[::1]:1", {Kind::tcp, "::1", 1, {}}},
      {"fd:3", {Kind::descriptor, "", 3, {}}},
      {"sim:a b:c.simulation.xml", {Kind::simulation, "a b:c.simulation.xml", 0, {}}},
      {"auto", {Kind::automatic, "", 0, {}}},
  };
  for (const auto& [word, address] : examples) {
    EXPECT_EQ(parse_bus_address(word), address) << word;
    EXPECT_EQ(parse_bus_address(bus_address_text(address)), address) << word;
  }
}

TEST(BusAddress, IsRejectedInOneLineThatNamesWhatIsExpected) {
  const std::vector<std::pair<std::string, std::string>> examples{
      {"", "a bus: a CAN interface"},
      {"can0 ", "a bus: a CAN interface"},
      {"an_interface_of_20_chars", "a bus: a CAN interface"},
      {"/dev/ttyUSB0", "a serial line is 'serial:/dev/ttyUSB0'"},
      {"usb:1", "a bus: a CAN interface"},
      {"serial:", "serial:DEVICE[@BAUD]"},
      {"serial:@9600", "serial:DEVICE[@BAUD]"},
      {"serial:/dev/ttyS0@", "a baud rate that Linux has: 9600,"},
      {"serial:/dev/ttyS0@1000001", "a baud rate that Linux has: 9600,"},
      {"bluetooth:", "bluetooth:AA:BB:CC:DD:EE:FF[/CHANNEL]"},
      {"bluetooth:00:AA:01:00:00", "bluetooth:AA:BB:CC:DD:EE:FF[/CHANNEL]"},
      {"bluetooth:00-AA-01-00-00-42", "bluetooth:AA:BB:CC:DD:EE:FF[/CHANNEL]"},
      {"bluetooth:0G:AA:01:00:00:42", "bluetooth:AA:BB:CC:DD:EE:FF[/CHANNEL]"},
      {"bluetooth:00:AA:01:00:00:421", "bluetooth:AA:BB:CC:DD:EE:FF[/CHANNEL]"},
      {"bluetooth:00:AA:01:00:00:42/0", "an RFCOMM channel from 1 to 30"},
      {"bluetooth:00:AA:01:00:00:42/31", "an RFCOMM channel from 1 to 30"},
      {"tcp:", "tcp:HOST:PORT"},
      {"tcp::1", "tcp:HOST:PORT"},
      {"tcp:::1:1", "tcp:HOST:PORT"},
      {"tcp:host", "tcp:HOST:PORT"},
      {"tcp:host:0", "a port from 1 to 65535"},
      {"tcp:host:65536", "a port from 1 to 65535"},
      {"tcp:host:-1", "a port from 1 to 65535"},
      {"fd:", "a descriptor from 0 to 65535"},
      {"fd:x", "a descriptor from 0 to 65535"},
      {"sim:", "sim:FILE.simulation.xml"},
      {"can\n0", "a bus: a CAN interface"},
  };
  for (const auto& [word, expected] : examples) {
    const std::string message = message_of<InputError>([&word = word] { static_cast<void>(parse_bus_address(word)); });
    EXPECT_NE(message.find("bus: found '"), std::string::npos) << message;
    EXPECT_NE(message.find(expected), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace proleg::host
