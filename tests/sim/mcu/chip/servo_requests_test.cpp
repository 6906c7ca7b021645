// The pulses at PA5 for any sequence of requests: two pulses that run together are one long pulse for a servo, and one
// that is cut is a command to another angle.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "shared/fixed/little_endian.hpp"
#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime shortest_pause = 500 * us;
constexpr std::uint32_t counts_in_us = 12;
/// From the begin of the instructions that request a pulse to its edge.
constexpr BusTime most_latency = 3 * us;
/// A pause is written as a width of 0 and the width that comes next.
constexpr BusTime most_handling = 5 * us;
constexpr BusTime after_the_last = 60 * ms;

struct ServoRequest {
  std::uint32_t at_us;
  std::uint32_t width;
  std::uint32_t period_us;
};
struct PinPulse {
  BusTime begin;
  BusTime end;
};
struct CompareWrite {
  BusTime time;
  std::uint32_t counts;
};

RigSettings list_settings() {
  RigSettings settings;
  settings.image = "servo_requests";
  settings.record.reset();
  settings.max_lead = 20 * us;  // the bus is silent
  return settings;
}

/// The image servo_requests, which makes the requests.
class ServoRequests : public testing::Test {
 protected:
  void make(const std::vector<ServoRequest>& requests) {
    ChipRig rig(list_settings());
    bool is_high = false;
    rig.chip.set_pin_watch('A', 5, [&](BusTime time, bool high) {
      is_high = high;
      if (high) {
        pulses_.push_back({time, 0});
      } else {
        pulses_.back().end = time;
      }
    });
    rig.chip.set_compare_watch([&](BusTime time, std::uint32_t counts) { writes_.push_back({time, counts}); });
    rig.power_on();
    rig.run_for(20 * ms);
    const std::uint32_t list = rig.address_of("servo_requests");
    std::vector<std::uint8_t> bytes;
    for (const ServoRequest& request : requests) {
      for (const std::uint32_t word : {request.at_us, request.width, request.period_us}) {
        bytes.resize(bytes.size() + 4);
        write_little_endian(bytes, bytes.size() - 4, 4, word);
      }
    }
    rig.chip.write(list + 4, bytes);
    bytes.resize(4);
    write_little_endian(bytes, 0, 4, static_cast<std::uint32_t>(requests.size()));
    rig.chip.write(list, bytes);
    rig.run_for(requests.back().at_us * us + after_the_last);
    ASSERT_EQ(rig.word(rig.address_of("servo_requests_made")), requests.size());
    EXPECT_TRUE(rig.events.empty());
    end_ = rig.bus.now();
    if (is_high) {
      pulses_.pop_back();
    }
  }

  [[nodiscard]] bool is_off_request(std::size_t write) const {
    return writes_[write].counts == 0 &&
           (write + 1 == writes_.size() || writes_[write + 1].time > writes_[write].time + most_handling);
  }

  /// Pulses are whole, of the newest width, and apart; none is requested and never begins.
  void expect_good_pulses() {
    ASSERT_FALSE(pulses_.empty());
    for (std::size_t i = 0; i < pulses_.size(); ++i) {
      SCOPED_TRACE("pulse " + std::to_string(i) + " at " + std::to_string(pulses_[i].begin) + " ns");
      ASSERT_TRUE(i == 0 || pulses_[i].begin - pulses_[i - 1].end >= shortest_pause)
          << "the output was low for " << pulses_[i].begin - pulses_[i - 1].end << " ns";
      std::size_t newest = writes_.size();
      while (newest != 0 && (writes_[newest - 1].time >= pulses_[i].begin ||
                             (writes_[newest - 1].counts == 0 && !is_off_request(newest - 1)))) {
        --newest;
      }
      ASSERT_NE(newest, 0U);
      ASSERT_NEAR(static_cast<double>(pulses_[i].end - pulses_[i].begin), writes_[newest - 1].counts * 1e3 / 12, 100.0);
    }
  }
  /// A request that no other one follows soon begins its pulse as soon as the pause allows: the rest of a pause takes
  /// twice the handling at least.
  void expect_prompt_pulses() {
    for (std::size_t i = 0; i < writes_.size(); ++i) {
      const BusTime time = writes_[i].time;
      const BusTime next = i + 1 == writes_.size() ? end_ : writes_[i + 1].time;
      const auto later = std::ranges::find_if(pulses_, [&](const PinPulse& pulse) { return pulse.begin > time; });
      if (writes_[i].counts == 0 || next < time + shortest_pause + most_latency) {
        continue;
      }
      const bool is_first = later == pulses_.begin();
      if (!is_first && std::prev(later)->end > time) {
        continue;  // the output was high
      }
      ASSERT_NE(later, pulses_.end());
      const BusTime free = is_first ? 0 : std::prev(later)->end + shortest_pause;
      ASSERT_LE(later->begin, std::max(time, free) + most_latency + 2 * most_handling)
          << "request at " << time << " ns";
    }
  }
  /// What was requested last is what the servo gets in the end.
  void expect_last_request_at_the_end(const ServoRequest& last) {
    if (last.width == 0) {
      EXPECT_LT(pulses_.back().end, end_ - after_the_last / 2);
      return;
    }
    EXPECT_GE(pulses_.back().end, end_ - after_the_last / 2) << "the timer repeats it";
    EXPECT_NEAR(static_cast<double>(pulses_.back().end - pulses_.back().begin), last.width * 1e3 / 12, 100.0);
  }

  std::vector<PinPulse> pulses_;
  std::vector<CompareWrite> writes_;
  BusTime end_ = 0;
};

/// Requests with periods of 0.1 to 20 ms, at all places in a period: also some microseconds around the end of a pulse,
/// the end of the pause and the repetition of the timer.
std::vector<ServoRequest> random_requests(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto between = [&](std::uint32_t least, std::uint32_t most) {
    return least + static_cast<std::uint32_t>(random() % (most - least + 1));
  };
  constexpr std::array<std::uint32_t, 7> periods{100, 700, 1'000, 2'500, 3'000, 5'000, 20'000};
  std::vector<ServoRequest> requests;
  std::uint32_t at_us = 0;
  std::uint32_t period = 1'000;
  for (int i = 0; i < 120; ++i) {
    const std::uint32_t width_us = requests.empty() ? 1'500 : requests.back().width / counts_in_us;
    if (between(0, 9) == 0) {
      period = periods.at(between(0, 6));
    }
    switch (between(0, 7)) {
      case 0:
        at_us += between(20, 600);
        break;
      case 1:
        at_us += width_us + between(0, 8) - 4;
        break;
      case 2:
        at_us += width_us + 500 + between(0, 16) - 8;
        break;
      case 3:
        at_us += std::max(period / 4 * 5, width_us + 500) + between(0, 16) - 8;
        break;
      case 4:
        at_us += between(100, 20'000);
        break;
      default:
        at_us += period;
    }
    at_us += 10;  // a request is made before the next one
    requests.push_back({at_us, between(0, 15) == 0 ? 0 : between(500 * counts_in_us, 2'500 * counts_in_us), period});
  }
  if (requests.front().width == 0) {
    requests.front().width = 18'000;
  }
  return requests;
}

TEST_F(ServoRequests, OfAnyOrderGiveWholePulsesThatAreHalfAMillisecondApart) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    pulses_.clear();
    writes_.clear();
    const std::vector<ServoRequest> requests = random_requests(seed);
    ASSERT_NO_FATAL_FAILURE(make(requests));
    ASSERT_NO_FATAL_FAILURE(expect_good_pulses());
    ASSERT_NO_FATAL_FAILURE(expect_prompt_pulses());
    expect_last_request_at_the_end(requests.back());
  }
}

/// One request behind a pulse, at every microsecond around the edges of pulse, pause and repetition.
TEST_F(ServoRequests, AtEachMicrosecondOfAPeriodKeepThePause) {
  constexpr std::uint32_t first = 1'000;
  std::vector<ServoRequest> requests;
  std::uint32_t at_us = first;
  for (const std::uint32_t edge : {600U, 1'100U, 1'250U}) {  // end of the pulse and of the pause; the timer repeats
    for (std::uint32_t after = edge - 8; after <= edge + 8; ++after) {
      requests.push_back({at_us, 600 * counts_in_us, 1'000});
      requests.push_back({at_us + after, 2'000 * counts_in_us, 1'000});
      requests.push_back({at_us + after + 4'000, 0, 1'000});
      at_us += 12'000;
    }
  }
  ASSERT_NO_FATAL_FAILURE(make(requests));
  ASSERT_NO_FATAL_FAILURE(expect_good_pulses());
  ASSERT_NO_FATAL_FAILURE(expect_prompt_pulses());
}

}  // namespace
}  // namespace proleg::sim
