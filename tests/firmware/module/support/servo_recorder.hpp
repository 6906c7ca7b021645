#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/module/ports.hpp"

namespace proleg::test {

/// A servo that records its commands.
struct ServoRecorder final : firmware::ServoPort {
  void pulse(std::int32_t width, std::uint32_t repetition_us) override {
    widths.push_back(width);
    period_us = repetition_us;
  }
  void off() override { widths.push_back(std::nullopt); }

  std::vector<std::optional<std::int32_t>> widths;  ///< in twelfths of a microsecond; nothing: off
  std::uint32_t period_us = 0;                      ///< period of the last pulse
};

}  // namespace proleg::test
