#include "tools/proleg/ui/shipped_scenarios.hpp"

#include <array>

#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"

namespace proleg::tools {
namespace {

constexpr std::string_view gaits = "Gaits";
constexpr std::string_view generators = "Gait generators";
constexpr std::string_view worlds = "Worlds and robots";
constexpr std::string_view experiments = "Experiments";

constexpr std::array scenarios{
    ShippedScenario{"gaits/forward", gaits, "Forward", ""},
    ShippedScenario{"gaits/reverse", gaits, "Reverse", ""},
    ShippedScenario{"gaits/rectilinear", gaits, "Rectilinear", ""},
    ShippedScenario{"gaits/turning", gaits, "Turning", ""},
    ShippedScenario{"gaits/backward_roll", gaits, "Backward roll", ""},
    ShippedScenario{"gaits/sidewinding", gaits, "Sidewinding", ""},
    ShippedScenario{"gaits/rolling", gaits, "Rolling", ""},
    ShippedScenario{"gaits/serpentine", gaits, "Serpentine", ""},
    ShippedScenario{"gaits/serpenoid", gaits, "Serpenoid curve", ""},
    ShippedScenario{"travelling_wave/uniform", generators, "Travelling wave", ""},
    ShippedScenario{"travelling_wave/tail_fixed", generators, "Travelling wave, tail held still", ""},
    ShippedScenario{"travelling_wave/coupled", generators, "Coupled phase oscillators", ""},
    ShippedScenario{"gaits/hopf", generators, "Hopf oscillators", ""},
    ShippedScenario{"gaits/matsuoka", generators, "Matsuoka oscillators", ""},
    ShippedScenario{"gaits/half_centre", generators, "Half-centres", ""},
    ShippedScenario{"gaits/push_pull", generators, "Bursting neurons", ""},
    ShippedScenario{"gaits/mtran", generators, "M-TRAN", ""},
    ShippedScenario{"gaits/asymmetric", generators, "Asymmetric wave", ""},
    ShippedScenario{"obstacle/reflex", worlds, "A terrace, with a reflex", ""},
    ShippedScenario{"obstacle/plain", worlds, "A terrace, without a reflex",
                    "The same wave on the same terrace, but no reflex: the robot stays at the first step."},
    ShippedScenario{"retreat/wall", worlds, "A wall", ""},
    ShippedScenario{"robots/mesh_world/mesh_world", worlds, "Hills, a ball and a crate", ""},
    ShippedScenario{"robots/y1/robot", worlds, "Y1 modules",
                    "A caterpillar of Y1 modules, as the detailed model of the thesis: each module is a mesh."},
    ShippedScenario{"robots/cubo/robot", worlds, "CUBO modules",
                    "A caterpillar of CUBO modules: cubes with small feet, whose rubber grips the ground."},
    ShippedScenario{"robots/cube_chain/robot", worlds, "A chain of cubes",
                    "Seven joints between cubes: the simple model of the thesis."},
    ShippedScenario{"robots/snake/robot", worlds, "A snake of pitch and yaw joints",
                    "Two waves, one up and down and one to the sides, move the snake sideways."},
    ShippedScenario{"adaptive_touch/reflex", experiments, "Adaptive touch on the obstacle", ""},
    ShippedScenario{"adaptive_touch/plain", experiments, "The obstacle without adaptive touch", ""},
    ShippedScenario{"adaptive_touch/reflex_level", experiments, "Adaptive touch on level ground",
                    "The sine and the reflex where there is no obstacle, to compare."},
    ShippedScenario{"adaptive_touch/plain_level", experiments, "Level ground without adaptive touch",
                    "The sine of the thesis's experiment 6.2 on level ground: how far it goes in the same time."},
    ShippedScenario{"long_chain/twenty", experiments, "Twenty joints", ""},
    ShippedScenario{"long_chain/sixty", experiments, "Sixty joints", ""},
};

}  // namespace

std::span<const ShippedScenario> shipped_scenarios() { return scenarios; }

std::optional<std::filesystem::path> shipped_folder() {
  try {
    return source_tree("") / "sim/scenarios";
  } catch (const BadInput&) {
    return std::nullopt;
  }
}

}  // namespace proleg::tools
