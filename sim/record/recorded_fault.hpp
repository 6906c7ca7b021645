#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace proleg::sim {

/// Something that was made to fail. Times in microseconds after SYNC 0.
struct RecordedFault {
  std::uint64_t start_us = 0;
  std::optional<std::uint64_t> end_us;  ///< nothing: to the end of the run, or it happens once
  std::optional<std::uint32_t> joint;   ///< whose module it befalls; nothing: the whole robot
  std::string text;                     ///< as in a fault schedule
};

}  // namespace proleg::sim
