#include "sim/scenario/tick_word.hpp"

#include <cmath>
#include <optional>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::sim {

std::uint32_t read_tick(const std::string& word, const std::string& tick, std::uint32_t tick_period_us) {
  if (tick.ends_with('s')) {
    const std::optional<double> seconds = parse_number(std::string_view(tick).substr(0, tick.size() - 1));
    constexpr double longest = 1e7;
    if (!seconds || *seconds < 0 || *seconds > longest) {
      throw InputError(shortened(word), 0, "time " + in_quotes(tick), "seconds from 0 to 10000000, such as 5s");
    }
    constexpr double tolerance = 1e-6;  // 0.07 s are seven ticks of 10 ms
    return static_cast<std::uint32_t>(std::ceil(*seconds * 1e6 / tick_period_us - tolerance));
  }
  const std::optional<std::uint32_t> number = parse_whole<std::uint32_t>(tick);
  if (!number) {
    throw InputError(shortened(word), 0, "tick " + in_quotes(tick),
                     "a whole number from 0 to 4294967295, or seconds such as 5s");
  }
  return *number;
}

}  // namespace proleg::sim
