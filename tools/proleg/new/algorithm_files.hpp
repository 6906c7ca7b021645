#pragma once

// The files of a user's algorithm, for `proleg new algorithm`.

#include <cstdint>
#include <string>
#include <vector>

#include "tools/proleg/new/robot_files.hpp"

namespace proleg::tools {

/// Where the algorithm is and which checkout it is for, for the commands in README.md. id: of the algorithm.
struct AlgorithmPlace {
  std::string name;
  std::uint8_t id;
  std::string folder;
  std::string source_tree;
};

/// One source with a small algorithm that moves a robot, its test, CMakeLists.txt, README.md, and in robot/ the files
/// of a robot of five joints that it moves.
[[nodiscard]] std::vector<NewFile> algorithm_files(const AlgorithmPlace& place);

}  // namespace proleg::tools
