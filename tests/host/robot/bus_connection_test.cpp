#include "host/robot/bus_connection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace proleg::host {
namespace {

/// A bus of which only the numbers count.
class CountedBus final : public Transport {
 public:
  explicit CountedBus(Statistics numbers) : numbers_(std::move(numbers)) { state_.is_connected = true; }
  [[nodiscard]] Microseconds now() const override { return now_; }
  [[nodiscard]] bool send(const CanFrame& /*frame*/) override { return true; }
  void run_until(Microseconds deadline) override { now_ = std::max(now_, deadline); }
  [[nodiscard]] const BusState& state() const override { return state_; }
  [[nodiscard]] Statistics statistics() const override { return numbers_; }
  [[nodiscard]] std::string description() const override { return "numbers"; }

 private:
  Microseconds now_ = 0;
  BusState state_;
  Statistics numbers_;
};

/// What a program says after it has sent a frame.
std::string diagnosis(const Statistics& numbers) {
  BusConnection bus([&](TransportListener& /*listener*/) { return std::make_unique<CountedBus>(numbers); });
  EXPECT_TRUE(bus.send({}));
  return bus.diagnosis();
}

TEST(BusDiagnosis, NamesTheCableOnlyIfNothingComesFromTheBus) {
  Statistics numbers;
  EXPECT_NE(diagnosis(numbers).find("the cable or a terminator is missing"), std::string::npos);
  numbers.received = 12;
  EXPECT_EQ(
      diagnosis(numbers),
      "the adapter has confirmed no frame, but 12 frames were received: its line loses bytes, or it only listens; "
      "what was sent may have arrived: try again");
}

/// A bus whose frames wait while the program stands still; each call of run_until() hands over one of them.
class SlowlyReadBus final : public Transport {
 public:
  explicit SlowlyReadBus(TransportListener& listener) : listener_(listener) { state_.is_connected = true; }
  [[nodiscard]] Microseconds now() const override { return now_; }
  [[nodiscard]] bool send(const CanFrame& /*frame*/) override { return true; }
  void run_until(Microseconds deadline) override {
    if (waiting_ == 0) {
      now_ = std::max(now_, deadline);
      return;
    }
    --waiting_;
    ++numbers_.received;
    listener_.received(now_, {0x080, 1, {1}});
  }
  [[nodiscard]] const BusState& state() const override { return state_; }
  [[nodiscard]] Statistics statistics() const override { return numbers_; }
  [[nodiscard]] std::string description() const override { return "slow"; }

  void stand_still(Microseconds duration, unsigned frames) {
    now_ += duration;
    waiting_ = frames;
  }

 private:
  TransportListener& listener_;
  Microseconds now_ = 1'000'000;
  unsigned waiting_ = 0;
  BusState state_;
  Statistics numbers_;
};

/// Counts the frames that it has received before it is asked to look at the time.
class Judge final : public BusUser {
 public:
  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override { ++frames; }
  void transmitted(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  void poll(Microseconds now) override {
    before_the_look.push_back(frames);
    next_ = now + 100;
  }
  [[nodiscard]] Microseconds next_deadline() const override { return next_; }

  unsigned frames = 0;
  std::vector<unsigned> before_the_look;

 private:
  Microseconds next_ = 0;
};

TEST(BusConnection, AProgramThatStoodStillReadsWhatHasComeBeforeItLooksAtTheTime) {
  SlowlyReadBus* transport = nullptr;
  BusConnection bus([&](TransportListener& listener) {
    auto made = std::make_unique<SlowlyReadBus>(listener);
    transport = made.get();
    return made;
  });
  Judge judge;
  const BusAttachment attachment(bus, judge);
  bus.run_for(1'000);
  judge.before_the_look.clear();
  transport->stand_still(300'000, 500);
  bus.run_for(1'000);
  ASSERT_FALSE(judge.before_the_look.empty());
  EXPECT_EQ(judge.before_the_look.front(), 500U);
}

}  // namespace
}  // namespace proleg::host
