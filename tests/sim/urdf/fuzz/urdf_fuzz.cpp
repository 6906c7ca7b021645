// Imports arbitrary bytes as a robot in URDF. The import must give a scenario that the reader accepts, with lists of
// lines, or throw an InputError of one line.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/urdf/urdf_import.hpp"
#include "tests/support/fuzz_input.hpp"

using namespace proleg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sim::SourceTexts files;
  files.add("robot.urdf", std::string(reinterpret_cast<const char*>(data), size));
  const auto is_line = [](const std::string& text) { return !text.empty() && text.find('\n') == std::string::npos; };
  try {
    const sim::UrdfImport import = sim::import_urdf("robot.urdf", files);
    test::require(import.files.size() == 4, "a robot without meshes has four files");
    for (const auto* list : {&import.notes, &import.lost, &import.warnings}) {
      test::require(std::ranges::all_of(*list, [](const std::string& text) { return !text.empty(); }),
                    "no note is empty");
    }
    sim::SourceTexts written;
    for (const sim::SourceFile& file : import.files) {
      written.add(file.path, file.text);
    }
    static_cast<void>(sim::read_scenario(import.files.front().path, written));
  } catch (const InputError& error) {
    test::require(is_line(error.what()), "a message is one line");
  }
  return 0;
}
