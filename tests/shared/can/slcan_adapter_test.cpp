#include "shared/can/slcan_adapter.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace proleg {
namespace {

class Bus final : public CanPort {
 public:
  [[nodiscard]] bool send(const CanFrame& frame) override {
    if (is_full) {
      return false;
    }
    frames.push_back(frame);
    return true;
  }

  std::vector<CanFrame> frames;
  bool is_full = false;
};

class SlcanAdapterTest : public testing::Test {
 protected:
  explicit SlcanAdapterTest(const SlcanAdapter::Settings& settings = {}) : adapter(buffer, bus, settings) {}

  std::string output() {
    std::string text(buffer.size(), '\0');
    text.resize(adapter.take(text));
    return text;
  }
  std::string answer_to(std::string_view characters) {
    adapter.input(characters);
    return output();
  }
  void receive(std::uint16_t identifier, unsigned times = 1) {
    for (unsigned i = 0; i < times; ++i) {
      adapter.received(0, {identifier, 8, {1, 2, 3, 4, 5, 6, 7, 8}});
    }
  }

  std::array<char, 1'024> buffer{};
  Bus bus;
  SlcanAdapter adapter;
};

TEST_F(SlcanAdapterTest, AnswersEachCommandOfASession) {
  EXPECT_EQ(answer_to("C\r"), "\r");
  EXPECT_EQ(answer_to("S8\r"), "\r");
  EXPECT_EQ(answer_to("V\r"), "V1010\r");
  EXPECT_EQ(answer_to("N\r"), "N0000\r");
  EXPECT_EQ(answer_to("Z0\r"), "\r");
  EXPECT_EQ(answer_to("X1\r"), "\r");
  EXPECT_FALSE(adapter.is_open());
  EXPECT_EQ(answer_to("O\r"), "\r");
  EXPECT_TRUE(adapter.is_open());
  EXPECT_EQ(answer_to("F\r"), "F00\r");
  EXPECT_EQ(answer_to("C\r"), "\r");
  EXPECT_FALSE(adapter.is_open());
  EXPECT_EQ(adapter.counters().lines_rejected, 0U);
}

TEST_F(SlcanAdapterTest, AnswersBelToWhatItDoesNotOffer) {
  unsigned rejected = 0;
  for (const char* line : {"S0",        "S6",        "S",  "S88", "s031C",
                           "Q1",        "X",         "X0", "P",   "A",
                           "M00000000", "m00000000", "W0", "OO",  "Cx",
                           "L1",        "Z",         "Z2", "F1",  "V1",
                           "N1",        "t12",       "zz", "1",   "t1230123456789012345678901"}) {
    EXPECT_EQ(answer_to(std::string(line) + "\r"), "\a") << line;
    EXPECT_EQ(adapter.counters().lines_rejected, ++rejected) << line;
  }
  EXPECT_FALSE(adapter.is_open());
}

TEST_F(SlcanAdapterTest, TakesABitRateOnlyWhileItIsClosed) {
  EXPECT_EQ(answer_to("O\rS8\rO\rL\r"), "\r\a\a\a");
  EXPECT_TRUE(adapter.is_open());
  EXPECT_FALSE(adapter.is_listen_only());
}

TEST_F(SlcanAdapterTest, IgnoresEmptyLines) {
  EXPECT_EQ(answer_to("\r\r\r\n\aV\r\n"), "V1010\r");
  EXPECT_EQ(answer_to("\r\n\r\n"), "");
}

TEST_F(SlcanAdapterTest, SendsAFrameAndConfirmsIt) {
  EXPECT_EQ(answer_to("O\rt60382F8060000A000000\r"), "\rz\r");
  EXPECT_EQ(bus.frames, (std::vector<CanFrame>{{0x603, 8, {0x2F, 0x80, 0x60, 0, 0x0A, 0, 0, 0}}}));
  EXPECT_EQ(adapter.counters().frames_sent, 1U);
}

TEST_F(SlcanAdapterTest, RefusesFramesThatItCannotSend) {
  EXPECT_EQ(answer_to("t1230\r"), "\a") << "closed";
  EXPECT_EQ(answer_to("L\rt1230\r"), "\r\a") << "listen only";
  EXPECT_EQ(answer_to("C\rO\rT000001230\rr1230\rR000001230\r"), "\r\r\a\a\a") << "not of Proleg's kind";
  bus.is_full = true;
  EXPECT_EQ(answer_to("t1230\rF\rF\r"), "\aF02\rF00\r") << "full";
  EXPECT_EQ(adapter.counters().frames_refused, 6U);
  EXPECT_TRUE(bus.frames.empty());
}

TEST_F(SlcanAdapterTest, PassesReceivedFramesWhileItIsOpen) {
  adapter.received(0, {0x100, 0, {}});
  EXPECT_EQ(answer_to("O\r"), "\r");
  adapter.received(0, {0x581, 3, {0x60, 0xAB, 0}});
  EXPECT_EQ(output(), "t581360AB00\r");
  EXPECT_EQ(answer_to("C\rL\r"), "\r\r");
  adapter.received(0, {0x7FF, 0, {}});
  EXPECT_EQ(output(), "t7FF0\r");
  EXPECT_EQ(answer_to("C\r"), "\r");
  adapter.received(0, {0x7FF, 0, {}});
  EXPECT_EQ(output(), "");
  EXPECT_EQ(adapter.counters().frames_received, 2U);
}

TEST_F(SlcanAdapterTest, StampsFramesWithMillisecondsOfOneMinute) {
  EXPECT_EQ(answer_to("Z1\rO\r"), "\r\r");
  adapter.received(165'999, {0x100, 1, {0xFF}});
  adapter.received(59'999'999, {0x100, 0, {}});
  adapter.received(60'000'000, {0x100, 0, {}});
  EXPECT_EQ(output(), "t1001FF00A5\rt1000EA5F\rt10000000\r");
}

TEST_F(SlcanAdapterTest, ReportsTheErrorStateAsLinuxReadsIt) {
  adapter.status_changed({CanState::error_passive, 0, 128});
  EXPECT_EQ(answer_to("O\r"), "\rsp000128\r") << "also a state from before";
  adapter.status_changed({CanState::error_passive, 0, 136});
  EXPECT_EQ(output(), "") << "only a new state is reported";
  adapter.status_changed({CanState::bus_off, 0, 256});
  EXPECT_EQ(answer_to("F\r"), "sb000256\rFA4\r");
  adapter.status_changed({});
  EXPECT_EQ(answer_to("F\r"), "sa000000\rF00\r");
}

TEST_F(SlcanAdapterTest, ReportsErrorsAsLinuxReadsThem) {
  CanErrors errors;
  adapter.errors_occurred(errors);
  errors.add(CanErrorKind::acknowledgement);
  errors.add(CanErrorKind::receive_overrun);
  EXPECT_EQ(answer_to("O\r"), "\r");
  adapter.errors_occurred(errors);
  EXPECT_EQ(answer_to("F\rF\r"), "e2ao\rF88\rF00\r");
}

TEST_F(SlcanAdapterTest, DropsWholeLinesWhenTheHostDoesNotRead) {
  static_cast<void>(answer_to("O\r"));
  receive(0x581, 100);
  std::string text = output();
  EXPECT_EQ(text.size(), (buffer.size() - 64) / 22 * 22) << "64 characters are kept for answers";
  while (!text.empty()) {
    EXPECT_EQ(text.substr(0, 22), "t58180102030405060708\r");
    text.erase(0, 22);
  }
  EXPECT_EQ(adapter.counters().frames_received + adapter.counters().frames_dropped, 100U);
  EXPECT_EQ(answer_to("F\rF\r"), "F01\rF00\r");
}

TEST_F(SlcanAdapterTest, AnswersAlsoWhileFramesFillTheOutput) {
  static_cast<void>(answer_to("O\r"));
  receive(0x581, 100);
  for (int i = 0; i < 10; ++i) {
    adapter.input("t1230\r");
  }
  adapter.status_changed({CanState::bus_off, 0, 256});
  EXPECT_EQ(output().substr((buffer.size() - 64) / 22 * 22), "z\rz\rz\rz\rz\rz\rz\rz\rz\rz\rsb000256\r");
  EXPECT_EQ(adapter.counters().answers_dropped, 0U);
}

TEST_F(SlcanAdapterTest, SaysHowMuchInputItCanAnswer) {
  static_cast<void>(answer_to("O\r"));
  receive(0x581, 100);
  while (adapter.input_room() >= 2) {
    adapter.input("V\r");
  }
  EXPECT_EQ(adapter.counters().answers_dropped, 0U);
  for (int i = 0; i < 10; ++i) {
    adapter.input("V\r");
  }
  EXPECT_GT(adapter.counters().answers_dropped, 0U);
}

TEST_F(SlcanAdapterTest, ReportsTheLatestStateWhenThereIsRoomAgain) {
  static_cast<void>(answer_to("O\r"));
  for (int i = 0; i < 1'024; ++i) {
    adapter.input("X1\r");
  }
  adapter.status_changed({CanState::error_passive, 0, 128});
  adapter.status_changed({CanState::bus_off, 0, 256});
  EXPECT_EQ(output(), std::string(1'024, '\r'));
  EXPECT_EQ(output(), "sb000256\r");
}

TEST_F(SlcanAdapterTest, KeepsAQuarterOfTheOutputFreeOfStateFrames) {
  static_cast<void>(answer_to("O\r"));
  for (const std::uint16_t identifier : std::array<std::uint16_t, 4>{0x181, 0x1FF, 0x281, 0x2FF}) {
    receive(identifier, 20);
  }
  EXPECT_EQ(adapter.counters().frames_received, 768U / 22U);
  EXPECT_EQ(adapter.counters().state_frames_dropped, 80U - 768U / 22U);
  receive(0x180);
  receive(0x280);
  receive(0x301);
  receive(0x080);
  EXPECT_EQ(adapter.counters().frames_dropped, 0U);
}

TEST_F(SlcanAdapterTest, GivesItsOutputInPieces) {
  static_cast<void>(answer_to("O\r"));
  std::string text;
  for (int i = 0; i < 1'000; ++i) {
    receive(0x581);
    std::array<char, 22> piece{};
    text.append(piece.data(), adapter.take(std::span(piece).first(7)));
    text.append(piece.data(), adapter.take(std::span(piece).first(15)));
  }
  EXPECT_FALSE(adapter.has_output());
  EXPECT_EQ(text.size(), 22'000U);
  EXPECT_EQ(text.substr(text.size() - 22), "t58180102030405060708\r");
}

TEST_F(SlcanAdapterTest, IsClosedAndEmptyAfterAReset) {
  static_cast<void>(answer_to("Z1\rO\r"));
  receive(0x581);
  adapter.input("t12");
  adapter.reset();
  EXPECT_EQ(output(), "");
  EXPECT_EQ(answer_to("V\r"), "V1010\r");
  EXPECT_EQ(answer_to("O\r"), "\r");
  receive(0x581);
  EXPECT_EQ(output(), "t58180102030405060708\r");
}

class ThinningSlcanAdapterTest : public SlcanAdapterTest {
 protected:
  ThinningSlcanAdapterTest() : SlcanAdapterTest({0x2042, {'A', 'B', '1', '2'}, 3}) {}
};

TEST_F(ThinningSlcanAdapterTest, AnswersWithItsSettings) { EXPECT_EQ(answer_to("V\rN\r"), "V2042\rNAB12\r"); }

TEST_F(ThinningSlcanAdapterTest, PassesTheStateFramesOfEveryThirdTickAndAllOthers) {
  static_cast<void>(answer_to("O\r"));
  std::string identifiers;
  for (int tick = 0; tick < 7; ++tick) {
    for (const std::uint16_t identifier : std::array<std::uint16_t, 4>{0x080, 0x181, 0x2FF, 0x381}) {
      receive(identifier);
    }
    const std::string text = output();
    for (std::size_t i = 0; i < text.size(); i += 22) {
      identifiers += text.substr(i + 1, 3) + ' ';
    }
  }
  EXPECT_EQ(identifiers, "080 381 080 381 080 181 2FF 381 080 381 080 381 080 181 2FF 381 080 381 ");
  EXPECT_EQ(adapter.counters().state_frames_thinned, 10U);
}

TEST_F(ThinningSlcanAdapterTest, PassesAllStateFramesWithoutSync) {
  static_cast<void>(answer_to("O\r"));
  receive(0x181, 4);
  EXPECT_EQ(output().size(), 4U * 22U);
}

}  // namespace
}  // namespace proleg
