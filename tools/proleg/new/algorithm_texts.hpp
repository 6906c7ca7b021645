#pragma once

// The files in algorithm_template/. CMake makes their texts strings of the program. @NAME@, @ID@, @SOURCE@ (the
// checkout) and @FOLDER@ stand for texts that `proleg new algorithm` fills in.

#include <string_view>

namespace proleg::tools {

[[nodiscard]] std::string_view algorithm_source_text();
[[nodiscard]] std::string_view algorithm_test_text();
[[nodiscard]] std::string_view algorithm_cmake_text();
[[nodiscard]] std::string_view algorithm_actuation_text();
[[nodiscard]] std::string_view algorithm_readme_text();

}  // namespace proleg::tools
