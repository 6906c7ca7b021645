#include "host/transport/slcan_client.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "shared/can/slcan_adapter.hpp"

namespace proleg::host {
namespace {

/// A client on virtual time, at the other end a script.
class SlcanClientTest : public testing::Test, public SlcanClientListener {
 protected:
  /// What the adapter answers to a line without its end.
  using Script = std::function<std::string(const std::string&)>;

  explicit SlcanClientTest(const SlcanClient::Settings& settings = {}) : client(*this, settings) {}

  void received(Microseconds /*time*/, const CanFrame& frame) override { frames_received.push_back(frame); }
  void transmitted(Microseconds /*time*/, const CanFrame& frame) override { frames_transmitted.push_back(frame); }
  void status_received(const CanStatus& received_status) override { status = received_status; }
  void errors_received(CanErrors received_errors) override { errors = received_errors; }

  /// Exchanges characters until nothing is under way.
  void exchange(const Script& script) {
    while (client.has_output()) {
      sent += client.take(now, 1'000);
      for (std::size_t end = sent.find('\r'); end != std::string::npos; end = sent.find('\r')) {
        const std::string line = sent.substr(0, end);
        sent.erase(0, end + 1);
        lines.push_back(line);
        client.input(now, script(line));
      }
    }
  }
  /// Runs until nothing is to come, or at most this time.
  void run(const Script& script, Microseconds duration = 20'000'000) {
    const Microseconds end = now + duration;
    for (exchange(script); client.next_deadline() <= end; exchange(script)) {
      now = client.next_deadline();
      client.poll(now);
    }
    now = client.next_deadline() == never ? now : end;
  }
  void open(const Script& script) {
    client.start(now);
    run(script);
    ASSERT_EQ(client.state(), SlcanClient::State::open) << client.error();
    lines.clear();
  }
  /// The error of an adapter that cannot be used.
  std::string error_of(const Script& script) {
    client.start(now);
    run(script);
    EXPECT_EQ(client.state(), SlcanClient::State::failed);
    EXPECT_EQ(client.error().find('\n'), std::string::npos);
    return client.error();
  }

  SlcanClient client;
  Microseconds now = 1'000'000'000;
  std::string sent;
  std::vector<std::string> lines;
  std::vector<CanFrame> frames_received;
  std::vector<CanFrame> frames_transmitted;
  CanStatus status;
  CanErrors errors;
};

CanFrame frame(unsigned number) {
  return {0x601, 2, {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8U)}};
}
std::vector<CanFrame> frames(unsigned count) {
  std::vector<CanFrame> all;
  for (unsigned number = 0; number < count; ++number) {
    all.push_back(frame(number));
  }
  return all;
}

// LAWICEL's manual of the CANUSB.
std::string lawicel(const std::string& line) {
  const std::map<char, std::string> answers{{'C', "\r"},      {'S', "\r"},      {'O', "\r"},
                                            {'V', "V1013\r"}, {'N', "NA123\r"}, {'t', "z\r"}};
  const auto answer = answers.find(line.empty() ? ' ' : line[0]);
  return answer == answers.end() ? "\a" : answer->second;
}
// The slcan firmware of the CANable: V is answered with the name of its sources.
std::string canable(const std::string& line) {
  return line == "V" ? "CANable-8a5d6f6 github.com/normaldotcom/canable-fw.git\r" : "";
}
std::string silent(const std::string& /*line*/) { return ""; }

TEST_F(SlcanClientTest, OpensAnAdapterThatAnswersEverything) {
  client.start(now);
  run(lawicel, 0);
  EXPECT_EQ(client.state(), SlcanClient::State::open);
  EXPECT_EQ(lines, (std::vector<std::string>{"C", "V", "N", "S8", "Z0", "O"})) << "Z0 is rejected";
  EXPECT_EQ(client.adapter(), "V1013, NA123");
  EXPECT_TRUE(client.is_acknowledging());
}

TEST_F(SlcanClientTest, OpensAnAdapterWithCommandsOneByOne) {
  client.start(now);
  std::string taken = client.take(now, 100);
  EXPECT_EQ(taken, "C\r");
  client.poll(now + 299'999);
  EXPECT_FALSE(client.has_output());
  client.input(now, "\r");
  EXPECT_EQ(client.take(now, 100), "V\r");
  EXPECT_FALSE(client.has_output());
}

TEST_F(SlcanClientTest, OpensAnAdapterThatAnswersVersionsOnly) {
  open(canable);
  EXPECT_EQ(client.adapter(), "CANable-8a5d6f6 github.com/normaldotcom/canable-fw.git");
  EXPECT_FALSE(client.is_acknowledging());
}

TEST_F(SlcanClientTest, OpensAnAdapterThatAnswersNothingWhenAFrameComes) {
  client.start(now);
  run(silent, 1'500'000);
  EXPECT_EQ(client.state(), SlcanClient::State::starting);
  client.input(now, "t08011F\r");
  EXPECT_EQ(client.state(), SlcanClient::State::open);
  EXPECT_EQ(frames_received, (std::vector<CanFrame>{{0x080, 1, {0x1F}}}));
}

TEST_F(SlcanClientTest, OpensAnAdapterThatWasLeftOpen) {
  client.start(now);
  client.input(now, "2345\rt0801");
  bool is_first = true;
  run([&](const std::string& line) -> std::string {
    if (is_first) {
      is_first = false;
      return "1F\rt0801\a";  // the answer to the rest of a line
    }
    return lawicel(line);
  });
  EXPECT_EQ(client.state(), SlcanClient::State::open);
  EXPECT_TRUE(frames_received.empty());
}

TEST_F(SlcanClientTest, OpensAnAdapterThatStartsWithTextTwoSecondsLate) {
  const Microseconds start = now;
  bool has_greeted = false;
  client.start(now);
  run([&](const std::string& line) -> std::string {
    if (now < start + 1'500'000) {
      return "";
    }
    const bool greets = !has_greeted;
    has_greeted = true;
    return greets ? "CAN adapter\r\nready\r\n" : lawicel(line);
  });
  EXPECT_EQ(client.state(), SlcanClient::State::open) << client.error();
  EXPECT_LT(now - start, 4'500'000U);
}

TEST_F(SlcanClientTest, OpensProlegsOwnAdapter) {
  class Bus final : public CanPort {
   public:
    [[nodiscard]] bool send(const CanFrame& /*frame*/) override { return true; }
  };
  Bus bus;
  std::vector<char> buffer(1'024);
  SlcanAdapter adapter(buffer, bus);
  open([&](const std::string& line) {
    adapter.input(line + "\r");
    std::string output(1'024, ' ');
    output.resize(adapter.take(output));
    return output;
  });
  EXPECT_TRUE(adapter.is_open());
  EXPECT_EQ(client.adapter(), "V1010, N0000");
}

TEST_F(SlcanClientTest, SaysThatNothingAnswers) {
  EXPECT_EQ(error_of(silent), "no answer to C, V, S8 and O within 4 s, and no frame from the bus");
  EXPECT_LT(now, 1'000'000'000U + 8'000'000U);
}

TEST_F(SlcanClientTest, SaysWhatItReceivedAndWhatItExpected) {
  EXPECT_EQ(error_of([](const std::string&) { return "\xFE\x01\x80\xFE"; }),
            "received "
            "'\\xFE\\x01\\x80\\xFE\\xFE\\x01\\x80\\xFE\\xFE\\x01\\x80\\xFE\\xFE\\x01\\x80\\xFE\\xFE\\x01\\x80\\xFE', "
            "expected "
            "slcan: CR, BEL or a line such as t1230");
  EXPECT_EQ(error_of([](const std::string&) { return "ERROR\r\n"; }),
            "received 'ERROR' after S8, expected slcan: CR, BEL or a line such as t1230");
  EXPECT_EQ(error_of([](const std::string& line) { return line + "\r\n"; }),
            "the line returns what is sent to it (V), expected slcan: CR, BEL or a line such as t1230");
}

TEST_F(SlcanClientTest, SaysWhatTheAdapterRefuses) {
  EXPECT_EQ(error_of([](const std::string& line) { return line == "S8" ? "\a" : lawicel(line); }),
            "the adapter answers BEL to S8, expected CR: it does not offer 1 Mbit/s");
  EXPECT_EQ(error_of([](const std::string& line) { return line == "O" ? "\a" : lawicel(line); }),
            "the adapter answers BEL to O, expected CR: it does not open its channel");
}

TEST_F(SlcanClientTest, AFrameIsTransmittedWhenTheAdapterConfirmsIt) {
  open(lawicel);
  ASSERT_TRUE(client.send(frame(1)));
  EXPECT_EQ(client.take(now, 100), "t60120100\r");
  EXPECT_TRUE(frames_transmitted.empty());
  client.input(now, "z\r");
  EXPECT_EQ(frames_transmitted, (std::vector<CanFrame>{frame(1)}));
  EXPECT_EQ(client.statistics().transmitted, 1U);
}

TEST_F(SlcanClientTest, AFrameIsTransmittedWhenTheLineTakesItIfTheAdapterConfirmsNothing) {
  open(canable);
  ASSERT_TRUE(client.send(frame(1)));
  EXPECT_TRUE(frames_transmitted.empty());
  EXPECT_EQ(client.take(now, 100), "t60120100\r");
  EXPECT_EQ(frames_transmitted, (std::vector<CanFrame>{frame(1)}));
}

TEST_F(SlcanClientTest, AFrameThatTheAdapterRefusesIsCounted) {
  open(lawicel);
  for (unsigned number = 0; number < 3; ++number) {
    ASSERT_TRUE(client.send(frame(number)));
  }
  static_cast<void>(client.take(now, 100));
  client.input(now, "z\r\az\r");
  EXPECT_EQ(frames_transmitted, (std::vector<CanFrame>{frame(0), frame(2)}));
  EXPECT_EQ(client.statistics().refused, 1U);
}

TEST_F(SlcanClientTest, AnAdapterThatRejectsAllFramesForHalfASecondWasReset) {
  open(lawicel);
  for (unsigned number = 0; number < 6; ++number) {
    ASSERT_EQ(client.state(), SlcanClient::State::open);
    ASSERT_TRUE(client.send(frame(number)));
    static_cast<void>(client.take(now, 100));
    client.input(now, "\a");
    now += 100'000;
  }
  EXPECT_EQ(client.state(), SlcanClient::State::failed);
  EXPECT_NE(client.error().find("its channel is closed, as after a reset"), std::string::npos) << client.error();
}

TEST_F(SlcanClientTest, AnAdapterThatRejectsFramesBetweenOthersIsThere) {
  for (const std::string other : {"z\r", "t0800\r"}) {  // a frame is confirmed, or received
    open(lawicel);
    for (unsigned number = 0; number < 20; ++number) {
      ASSERT_TRUE(client.send(frame(number)));
      ASSERT_TRUE(client.send(frame(number)));
      static_cast<void>(client.take(now, 100));
      client.input(now, "\a" + other + (other == "z\r" ? "" : "\a"));
      now += 100'000;
    }
    EXPECT_EQ(client.state(), SlcanClient::State::open);
  }
}

TEST_F(SlcanClientTest, AnAdapterWhoseControllerIsInTroubleMayRejectAllFrames) {
  open(lawicel);
  client.input(now, "sp128128\r");
  for (unsigned number = 0; number < 20; ++number) {
    ASSERT_TRUE(client.send(frame(number)));
    static_cast<void>(client.take(now, 100));
    client.input(now, "\a");
    now += 100'000;
  }
  EXPECT_EQ(client.state(), SlcanClient::State::open);
}

TEST_F(SlcanClientTest, ABurstOf2000FramesArrivesInEveryDialect) {
  for (const Script& dialect : {Script(lawicel), Script(canable)}) {
    open(dialect);
    for (unsigned first = 0; first < 2'000; first += 1'000) {
      for (unsigned number = first; number < first + 1'000; ++number) {
        ASSERT_TRUE(client.send(frame(number)));
      }
      run(dialect);
    }
    EXPECT_EQ(frames_transmitted, frames(2'000));
    EXPECT_EQ(lines.size(), 2'000U);
    frames_transmitted.clear();
    client.stop();
  }
  EXPECT_EQ(client.statistics().dropped_out, 0U);
}

TEST_F(SlcanClientTest, FramesThatAreNotConfirmedFillAWindow) {
  open(lawicel);
  for (unsigned number = 0; number < 100; ++number) {
    ASSERT_TRUE(client.send(frame(number)));
  }
  EXPECT_EQ(client.take(now, 10'000).size(), 32U * 10U);
  EXPECT_FALSE(client.has_output());
  client.input(now, "z\rz\r");
  EXPECT_EQ(client.take(now, 10'000), "t60122000\rt60122100\r");
}

TEST_F(SlcanClientTest, AFullQueueRefusesFrames) {
  open(lawicel);
  for (unsigned number = 0; number < 1'024; ++number) {
    EXPECT_TRUE(client.send(frame(number)));
  }
  EXPECT_FALSE(client.send(frame(0)));
  EXPECT_EQ(client.statistics().dropped_out, 1U);
}

/// docs/protocol.md, "Bringing up a robot": the quick stop of a node. CiA 301, table 5: NMT stop of all nodes.
CanFrame quick_stop(unsigned node) { return {static_cast<std::uint16_t>(0x200 + node), 6, {2, 0, 0, 0, 0, 0x80}}; }
CanFrame enabling_command(unsigned node) { return {static_cast<std::uint16_t>(0x200 + node), 6, {0x0F}}; }
constexpr CanFrame nmt_stop{0x000, 2, {0x02, 0}};
constexpr CanFrame nmt_start{0x000, 2, {0x01, 0}};
CanFrame controlword_by_sdo(std::uint8_t controlword) { return {0x603, 8, {0x2B, 0x40, 0x60, 0, controlword}}; }

TEST_F(SlcanClientTest, FramesThatEndMotionWaitForNoConfirmation) {
  bool is_cut = false;
  const Script script = [&](const std::string& line) { return is_cut ? std::string() : lawicel(line); };
  open(script);
  is_cut = true;
  for (unsigned number = 0; number < 1'024; ++number) {
    ASSERT_TRUE(client.send(frame(number)));
  }
  exchange(script);
  ASSERT_EQ(lines.size(), 32U) << "the window";
  for (unsigned node = 1; node <= 126; ++node) {
    ASSERT_TRUE(client.send(quick_stop(node))) << "they find room in a queue that is full";
  }
  ASSERT_TRUE(client.send(nmt_stop));
  lines.clear();
  exchange(script);
  ASSERT_EQ(lines.size(), 127U);
  EXPECT_EQ(lines.front(), "t2016020000000080");
  EXPECT_EQ(lines.back(), "t00020200");
}

/// A connection that is cut for a moment must not start a joint after its stop.
TEST_F(SlcanClientTest, ACommandThatWaitsDoesNotStartAJointAfterItsStop) {
  bool is_cut = false;
  const Script script = [&](const std::string& line) { return is_cut ? std::string() : lawicel(line); };
  open(script);
  is_cut = true;
  for (unsigned number = 0; number < 32; ++number) {
    ASSERT_TRUE(client.send(frame(number)));  // they fill the window
  }
  exchange(script);
  for (const CanFrame& waiting :
       {enabling_command(3), controlword_by_sdo(15), enabling_command(4), nmt_start, frame(7)}) {
    ASSERT_TRUE(client.send(waiting));
  }
  ASSERT_TRUE(client.send(quick_stop(3)));
  EXPECT_EQ(client.statistics().dropped_out, 2U) << "the two commands to node 3";
  lines.clear();
  frames_transmitted.clear();
  exchange(script);
  EXPECT_EQ(lines, std::vector<std::string>{"t2036020000000080"});
  ASSERT_TRUE(client.send(nmt_stop));
  EXPECT_EQ(client.statistics().dropped_out, 4U) << "a stop of all nodes drops what starts any";
  ASSERT_TRUE(client.send(enabling_command(3)));  // a later decision
}

TEST_F(SlcanClientTest, TheConfirmationsAreThoseOfTheFramesInTheOrderInWhichTheyWereWritten) {
  open(lawicel);
  for (unsigned number = 0; number < 3; ++number) {
    ASSERT_TRUE(client.send(frame(number)));
  }
  ASSERT_TRUE(client.send(quick_stop(5)));
  run(lawicel);
  EXPECT_EQ(frames_transmitted, (std::vector<CanFrame>{quick_stop(5), frame(0), frame(1), frame(2)}));
}

TEST(FrameQueue, KnowsTheFramesThatEndMotion) {
  EXPECT_TRUE(ends_motion(quick_stop(3)));
  EXPECT_TRUE(ends_motion(nmt_stop));
  EXPECT_TRUE(ends_motion({0x000, 2, {0x80, 3}})) << "Pre-operational";
  EXPECT_TRUE(ends_motion(controlword_by_sdo(2)));
  EXPECT_TRUE(ends_motion(controlword_by_sdo(0)));
  EXPECT_FALSE(ends_motion(nmt_start));
  EXPECT_FALSE(ends_motion(enabling_command(3)));
  for (const unsigned enabling : {6U, 7U, 15U}) {
    EXPECT_FALSE(ends_motion(controlword_by_sdo(static_cast<std::uint8_t>(enabling)))) << enabling;
  }
  EXPECT_FALSE(ends_motion({0x77F, 1, {5}})) << "the heartbeat of the host";
  EXPECT_FALSE(ends_motion(frame(0)));
}

TEST_F(SlcanClientTest, PassesFramesAndReportsAndIgnoresForeignFrames) {
  open(lawicel);
  client.input(now, "t08011F12AB\rT000001000\rr1000\rsp000128\re1a\rgarbage\r");
  EXPECT_EQ(frames_received, (std::vector<CanFrame>{{0x080, 1, {0x1F}}}));
  EXPECT_EQ(client.statistics().foreign, 2U);
  EXPECT_EQ(client.statistics().malformed, 1U);
  EXPECT_EQ(status, (CanStatus{CanState::error_passive, 0, 128}));
  EXPECT_TRUE(errors.contains(CanErrorKind::acknowledgement));
}

TEST_F(SlcanClientTest, ShowsTheLastLineThatItDidNotUnderstand) {
  open(lawicel);
  client.input(now, "garbage\rt08011F123456\r");
  EXPECT_EQ(client.statistics().malformed, 2U);
  EXPECT_EQ(client.statistics().malformed_line, "'t08011F123456'");
}

TEST_F(SlcanClientTest, AnAdapterMayReportFramesThatItHasConfirmed) {
  const Script script = [](const std::string& line) { return line[0] == 't' ? "\rz" + line + "\r" : lawicel(line); };
  open(script);
  for (unsigned number = 0; number < 40; ++number) {
    ASSERT_TRUE(client.send(frame(number)));
  }
  run(script);
  EXPECT_EQ(frames_transmitted, frames(40));
  EXPECT_TRUE(frames_received.empty());
  EXPECT_EQ(client.statistics().malformed, 0U);
}

TEST_F(SlcanClientTest, AnAdapterMayConfirmAFrameWithTheReportOnly) {
  const Script script = [](const std::string& line) { return line[0] == 't' ? "Z" + line + "\r" : lawicel(line); };
  open(script);
  for (unsigned number = 0; number < 40; ++number) {
    ASSERT_TRUE(client.send(frame(number)));
  }
  run(script, 0);
  EXPECT_EQ(frames_transmitted, frames(40));
  EXPECT_TRUE(frames_received.empty());
}

TEST_F(SlcanClientTest, AnAdapterMayConfirmFramesWithoutTheEndOfALine) {
  const Script script = [](const std::string& line) { return line[0] == 't' ? "z" : lawicel(line); };
  open(script);
  ASSERT_TRUE(client.send(frame(1)));
  ASSERT_TRUE(client.send(frame(2)));
  exchange(script);
  client.input(now, "t58100\r");  // a frame from the bus ends the line zz
  EXPECT_EQ(frames_received, (std::vector<CanFrame>{{0x581, 0, {}}}));
  EXPECT_EQ(frames_transmitted, (std::vector<CanFrame>{frame(1), frame(2)}));
  for (unsigned number = 0; number < 1'000; ++number) {
    ASSERT_TRUE(client.send(frame(3)));
  }
  run(script, 0);
  EXPECT_EQ(client.statistics().transmitted, 1'002U) << "without another frame from the bus";
  EXPECT_EQ(client.statistics().malformed, 0U);
}

TEST_F(SlcanClientTest, AnAdapterThatDiesIsFound) {
  open(lawicel);
  ASSERT_TRUE(client.send(frame(1)));
  run(silent);
  EXPECT_EQ(lines, (std::vector<std::string>{"t60120100", "V"}));
  EXPECT_EQ(client.state(), SlcanClient::State::failed);
  EXPECT_EQ(client.error(), "the adapter answers no more; frames without confirmation: 1");
  EXPECT_EQ(client.statistics().unconfirmed, 1U);
}

TEST_F(SlcanClientTest, AnAnswerThatIsLostEndsNothing) {
  open(lawicel);
  ASSERT_TRUE(client.send(frame(1)));
  ASSERT_TRUE(client.send(frame(2)));
  run([](const std::string& line) { return line == "t60120100" ? "" : lawicel(line); });
  EXPECT_EQ(client.state(), SlcanClient::State::open);
  EXPECT_EQ(client.statistics().transmitted + client.statistics().unconfirmed, 2U);
  EXPECT_TRUE(client.is_acknowledging());
}

TEST_F(SlcanClientTest, ConfirmationsThatAreLostAreMadeUpForInAFifthOfASecond) {
  open(lawicel);
  unsigned count = 0;
  const Script forgetful = [&count](const std::string& line) {
    return line[0] == 't' && ++count % 20 == 0 ? "" : lawicel(line);
  };
  for (unsigned number = 0; number < 1'000; ++number) {
    ASSERT_TRUE(client.send(frame(number)));
  }
  const Microseconds start = now;
  for (exchange(forgetful); client.next_deadline() != never; exchange(forgetful)) {
    now = client.next_deadline();
    client.poll(now);
  }
  EXPECT_EQ(frames_transmitted, frames(1'000))
      << "50 confirmations fill the window once, and 18 of them wait at the end";
  EXPECT_LE(now - start, 400'000U);
}

TEST_F(SlcanClientTest, AnAdapterMayConfirmCommandsOnly) {
  const Script script = [](const std::string& line) { return line[0] == 't' ? "" : lawicel(line); };
  open(script);
  ASSERT_TRUE(client.send(frame(1)));
  run(script);
  EXPECT_EQ(client.state(), SlcanClient::State::open);
  EXPECT_FALSE(client.is_acknowledging());
  ASSERT_TRUE(client.send(frame(2)));
  run(script);
  EXPECT_EQ(frames_transmitted, (std::vector<CanFrame>{frame(2)}));
}

TEST_F(SlcanClientTest, ClosesTheChannelWhenItStops) {
  open(lawicel);
  ASSERT_TRUE(client.send(frame(1)));
  client.stop();
  EXPECT_EQ(client.take(now, 100), "C\r");
  EXPECT_FALSE(client.has_output());
  EXPECT_FALSE(client.send(frame(1)));
  EXPECT_EQ(client.statistics().dropped_out, 2U);
}

class ListeningSlcanClientTest : public SlcanClientTest {
 protected:
  static SlcanClient::Settings listening() {
    SlcanClient::Settings settings;
    settings.is_listen_only = true;
    return settings;
  }
  ListeningSlcanClientTest() : SlcanClientTest(listening()) {}
};

TEST_F(ListeningSlcanClientTest, OpensWithLAndSendsNothing) {
  client.start(now);
  run([](const std::string& line) { return line == "L" ? "\r" : lawicel(line); });
  EXPECT_EQ(lines.back(), "L");
  EXPECT_EQ(client.state(), SlcanClient::State::open);
  EXPECT_FALSE(client.send(frame(1)));
}

}  // namespace
}  // namespace proleg::host
