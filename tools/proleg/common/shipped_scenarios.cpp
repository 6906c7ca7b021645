#include "tools/proleg/common/shipped_scenarios.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/installation.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view gaits = "Gaits";
constexpr std::string_view generators = "Gait generators";
constexpr std::string_view worlds = "Worlds and robots";
constexpr std::string_view experiments = "Experiments";

constexpr std::array scenarios{
    ShippedScenario{"forward", "gaits/forward", gaits, "Forward", ""},
    ShippedScenario{"reverse", "gaits/reverse", gaits, "Reverse", ""},
    ShippedScenario{"rectilinear", "gaits/rectilinear", gaits, "Rectilinear", ""},
    ShippedScenario{"turning", "gaits/turning", gaits, "Turning", ""},
    ShippedScenario{"backward_roll", "gaits/backward_roll", gaits, "Backward roll", ""},
    ShippedScenario{"sidewinding", "gaits/sidewinding", gaits, "Sidewinding", ""},
    ShippedScenario{"rolling", "gaits/rolling", gaits, "Rolling", ""},
    ShippedScenario{"serpentine", "gaits/serpentine", gaits, "Serpentine", ""},
    ShippedScenario{"serpenoid", "gaits/serpenoid", gaits, "Serpenoid curve", ""},
    ShippedScenario{"caterpillar", "travelling_wave/uniform", generators, "Travelling wave", ""},
    ShippedScenario{"tail_fixed", "travelling_wave/tail_fixed", generators, "Travelling wave, tail held still", ""},
    ShippedScenario{"coupled", "travelling_wave/coupled", generators, "Coupled phase oscillators", ""},
    ShippedScenario{"hopf", "gaits/hopf", generators, "Hopf oscillators", ""},
    ShippedScenario{"matsuoka", "gaits/matsuoka", generators, "Matsuoka oscillators", ""},
    ShippedScenario{"half_centre", "gaits/half_centre", generators, "Half-centres", ""},
    ShippedScenario{"push_pull", "gaits/push_pull", generators, "Bursting neurons", ""},
    ShippedScenario{"mtran", "gaits/mtran", generators, "M-TRAN", ""},
    ShippedScenario{"asymmetric", "gaits/asymmetric", generators, "Asymmetric wave", ""},
    ShippedScenario{"terrace_reflex", "obstacle/reflex", worlds, "A terrace, with a reflex", ""},
    ShippedScenario{"terrace", "obstacle/plain", worlds, "A terrace, without a reflex",
                    "The same wave on the same terrace, but no reflex: the robot stays at the first step."},
    ShippedScenario{"course", "course/chooses", worlds, "A course, with a choice of gaits", ""},
    ShippedScenario{"wall", "retreat/wall", worlds, "A wall", ""},
    ShippedScenario{"mesh_world", "robots/mesh_world/mesh_world", worlds, "Hills, a ball and a crate", ""},
    ShippedScenario{"y1", "robots/y1/robot", worlds, "Y1 modules",
                    "A caterpillar of Y1 modules, as the detailed model of the thesis: each module is a mesh."},
    ShippedScenario{"cubo", "robots/cubo/robot", worlds, "CUBO modules",
                    "A caterpillar of CUBO modules: cubes with small feet, whose rubber grips the ground."},
    ShippedScenario{"cube_chain", "robots/cube_chain/robot", worlds, "A chain of cubes",
                    "Seven joints between cubes: the simple model of the thesis."},
    ShippedScenario{"snake", "robots/snake/robot", worlds, "A snake of pitch and yaw joints",
                    "Two waves, one up and down and one to the sides, move the snake sideways."},
    ShippedScenario{"adaptive_touch", "adaptive_touch/reflex", experiments, "Adaptive touch on the obstacle", ""},
    ShippedScenario{"adaptive_touch_plain", "adaptive_touch/plain", experiments, "The obstacle without adaptive touch",
                    ""},
    ShippedScenario{"adaptive_touch_level", "adaptive_touch/reflex_level", experiments,
                    "Adaptive touch on level ground",
                    "The sine and the reflex where there is no obstacle, to compare."},
    ShippedScenario{"adaptive_touch_plain_level", "adaptive_touch/plain_level", experiments,
                    "Level ground without adaptive touch",
                    "The sine of the thesis's experiment 6.2 on level ground: how far it goes in the same time."},
    ShippedScenario{"twenty_joints", "long_chain/twenty", experiments, "Twenty joints", ""},
    ShippedScenario{"sixty_joints", "long_chain/sixty", experiments, "Sixty joints", ""},
};

}  // namespace

std::span<const ShippedScenario> shipped_scenarios() { return scenarios; }

std::string scenario_file(const std::string& word) { return scenario_file(word, shipped_folder()); }

std::string scenario_file(const std::string& word, const std::optional<fs::path>& folder) {
  std::error_code error;
  if (word.empty() || fs::exists(word, error) || !folder) {
    return word;
  }
  std::vector<std::string> known;
  for (const ShippedScenario& scenario : scenarios) {
    const std::string file = std::string(scenario.file) + scenario_extension;
    if (word == scenario.name || word == scenario.file || word == file) {
      return (*folder / file).string();
    }
    known.emplace_back(scenario.name);
  }
  if (word.find_first_of("./") != std::string::npos) {
    return word;  // it was meant as a file
  }
  const std::optional<std::string> similar = most_similar(word, known);
  throw InputError("FILE", 0, in_quotes(word),
                   "a file, or a name that 'proleg scenarios' lists" +
                       (similar ? "; did you mean " + *similar + "?" : std::string()));
}

CommandLine::Option add_scenario(CommandLine& command_line, std::string& file, const std::string& help) {
  command_line.prepare_with([&file] { file = scenario_file(file); });
  return command_line.add_option("FILE", file,
                                 help + ": a *.simulation.xml file, or a name that 'proleg scenarios' lists");
}

}  // namespace proleg::tools
