#pragma once

// Files of the shipped travelling_wave that are also those of a new robot. CMake makes their texts strings of the
// program.

#include <string_view>

namespace proleg::tools {

[[nodiscard]] std::string_view floor_text();    ///< flat.environment.xml
[[nodiscard]] std::string_view tail_text();     ///< modules/tail.kinbody.xml
[[nodiscard]] std::string_view segment_text();  ///< modules/segment.kinbody.xml
[[nodiscard]] std::string_view head_text();     ///< modules/head.kinbody.xml

}  // namespace proleg::tools
