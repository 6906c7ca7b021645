// The clients of the master and a foreign module: its answers have the form of CiA 301, 7.2.4.3, but not that of ours.

#include "shared/computer/master/sdo_client_pool.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "frame_text.hpp"

namespace proleg::canopen {
namespace {

using test::frame;

/// Sends all frames at once.
class Port final : public CanPort {
 public:
  bool send(const CanFrame& sent) override {
    frames.push_back(sent);
    return true;
  }

  std::vector<CanFrame> frames;
};

/// Reads one object of the first joint's module.
class OneRead final : public SdoWork {
 public:
  std::optional<SdoRequest> request(unsigned /*joint*/, std::size_t position) override {
    return position == 0 ? std::optional(SdoRequest{{0x1006, 0}, 0, 0}) : std::nullopt;
  }
  bool on_value(unsigned /*joint*/, std::size_t /*position*/, std::uint32_t read) override {
    value = read;
    return true;
  }
  void on_abort(unsigned /*joint*/, Address /*address*/, AbortCode code) override { abort = code; }

  std::optional<std::uint32_t> value;
  std::optional<AbortCode> abort;
};

class SdoClientPoolTest : public testing::Test {
 protected:
  SdoClientPoolTest() {
    pool.begin(JointMask::first(1), 500'000, 0);
    pump();
    EXPECT_EQ(port.frames.back(), frame("603 [8] 40 06 10 00 00 00 00 00"));
  }
  void pump() { pool.send(0, nodes, queue, work); }
  void answer(const char* text) {
    pool.receive(0, frame(text), work);
    pump();
  }

  const std::vector<std::uint8_t> nodes{3};
  Port port;
  TransmitQueue queue{port};
  OneRead work;
  SdoClientPool pool;
};

TEST_F(SdoClientPoolTest, TakesAValueInSegments) {
  answer("583 [8] 41 06 10 00 03 00 00 00");  // three bytes follow
  EXPECT_EQ(port.frames.back(), frame("603 [8] 60 00 00 00 00 00 00 00"));
  answer("583 [8] 09 04 03 02 00 00 00 00");  // the last segment, without four of its seven bytes
  EXPECT_EQ(work.value, 0x00020304U);
  EXPECT_TRUE(pool.done());
}

TEST_F(SdoClientPoolTest, RefusesALongValue) {
  answer("583 [8] 41 06 10 00 20 00 00 00");
  EXPECT_EQ(work.abort, AbortCode::out_of_memory);
  EXPECT_TRUE(pool.done());
}

TEST_F(SdoClientPoolTest, DoesNotTakeEmptySegmentsWithoutEnd) {
  answer("583 [8] 40 06 10 00 00 00 00 00");  // a value of unknown size
  answer("583 [8] 0E 00 00 00 00 00 00 00");  // a segment without bytes, and not the last one
  EXPECT_EQ(work.abort, AbortCode::unknown_command);
  EXPECT_TRUE(pool.done());
}

}  // namespace
}  // namespace proleg::canopen
