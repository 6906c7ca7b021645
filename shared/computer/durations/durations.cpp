#include "shared/computer/durations/durations.hpp"

namespace proleg {
namespace {

std::uint64_t with_three_digits(std::uint64_t value) {
  std::uint64_t unit = 1;
  while (value / unit >= 1'000) {
    unit *= 10;
  }
  return (value / unit + (value % unit >= (unit + 1) / 2 ? 1 : 0)) * unit;
}

}  // namespace

void Durations::add(std::uint64_t duration) {
  ++counts_[duration < 1'000 ? duration : with_three_digits(duration)];
  ++count_;
}

std::optional<std::uint64_t> Durations::percentile(unsigned percent) const {
  std::uint64_t so_far = 0;
  for (const auto& [duration, count] : counts_) {
    so_far += count;
    if (so_far * 100 >= count_ * percent) {
      return duration;
    }
  }
  return std::nullopt;
}

}  // namespace proleg
