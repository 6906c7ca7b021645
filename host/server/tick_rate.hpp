#pragma once

#include <cstdint>

#include "host/server/server_types.hpp"

namespace proleg::host {

/// Measures the rate of ticks, and chooses how many of them a viewer receives: at most 1,000 a second.
class TickRate {
 public:
  /// Measures the rate. rows: number of rows that were ever added.
  void update(ServerTime now, std::uint64_t rows);

  /// Ticks from one row to the next for a viewer that has not read this many rows: a power of 2. A viewer that is far
  /// behind receives fewer ticks, so that its delay stays short.
  [[nodiscard]] std::uint32_t stride(std::uint64_t unread_rows) const;

 private:
  bool has_started_ = false;
  ServerTime start_{};  ///< start of the present measurement
  std::uint64_t start_rows_ = 0;
  double ticks_per_second_ = 0;
};

}  // namespace proleg::host
