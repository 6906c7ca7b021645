#include "tools/proleg/new/new_obstacle.hpp"

#include <array>
#include <iostream>
#include <optional>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/new/new_files.hpp"
#include "tools/proleg/new/obstacle_files.hpp"

namespace proleg::tools {
namespace {

constexpr std::size_t most_hills = 50;

struct Options {
  std::string heights = "32,43,-43,43";
  std::string length = "400";
  std::string start = "360";
  std::string width = "2000";
  std::string segments = "10";
  std::string friction = "0.6";
  std::string floor_friction = "0.1";
  std::string out = "obstacle";
};

struct Range {
  double least;
  double most;
};

double parse(const char* option, std::string_view word, Range range) {
  const std::optional<double> number = parse_number(word);
  if (!number || !(*number >= range.least && *number <= range.most)) {
    throw InputError(option, 0, in_quotes(word),
                     "a number from " + number_text(range.least) + " to " + number_text(range.most));
  }
  return *number;
}

std::vector<double> parse_heights(const std::string& text) {
  std::vector<double> heights;
  std::size_t start = 0;
  while (start <= text.size()) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    heights.push_back(parse("--heights", text.substr(start, end - start), {-500, 500}));
    start = end + 1;
  }
  if (heights.size() > most_hills) {
    throw InputError("--heights", 0, std::to_string(heights.size()) + " hills",
                     "at most " + std::to_string(most_hills));
  }
  return heights;
}

Obstacle parse_obstacle(const Options& options) {
  Obstacle obstacle;
  obstacle.heights_mm = parse_heights(options.heights);
  obstacle.length_mm = parse("--length", options.length, {20, 5'000});
  obstacle.start_mm = parse("--start", options.start, {0, 5'000});
  obstacle.width_mm = parse("--width", options.width, {50, 16'000});
  const std::optional<unsigned> segments = parse_whole<unsigned>(options.segments);
  if (!segments || *segments < 2 || *segments > 100) {
    throw InputError("--segments", 0, in_quotes(options.segments), "a whole number from 2 to 100");
  }
  obstacle.segments = *segments;
  obstacle.friction = parse("--friction", options.friction, {0, 10});
  obstacle.floor_friction = parse("--floor-friction", options.floor_friction, {0, 10});
  return obstacle;
}

int write(const Options& options) {
  const std::array<NewFile, 1> files{NewFile{"obstacle.environment.xml", obstacle_text(parse_obstacle(options))}};
  write_new_files(options.out, files);
  std::cout << "use it:  <environment>" << options.out
            << "/obstacle.environment.xml</environment> in a top-level file\n";
  return exit_success;
}

}  // namespace

int new_obstacle(int argc, char** argv) {
  CommandLine command_line("proleg new obstacle",
                           "Writes an environment: a floor with hills and pits across the way of the robot. Without "
                           "options it is the obstacle of sim/scenarios/adaptive_touch.");
  Options options;
  command_line
      .add_option("--heights", options.heights,
                  "height of each hill in mm, first the one that the robot meets first; below 0: a pit")
      .value_name("MM,MM,...")
      .shows_default();
  command_line.add_option("--length", options.length, "length of each hill in mm, 20 to 5000")
      .value_name("MM")
      .shows_default();
  command_line.add_option("--start", options.start, "from the robot's position to the first hill in mm, 0 to 5000")
      .value_name("MM")
      .shows_default();
  command_line.add_option("--width", options.width, "of the hills in mm, 50 to 16000").value_name("MM").shows_default();
  command_line.add_option("--segments", options.segments, "flat pieces of each hill, 2 to 100")
      .value_name("N")
      .shows_default();
  command_line.add_option("--friction", options.friction, "coefficient of friction of the hills, 0 to 10")
      .value_name("X")
      .shows_default();
  command_line.add_option("--floor-friction", options.floor_friction, "that of the floor")
      .value_name("X")
      .shows_default();
  command_line.add_option("--out", options.out, "folder for the file, which must not exist")
      .value_name("FOLDER")
      .shows_default();
  return command_line.run(argc, argv, [&] { return write(options); });
}

}  // namespace proleg::tools
