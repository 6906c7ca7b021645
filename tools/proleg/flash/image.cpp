// proleg image: files with images of modules.

#include <algorithm>
#include <string>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/flash/image_commands.hpp"

int main(int argc, char** argv) {
  using namespace proleg;
  const std::string_view word = argc > 1 ? argv[1] : "";
  if (word == "info") {
    return tools::run_image_info(argc - 1, argv + 1);
  }
  if (word == "make") {
    return tools::run_image_make(argc - 1, argv + 1);
  }
  tools::CommandLine command_line(
      "proleg image",
      "Shows and makes images: the files that are flashed into modules (docs/flashing.md).\n"
      "'proleg image info --help' and 'proleg image make --help' explain the two actions.");
  std::string action;
  command_line
      .add_option(
          "ACTION", action,
          "info FILE...: show what images contain and whether they are intact; make BODY --output FILE ...: put "
          "a header in front of a program")
      .required()
      .value_name("");
  // What follows belongs to an action that does not exist.
  return command_line.run(std::min(argc, 2), argv,
                          [&]() -> int { throw InputError("ACTION", 0, in_quotes(action), "info or make"); });
}
