#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace proleg {

/// Measured durations, in a unit that the user chooses: their number, and the value that a share of them does not
/// exceed. Keeps three significant digits of each duration, rounded to the nearest, so that a long run needs little
/// memory.
class Durations {
 public:
  void add(std::uint64_t duration) {
    ++counts_[duration < 1'000 ? duration : with_three_digits(duration)];
    ++count_;
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// The smallest duration that at least `percent` per cent (1 to 100) of all do not exceed; nothing without durations.
  [[nodiscard]] std::optional<std::uint64_t> percentile(unsigned percent) const {
    std::uint64_t so_far = 0;
    for (const auto& [duration, count] : counts_) {
      so_far += count;
      if (so_far * 100 >= count_ * percent) {
        return duration;
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] std::optional<std::uint64_t> median() const { return percentile(50); }

 private:
  static std::uint64_t with_three_digits(std::uint64_t value) {
    std::uint64_t unit = 1;
    while (value / unit >= 1'000) {
      unit *= 10;
    }
    return (value / unit + (value % unit >= (unit + 1) / 2 ? 1 : 0)) * unit;
  }

  std::map<std::uint64_t, std::uint64_t> counts_;  ///< number of durations with each value
  std::uint64_t count_ = 0;
};

}  // namespace proleg
