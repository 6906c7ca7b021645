#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>
#include <vector>

namespace proleg::test {

/// The lines that a shell command prints, each with its line end. The test fails if the command does.
inline std::vector<std::string> lines_of(const std::string& command) {
  std::FILE* const pipe = popen(command.c_str(), "r");
  std::vector<std::string> lines;
  if (pipe == nullptr) {
    ADD_FAILURE() << command;
    return lines;
  }
  std::array<char, 1024> line{};
  while (std::fgets(line.data(), line.size(), pipe) != nullptr) {
    lines.emplace_back(line.data());
  }
  EXPECT_EQ(pclose(pipe), 0) << command;
  return lines;
}

}  // namespace proleg::test
