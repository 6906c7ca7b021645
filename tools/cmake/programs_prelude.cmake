# What nearly every source of sim and tools includes, compiled once. Only with clang: gcc compiles each source by itself,
# so a missing include is found there.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND NOT CMAKE_CROSSCOMPILING)
  find_package(Eigen3 REQUIRED NO_MODULE)
  add_library(programs_prelude OBJECT ${CMAKE_CURRENT_LIST_DIR}/prelude.cpp)
  target_link_libraries(programs_prelude PRIVATE Eigen3::Eigen)
  target_precompile_headers(programs_prelude PRIVATE
    <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <memory> <optional>
    <span> <sstream> <string> <string_view> <vector>)
  target_compile_options(programs_prelude PRIVATE -Xclang -fno-pch-timestamp)  # else ccache does not know it again
endif()
