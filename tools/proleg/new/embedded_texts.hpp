#pragma once

// Files that CMake makes strings of the program.

#include <string_view>

namespace proleg::tools {

// Files of the shipped travelling_wave that a new robot has too.
[[nodiscard]] std::string_view floor_text();    ///< flat.environment.xml
[[nodiscard]] std::string_view tail_text();     ///< modules/tail.kinbody.xml
[[nodiscard]] std::string_view segment_text();  ///< modules/segment.kinbody.xml
[[nodiscard]] std::string_view head_text();     ///< modules/head.kinbody.xml

// The files in algorithm_template/. @NAME@, @ID@, @SOURCE@ (the checkout) and @FOLDER@ stand for texts that
// `proleg new algorithm` fills in.
[[nodiscard]] std::string_view algorithm_source_text();
[[nodiscard]] std::string_view algorithm_test_text();
[[nodiscard]] std::string_view algorithm_cmake_text();
[[nodiscard]] std::string_view algorithm_actuation_text();
[[nodiscard]] std::string_view algorithm_readme_text();

}  // namespace proleg::tools
