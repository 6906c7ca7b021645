#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>

#include "host/dynamixel/line.hpp"
#include "tests/host/dynamixel/servo_emulator.hpp"

namespace proleg::test {

/// The line to emulated servos on virtual time: bytes take the time that they take at the rate.
class EmulatedLine final : public host::Line {
 public:
  EmulatedLine(ServoEmulator& servos, std::uint64_t& now_us, unsigned rate)
      : servos_(servos), now_us_(now_us), rate_(rate) {}

  [[nodiscard]] std::uint64_t now_us() override { return now_us_; }

  void write(std::span<const std::uint8_t> bytes) override {
    sent_bytes += bytes.size();
    std::uint64_t time_us = now_us_ + time_of(bytes.size());
    const bool echoes = servos_.echoes;
    for (const ServoEmulator::Answer& answer : servos_.receive(bytes, time_us)) {
      const bool is_echo = echoes && answer.delay_us == 0;  // received while it is sent
      time_us += answer.delay_us + (is_echo ? 0 : time_of(answer.bytes.size()));
      const auto later = [&](const Pending& other) { return other.time_us > time_us; };
      pending_.insert(std::ranges::find_if(pending_, later), {time_us, answer.bytes});
    }
  }

  std::size_t read(std::span<std::uint8_t> into, std::uint64_t deadline_us) override {
    if (pending_.empty() || pending_.front().time_us > deadline_us) {
      now_us_ = std::max(now_us_, deadline_us);
      servos_.advance(now_us_);
      return 0;
    }
    Pending& next = pending_.front();
    now_us_ = std::max(now_us_, next.time_us);
    const std::size_t count = std::min(into.size(), next.bytes.size());
    std::copy_n(next.bytes.begin(), count, into.begin());
    next.bytes.erase(next.bytes.begin(), next.bytes.begin() + static_cast<std::ptrdiff_t>(count));
    if (next.bytes.empty()) {
      pending_.pop_front();
    }
    return count;
  }

  void discard_input() override {
    while (!pending_.empty() && pending_.front().time_us <= now_us_) {
      pending_.pop_front();
    }
  }

  std::size_t sent_bytes = 0;

 private:
  struct Pending {
    std::uint64_t time_us;
    Bytes bytes;
  };

  [[nodiscard]] std::uint64_t time_of(std::size_t bytes) const { return bytes * 10'000'000 / rate_; }

  ServoEmulator& servos_;
  std::uint64_t& now_us_;
  unsigned rate_;
  std::deque<Pending> pending_;
};

}  // namespace proleg::test
