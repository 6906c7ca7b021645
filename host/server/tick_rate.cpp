#include "host/server/tick_rate.hpp"

#include <algorithm>

namespace proleg::host {
namespace {

constexpr ServerTime measurement{250};
constexpr double max_ticks_per_second = 1000;
constexpr std::uint64_t max_unread_rows = 256;
constexpr std::uint32_t max_stride = 1U << 15U;

}  // namespace

void TickRate::update(ServerTime now, std::uint64_t rows) {
  if (has_started_ && now < start_ + measurement) {
    return;
  }
  if (has_started_) {
    ticks_per_second_ = 1000.0 * static_cast<double>(rows - start_rows_) / static_cast<double>((now - start_).count());
  }
  has_started_ = true;
  start_ = now;
  start_rows_ = rows;
}

std::uint32_t TickRate::stride(std::uint64_t unread_rows) const {
  // The computer's clock may be slightly faster than the ticks; all ticks of 1 ms must be shown nevertheless.
  const double tolerated = 1.05 * max_ticks_per_second;
  std::uint32_t stride = 1;
  while (stride < max_stride && (ticks_per_second_ / stride > tolerated || unread_rows / stride > max_unread_rows)) {
    stride *= 2;
  }
  return stride;
}

}  // namespace proleg::host
