#include "host/robot/bus_connection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

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

}  // namespace
}  // namespace proleg::host
