#include "tools/proleg/common/durations_text.hpp"

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

constexpr unsigned slow = 99;  // per cent

std::optional<double> scaled(const std::optional<std::uint64_t>& duration, double factor) {
  return duration ? std::optional(static_cast<double>(*duration) * factor) : std::nullopt;
}

}  // namespace

std::string durations_text(const Durations& durations, double factor, const std::string& unit,
                           const std::string& counted) {
  if (durations.count() == 0) {
    return "none";
  }
  return number_text(*scaled(durations.median(), factor)) + " " + unit + " (median), 99 % within " +
         number_text(*scaled(durations.percentile(slow), factor)) + " " + unit + "; " +
         std::to_string(durations.count()) + " " + counted;
}

Json durations_object(const Durations& durations, double factor) {
  return {{"count", durations.count()},
          {"median", scaled(durations.median(), factor)},
          {"p99", scaled(durations.percentile(slow), factor)}};
}

}  // namespace proleg::tools
