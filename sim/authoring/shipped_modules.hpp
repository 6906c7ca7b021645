#pragma once

// Files of the shipped travelling_wave that a new scenario has, too; CMake makes strings of the program of them.

#include <string_view>

namespace proleg::sim {

[[nodiscard]] std::string_view floor_text();    ///< flat.environment.xml
[[nodiscard]] std::string_view tail_text();     ///< modules/tail.kinbody.xml
[[nodiscard]] std::string_view segment_text();  ///< modules/segment.kinbody.xml
[[nodiscard]] std::string_view head_text();     ///< modules/head.kinbody.xml

}  // namespace proleg::sim
