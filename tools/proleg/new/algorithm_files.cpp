#include "tools/proleg/new/algorithm_files.hpp"

#include <cstddef>
#include <string_view>
#include <utility>

#include "tools/proleg/new/algorithm_texts.hpp"

namespace proleg::tools {
namespace {

std::string filled(std::string_view text, const AlgorithmPlace& place) {
  std::string result(text);
  const auto replace = [&result](std::string_view key, const std::string& value) {
    for (std::size_t at = result.find(key); at != std::string::npos; at = result.find(key, at + value.size())) {
      result.replace(at, key.size(), value);
    }
  };
  replace("@NAME@", place.name);
  replace("@ID@", std::to_string(place.id));
  replace("@SOURCE@", place.source_tree);
  replace("@FOLDER@", place.folder);
  return result;
}

}  // namespace

std::vector<NewFile> algorithm_files(const AlgorithmPlace& place) {
  std::vector<NewFile> files{{"README.md", filled(algorithm_readme_text(), place)},
                             {place.name + ".cpp", filled(algorithm_source_text(), place)},
                             {place.name + "_test.cpp", filled(algorithm_test_text(), place)},
                             {"CMakeLists.txt", filled(algorithm_cmake_text(), place)}};
  for (NewFile& file : robot_files(robot_kinds().front(), "ppppp")) {
    if (file.name == "robot.actuation.xml") {
      file.text = filled(algorithm_actuation_text(), place);
    }
    files.push_back({"robot/" + file.name, std::move(file.text)});
  }
  return files;
}

}  // namespace proleg::tools
