// Clients of a bus server in the same process: over pseudo terminals, TCP and socket pairs.

#include "host/transport/bus_server.hpp"

#include <gtest/gtest.h>

#include "host/transport/event_loop.hpp"
#include "host/transport/open_transport.hpp"
#include "test_bus.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

using namespace test;

class BusServerTest : public testing::Test {
 protected:
  BusServerTest() { bus.server = &server; }

  std::unique_ptr<Transport> open(const std::string& word, Log& log) {
    return open_transport(context, parse_bus_address(word), log);
  }
  std::string tcp_word() { return "tcp:127.0.0.1:" + std::to_string(server.add_tcp("127.0.0.1", 0)); }

  boost::asio::io_context context;
  LoopBus bus;
  BusServer server{context, bus};
  Log first_log;
  Log second_log;
};

TEST_F(BusServerTest, CarriesBurstsInBothDirectionsOverEachKindOfLine) {
  std::array<Descriptor, 2> ends = socket_pair();
  server.add_descriptor(ends[0].release());
  const std::vector<CanFrame> frames = numbered_frames(2'000);
  for (const std::string& word :
       {"serial:" + server.add_pseudo_terminal(), tcp_word(), "fd:" + std::to_string(ends[1].release())}) {
    Log log;
    const auto transport = open(word, log);
    bus.frames.clear();
    ASSERT_TRUE(send_all(*transport, frames)) << word;
    ASSERT_TRUE(wait_for(context, [&] { return log.sent.size() == frames.size(); })) << word;
    EXPECT_EQ(bus.frames, frames) << word;
    EXPECT_TRUE(log.frames.empty()) << "a client does not receive its own frames";
    for (const CanFrame& frame : frames) {
      server.broadcast(steady_now(), frame);
    }
    ASSERT_TRUE(wait_for(context, [&] { return log.frames.size() == frames.size(); })) << word;
    EXPECT_EQ(log.frames, frames) << word;
  }
  EXPECT_EQ(server.totals().frames_from_clients, 6'000U);
  EXPECT_EQ(server.totals().frames_dropped, 0U);
}

TEST_F(BusServerTest, IsFoundAtAnyAddressOfAHost) {
  // localhost can be ::1 first, where the server does not listen.
  const auto transport = open("tcp:localhost:" + std::to_string(server.add_tcp("127.0.0.1", 0)), first_log);
  EXPECT_TRUE(transport->state().is_connected);
}

TEST_F(BusServerTest, IsReachedOverIpv6) {
  std::uint16_t port = 0;
  try {
    port = server.add_tcp("::1", 0);
  } catch (const TransportError& error) {
    GTEST_SKIP() << "this computer has no IPv6: " << error.what();
  }
  const auto transport = open("tcp:[::1]:" + std::to_string(port), first_log);
  EXPECT_TRUE(transport->state().is_connected);
  ASSERT_FALSE(bus.events.empty());
  EXPECT_EQ(bus.events.front().rfind("tcp client [::1]:", 0), 0U) << bus.events.front();
  EXPECT_NE(message_of<TransportError>([&] { server.add_tcp("::1", port); }).find("tcp:[::1]:" + std::to_string(port)),
            std::string::npos);
}

TEST_F(BusServerTest, GivesAFrameToAllOtherClients) {
  const std::string word = tcp_word();
  Log third_log;
  const auto first = open(word, first_log);
  const auto second = open(word, second_log);
  const auto third = open("serial:" + server.add_pseudo_terminal(), third_log);
  EXPECT_EQ(server.open_clients(), 3U);
  ASSERT_TRUE(first->send(numbered_frame(7)));
  ASSERT_TRUE(wait_for(
      context, [&] { return first_log.sent.size() + second_log.frames.size() + third_log.frames.size() == 3; }));
  EXPECT_TRUE(first_log.frames.empty());
  EXPECT_EQ(second_log.frames, (std::vector<CanFrame>{numbered_frame(7)}));
  EXPECT_EQ(third_log.frames, second_log.frames);
}

TEST_F(BusServerTest, APseudoTerminalServesOneClientAfterTheOther) {
  const std::string name = server.add_pseudo_terminal();
  for (int i = 0; i < 5; ++i) {
    Log log;
    const auto transport = open("serial:" + name, log);
    ASSERT_TRUE(transport->send(numbered_frame(1)));
    ASSERT_TRUE(wait_for(context, [&] { return log.sent.size() == 1; }));
    server.broadcast(steady_now(), numbered_frame(2));
  }
  ASSERT_TRUE(wait_for(context, [&] { return server.open_clients() == 0; }));
  EXPECT_EQ(bus.frames.size(), 5U);
}

TEST_F(BusServerTest, APseudoTerminalGivesNothingToALaterClient) {
  const std::string name = server.add_pseudo_terminal();
  const auto open_terminal = [&] { return Descriptor(::open(name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)); };
  Descriptor client = open_terminal();
  ASSERT_EQ(write(client.number(), "O\r", 2), 2);
  ASSERT_TRUE(wait_for(context, [&] { return server.open_clients() == 1; }));
  for (unsigned number = 0; number < 10'000; ++number) {
    server.broadcast(steady_now(), numbered_frame(number));
  }
  client.close();
  ASSERT_TRUE(wait_for(context, [&] { return server.open_clients() == 0; }));
  client = open_terminal();
  ASSERT_EQ(write(client.number(), "V\r", 2), 2);
  std::string text;
  ASSERT_TRUE(wait_for(context, [&] {
    std::array<char, 100> bytes{};
    const ssize_t length = read(client.number(), bytes.data(), bytes.size());
    text.append(bytes.data(), length > 0 ? static_cast<std::size_t>(length) : 0U);
    return text.find('\r') != std::string::npos;
  }));
  EXPECT_EQ(text, "V1010\r");
}

TEST_F(BusServerTest, AClientThatDoesNotReadLosesWholeLinesAndHoldsUpNobody) {
  const std::string word = tcp_word();
  const auto reader = open(word, first_log);
  std::array<Descriptor, 2> ends = socket_pair();
  server.add_descriptor(ends[0].release());
  ASSERT_EQ(write(ends[1].number(), "O\r", 2), 2);
  ASSERT_TRUE(wait_for(context, [&] { return server.open_clients() == 2; }));
  for (unsigned number = 0; number < 50'000; ++number) {
    server.broadcast(steady_now(), numbered_frame(number));
    if (number % 1'000 == 999) {
      ASSERT_TRUE(wait_for(context, [&] { return first_log.frames.size() == number + 1; })) << number;
    }
  }
  EXPECT_GT(server.totals().frames_dropped, 0U);
  std::string text;
  ASSERT_TRUE(wait_for(context, [&] {
    std::array<char, 4'096> bytes{};
    const ssize_t length = read(ends[1].number(), bytes.data(), bytes.size());
    text.append(bytes.data(), length > 0 ? static_cast<std::size_t>(length) : 0U);
    return text.size() >= 1 + (50'000 - server.totals().frames_dropped) * 22;
  }));
  text.erase(0, 1);  // the answer to O
  EXPECT_EQ(text.size() % 22, 0U);
  for (std::size_t line = 0; line < text.size(); line += 22) {
    ASSERT_TRUE(parse_slcan_frame(std::string_view(text).substr(line, 21))) << line;
    ASSERT_EQ(text[line + 21], '\r');
  }
}

TEST_F(BusServerTest, ReportsTheStateOfTheBusToClientsThatComeLater) {
  server.status_changed({CanState::bus_off, 0, 256});
  const auto transport = open(tcp_word(), first_log);
  ASSERT_TRUE(wait_for(context, [&] { return transport->state().controller.state == CanState::bus_off; }));
  CanErrors errors;
  errors.add(CanErrorKind::crc);
  server.errors_occurred(errors);
  ASSERT_TRUE(wait_for(context, [&] { return transport->state().errors.contains(CanErrorKind::crc); }));
}

TEST_F(BusServerTest, ATransportReturnsToAServerThatReturns) {
  auto other = std::make_unique<BusServer>(context, bus);
  const std::uint16_t port = other->add_tcp("127.0.0.1", 0);
  const auto transport = open("tcp:127.0.0.1:" + std::to_string(port), first_log);
  other.reset();
  ASSERT_TRUE(wait_for(context, [&] { return !transport->state().is_connected; }));
  ASSERT_TRUE(wait_for(context, [&] {
    return transport->state().reason.find("no program listens") != std::string::npos;
  })) << transport->state().reason;
  BusServer again(context, bus);
  EXPECT_EQ(again.add_tcp("127.0.0.1", port), port);
  ASSERT_TRUE(wait_for(context, [&] { return transport->state().is_connected; }));
  EXPECT_EQ(transport->statistics().connections, 2U);
}

TEST_F(BusServerTest, ATransportWaitsForAServerThatStartsInTheSameMoment) {
  auto other = std::make_unique<BusServer>(context, bus);
  const std::uint16_t port = other->add_tcp("127.0.0.1", 0);
  other.reset();
  BusServer late(context, bus);
  Timer timer(context, [&] { EXPECT_EQ(late.add_tcp("127.0.0.1", port), port); });
  timer.set(steady_now() + 1'000'000);
  const auto transport = open("tcp:127.0.0.1:" + std::to_string(port), first_log);
  EXPECT_TRUE(transport->state().is_connected);
}

TEST_F(BusServerTest, ATransportGivesUpAServerThatDoesNotStart) {
  auto other = std::make_unique<BusServer>(context, bus);
  const std::uint16_t port = other->add_tcp("127.0.0.1", 0);
  other.reset();
  const Microseconds start = steady_now();
  const std::string word = "tcp:127.0.0.1:" + std::to_string(port);
  EXPECT_NE(message_of<TransportError>([&] { static_cast<void>(open(word, first_log)); }).find("no program listens"),
            std::string::npos);
  EXPECT_GE(steady_now(), start + 2'000'000);
}

TEST_F(BusServerTest, SaysThatADescriptorHasClosed) {
  std::array<Descriptor, 2> ends = socket_pair();
  server.add_descriptor(ends[0].release());
  ends[1].close();
  ASSERT_TRUE(wait_for(context, [&] { return bus.has_closed; }));
  EXPECT_EQ(bus.events.size(), 2U);
}

TEST_F(BusServerTest, NamesWhatCannotBeServed) {
  const std::uint16_t port = server.add_tcp("127.0.0.1", 0);
  const std::string name = "tcp:127.0.0.1:" + std::to_string(port);
  EXPECT_EQ(message_of<TransportError>([&] { server.add_tcp("127.0.0.1", port); }),
            name + ": Address already in use: another program listens there; choose another port");
  EXPECT_EQ(message_of<TransportError>([&] { server.add_descriptor(9'999); }),
            "fd:9999: this process has not inherited such a descriptor");
  EXPECT_EQ(message_of<TransportError>([&] { server.add_can("nocan9"); }).find("nocan9: "), 0U);
}

}  // namespace
}  // namespace proleg::host
