// Transports and scripted adapters at the two ends of pseudo terminals and sockets, in one process.

#include "host/transport/open_transport.hpp"

#include <gtest/gtest.h>

#include "test_bus.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

using namespace test;

// LAWICEL's manual of the CANUSB.
std::string lawicel(const std::string& line) {
  switch (line.empty() ? ' ' : line[0]) {
    case 'V':
      return "V1013\r";
    case 'N':
      return "NA123\r";
    case 'C':
    case 'S':
    case 'O':
      return "\r";
    case 't':
      return "z\r";
    default:
      return "\a";
  }
}
// The slcan firmware of the CANable.
std::string canable(const std::string& line) {
  return line == "V" ? "CANable-8a5d6f6 github.com/normaldotcom/canable-fw.git\r" : "";
}

class SlcanTransportTest : public testing::Test {
 protected:
  /// A transport whose link is one end of a socket pair; the adapter is at the other end.
  std::unique_ptr<Transport> open(ScriptedAdapter::Script script) {
    std::array<Descriptor, 2> ends = socket_pair();
    adapter = std::make_unique<ScriptedAdapter>(context, std::move(ends[0]), std::move(script));
    return open_slcan_transport(context, "fd:9", make_descriptor_link(ends[1].release()), log);
  }
  std::string failure_of(ScriptedAdapter::Script script) {
    return message_of<TransportError>([&] { open(std::move(script)); });
  }

  boost::asio::io_context context;
  Log log;
  std::unique_ptr<ScriptedAdapter> adapter;
};

TEST_F(SlcanTransportTest, CarriesABurstThroughEachDialect) {
  const std::vector<CanFrame> frames = numbered_frames(2'000);
  for (const auto& dialect : {lawicel, canable}) {
    const auto transport = open(dialect);
    ASSERT_TRUE(send_all(*transport, frames));
    ASSERT_TRUE(wait_for(context, [&] { return log.sent.size() == frames.size(); })) << log.sent.size();
    EXPECT_EQ(log.sent, frames);
    std::vector<std::string> lines;
    for (const std::string& line : adapter->lines) {
      if (line[0] == 't') {
        lines.push_back(line);
      }
    }
    ASSERT_EQ(lines.size(), frames.size());
    EXPECT_EQ(lines[1], "t60280100010203040506");
    EXPECT_EQ(transport->statistics().transmitted, 2'000U);
    EXPECT_EQ(transport->statistics().refused, 0U);
    log.sent.clear();
  }
}

TEST_F(SlcanTransportTest, OpensAnAdapterThatAnswersNothingWithTheFirstFrameOfTheBus) {
  const auto transport = open([](const std::string& line) { return line == "O" ? "t0801FF\r" : ""; });
  EXPECT_TRUE(transport->state().is_connected);
  EXPECT_NE(transport->description().find("without acknowledgements"), std::string::npos);
}

TEST_F(SlcanTransportTest, ReceivesABurst) {
  const auto transport = open(lawicel);
  const std::vector<CanFrame> frames = numbered_frames(2'000);
  std::string text;
  for (const CanFrame& frame : frames) {
    text += format_slcan_frame(slcan_frame(frame)).view();
    text += '\r';
  }
  adapter->write(text);
  ASSERT_TRUE(wait_for(context, [&] { return log.frames.size() == frames.size(); })) << log.frames.size();
  EXPECT_EQ(log.frames, frames);
  EXPECT_EQ(transport->statistics().received, 2'000U);
}

TEST_F(SlcanTransportTest, ReportsTheStateOfTheController) {
  const auto transport = open(lawicel);
  adapter->write("sb000256\re2aO\r");
  ASSERT_TRUE(wait_for(context, [&] { return transport->state().bus_errors == 1; }));
  EXPECT_EQ(transport->state().controller, (CanStatus{CanState::bus_off, 0, 256}));
  EXPECT_TRUE(transport->state().errors.contains(CanErrorKind::acknowledgement));
  EXPECT_EQ(log.states.back(), transport->state());
}

TEST_F(SlcanTransportTest, RunsUntilTheListenerWasCalledOrTheDeadline) {
  const auto transport = open(lawicel);
  const Microseconds start = transport->now();
  transport->run_until(start + 20'000);
  EXPECT_GE(transport->now(), start + 20'000);
  adapter->write("t0801FF\rt0801FE\r");
  transport->run_until(start + longest_wait);
  EXPECT_FALSE(log.frames.empty());
}

TEST_F(SlcanTransportTest, SaysWhatARubbishAdapterAnswered) {
  EXPECT_EQ(failure_of([](const std::string&) { return "ERROR\r\n"; }),
            "fd:9: received 'ERROR' after S8, expected slcan: CR, BEL or a line such as t1230; is there an slcan "
            "adapter at its other end?");
}

TEST_F(SlcanTransportTest, SaysThatNothingAnswers) {
  EXPECT_EQ(failure_of([](const std::string&) { return ""; }),
            "fd:9: no answer to C, V, S8 and O within 4 s, and no frame from the bus; is there an slcan adapter at its "
            "other end?");
}

TEST_F(SlcanTransportTest, SaysThatTheOtherEndCloses) {
  Timer closing(context, [this] { adapter.reset(); });
  EXPECT_EQ(failure_of([&closing](const std::string& line) {
              if (line == "V") {
                closing.set(steady_now());
              }
              return lawicel(line);
            }),
            "fd:9: the other end has closed the connection");
}

TEST_F(SlcanTransportTest, ReportsALossInTheMiddleAndDropsWhatWaits) {
  const auto transport = open([](const std::string& line) { return line[0] == 't' ? "" : lawicel(line); });
  ASSERT_TRUE(send_all(*transport, numbered_frames(100)));
  ASSERT_TRUE(wait_for(context, [&] { return adapter->lines.size() > 20; }));
  adapter.reset();
  ASSERT_TRUE(wait_for(context, [&] { return !transport->state().is_connected; }));
  EXPECT_EQ(transport->state().reason, "the other end has closed the connection");
  EXPECT_EQ(log.states.back(), transport->state());
  EXPECT_FALSE(transport->send(numbered_frame(0)));
  EXPECT_EQ(transport->statistics().dropped_out + transport->statistics().unconfirmed, 101U);
}

TEST_F(SlcanTransportTest, ClosesTheChannelAtItsEnd) {
  auto transport = open(lawicel);
  transport.reset();
  ASSERT_TRUE(wait_for(context, [&] { return adapter->has_ended; }));
  EXPECT_EQ(adapter->lines.back(), "C");
}

class SerialTransportTest : public SlcanTransportTest {
 protected:
  std::unique_ptr<Transport> open_line(ScriptedAdapter::Script new_script) {
    script = std::move(new_script);
    return open_transport(context, parse_bus_address("serial:" + terminal.name()), log);
  }

  ScriptedAdapter::Script script;
  PseudoTerminal terminal{context, [this](Descriptor descriptor) {
                            adapter = std::make_unique<ScriptedAdapter>(context, std::move(descriptor), script);
                            adapter->on_end = [this] { terminal.client_gone(); };
                          }};
};

TEST_F(SerialTransportTest, CarriesFramesInBothDirections) {
  const auto transport = open_line(lawicel);
  EXPECT_EQ(transport->description(), "serial:" + terminal.name() + "@1000000, slcan adapter V1013, NA123");
  const std::vector<CanFrame> frames = numbered_frames(2'000);
  ASSERT_TRUE(send_all(*transport, frames));
  adapter->write("t0801FF\r");
  ASSERT_TRUE(wait_for(context, [&] { return log.sent.size() == frames.size() && log.frames.size() == 1; }));
  EXPECT_EQ(log.sent, frames);
}

TEST_F(SerialTransportTest, IsUsedByOneProgramAtATime) {
  const auto transport = open_line(lawicel);
  EXPECT_EQ(message_of<TransportError>([&] {
              static_cast<void>(open_transport(context, parse_bus_address("serial:" + terminal.name()), log));
            }),
            "serial:" + terminal.name() + "@1000000: another program uses it (fuser shows which)");
}

TEST_F(SerialTransportTest, FindsAnAdapterThatAnswersNoMoreAndReturnsToIt) {
  bool is_dead = false;
  const auto transport = open_line([&](const std::string& line) { return is_dead ? "" : lawicel(line); });
  is_dead = true;
  ASSERT_TRUE(transport->send(numbered_frame(0)));
  ASSERT_TRUE(wait_for(context, [&] { return !transport->state().is_connected; }));
  EXPECT_EQ(transport->state().reason.find("the adapter answers no more; frames without confirmation: 1; is the baud"),
            0U)
      << transport->state().reason;
  is_dead = false;
  ASSERT_TRUE(wait_for(context, [&] { return transport->state().is_connected; }));
  EXPECT_EQ(transport->statistics().connections, 2U);
  EXPECT_EQ(transport->statistics().unconfirmed, 1U);
}

TEST_F(SerialTransportTest, NamesWhatIsMissing) {
  const auto error = [&](const std::string& word) {
    return message_of<TransportError>(
        [&] { static_cast<void>(open_transport(context, parse_bus_address(word), log)); });
  };
  EXPECT_EQ(error("serial:/dev/no_such_line").find("serial:/dev/no_such_line@1000000: no such device; there is "), 0U);
  EXPECT_EQ(error("serial:/dev/null"), "serial:/dev/null@1000000: it is no serial line");
  EXPECT_EQ(error("fd:9999"), "fd:9999: Bad file descriptor: this process has not inherited such a descriptor");
  EXPECT_EQ(error("auto").find("auto: name the bus: a CAN interface"), 0U);
  EXPECT_EQ(error("tcp:no-such-host.invalid:1").find("tcp:no-such-host.invalid:1: no address of the host is known"),
            0U);
  const std::string bluetooth = error("bluetooth:00:AA:01:00:00:42");
  EXPECT_EQ(bluetooth.find("bluetooth:00:AA:01:00:00:42/1: "), 0U) << bluetooth;
  EXPECT_EQ(bluetooth.find('\n'), std::string::npos);
}

TEST_F(SerialTransportTest, NamesAnInterfaceThatIsMissingAndWhatToDo) {
  // This holds with and without CAN in the kernel.
  const std::string error =
      message_of<TransportError>([&] { static_cast<void>(open_transport(context, parse_bus_address("nocan9"), log)); });
  EXPECT_EQ(error.find("nocan9: "), 0U) << error;
  EXPECT_NE(error.find("sudo modprobe"), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace proleg::host
