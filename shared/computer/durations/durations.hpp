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
  void add(std::uint64_t duration);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// The smallest duration that at least `percent` per cent (1 to 100) of all do not exceed; nothing without durations.
  [[nodiscard]] std::optional<std::uint64_t> percentile(unsigned percent) const;
  [[nodiscard]] std::optional<std::uint64_t> median() const { return percentile(50); }

 private:
  std::map<std::uint64_t, std::uint64_t> counts_;  ///< number of durations with each value
  std::uint64_t count_ = 0;
};

}  // namespace proleg
