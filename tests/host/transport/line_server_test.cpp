// Programs at the end of a serial line that this process serves.

#include "host/transport/line_server.hpp"

#include <gtest/gtest.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

#include "test_bus.hpp"

namespace proleg::host {
namespace {

using namespace test;

class LineServerTest : public testing::Test {
 protected:
  /// A program that connects to a TCP port of this computer.
  Descriptor connect_to(std::uint16_t port) {
    Descriptor client(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(client.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_TRUE(make_private(client));
    return client;
  }
  /// What comes for a program until this many bytes are there, or the line is closed.
  std::string read_from(const Descriptor& client, std::size_t count) {
    std::string text;
    bool is_over = false;
    EXPECT_TRUE(wait_for(context, [&] {
      std::array<char, 4'096> bytes{};
      const ssize_t length = read(client.number(), bytes.data(), bytes.size());
      is_over = length == 0;
      text.append(bytes.data(), length > 0 ? static_cast<std::size_t>(length) : 0U);
      return is_over || text.size() >= count;
    }));
    return text;
  }
  bool has_event(const std::string& part) const {
    return std::ranges::any_of(events, [&](const std::string& line) { return line.find(part) != std::string::npos; });
  }

  boost::asio::io_context context;
  std::string received;
  std::size_t room = 4'096;
  std::vector<std::string> events;
  LineServer server{context,
                    {[this](std::string_view bytes) {
                       EXPECT_LE(bytes.size(), room);
                       received += bytes;
                     },
                     [this] { return room; }, [this](const std::string& line) { events.push_back(line); }}};
};

TEST_F(LineServerTest, CarriesEachByteInBothDirections) {
  const Descriptor client = connect_to(server.listen("127.0.0.1", 0));
  std::string all_bytes;
  for (int byte = 0; byte < 256; ++byte) {
    all_bytes.push_back(static_cast<char>(byte));
  }
  ASSERT_EQ(write(client.number(), all_bytes.data(), all_bytes.size()), 256);
  ASSERT_TRUE(wait_for(context, [&] { return received.size() == 256; }));
  EXPECT_EQ(received, all_bytes);
  server.send(all_bytes);
  EXPECT_EQ(read_from(client, 256), all_bytes);
}

TEST_F(LineServerTest, APseudoTerminalServesOneProgramAfterTheOther) {
  const std::string name = server.open_pseudo_terminal();
  for (int i = 0; i < 3; ++i) {
    Descriptor client(::open(name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    received.clear();
    ASSERT_EQ(write(client.number(), "V\r", 2), 2);
    ASSERT_TRUE(wait_for(context, [&] { return received == "V\r"; }));
    server.send("V1010\r");
    EXPECT_EQ(read_from(client, 6), "V1010\r");
  }
}

TEST_F(LineServerTest, RefusesASecondProgramAndLetsTheNextOneIn) {
  const std::uint16_t port = server.listen("127.0.0.1", 0);
  Descriptor first = connect_to(port);
  ASSERT_TRUE(wait_for(context, [&] { return has_event("is connected to the line"); }));
  const Descriptor second = connect_to(port);
  EXPECT_EQ(read_from(second, 1), "") << "closed";
  EXPECT_TRUE(has_event("is refused")) << events.back();
  // Both are there before this process looks.
  first.close();
  const Descriptor third = connect_to(port);
  ASSERT_EQ(write(third.number(), "V\r", 2), 2);
  ASSERT_TRUE(wait_for(context, [&] { return received == "V\r"; }));
}

TEST_F(LineServerTest, AProgramThatSendsFasterThanTheLineWaits) {
  room = 0;
  const Descriptor client = connect_to(server.listen("127.0.0.1", 0));
  ASSERT_EQ(write(client.number(), "123456", 6), 6);
  ASSERT_TRUE(wait_for(context, [&] { return has_event("is connected to the line"); }));
  context.poll();
  EXPECT_EQ(received, "");
  room = 4;
  server.resume();
  ASSERT_TRUE(wait_for(context, [&] { return received == "123456"; }));
}

TEST_F(LineServerTest, BytesForNobodyAndForAProgramThatDoesNotReadAreLost) {
  server.send("nobody");
  const Descriptor client = connect_to(server.listen("127.0.0.1", 0));
  ASSERT_TRUE(wait_for(context, [&] { return has_event("is connected to the line"); }));
  for (int i = 0; i < 66; ++i) {
    server.send(std::string(1'000, static_cast<char>('!' + i)));
  }
  EXPECT_TRUE(has_event("reads too slowly")) << "65 times 1,000 bytes wait";
  const std::string text = read_from(client, 65'000);
  EXPECT_EQ(text.substr(0, 1'000), std::string(1'000, '!'));
  EXPECT_EQ(text.size(), 65'000U);
}

}  // namespace
}  // namespace proleg::host
