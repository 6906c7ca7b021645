#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace proleg::sim {

/// What computes the motion (docs/physics.md).
enum class PhysicsEngine : std::uint8_t {
  ode,      ///< the Open Dynamics Engine: any robot, any environment
  reduced,  ///< chains of boxes; the same bits on every machine
  mujoco,   ///< a second opinion, if the program is built with it
};

struct PhysicsEngineName {
  PhysicsEngine engine;
  std::string_view word;   ///< in --engine and <physicsengine>
  std::string_view title;  ///< in a sentence
};

/// In the order of PhysicsEngine.
inline constexpr std::array<PhysicsEngineName, 3> physics_engines{
    {{PhysicsEngine::ode, "ode", "ODE"},
     {PhysicsEngine::reduced, "reduced", "the reduced engine"},
     {PhysicsEngine::mujoco, "mujoco", "MuJoCo"}}};

[[nodiscard]] constexpr std::string_view name_of(PhysicsEngine engine) {
  return physics_engines.at(static_cast<std::size_t>(engine)).word;
}
[[nodiscard]] constexpr std::string_view title_of(PhysicsEngine engine) {
  return physics_engines.at(static_cast<std::size_t>(engine)).title;
}

[[nodiscard]] constexpr std::optional<PhysicsEngine> engine_named(std::string_view word) {
  for (const PhysicsEngineName& name : physics_engines) {
    if (name.word == word) {
      return name.engine;
    }
  }
  return std::nullopt;
}

/// "'ode', 'reduced' or 'mujoco'"
[[nodiscard]] inline std::string engine_words() {
  std::string text;
  for (std::size_t i = 0; i < physics_engines.size(); ++i) {
    text += (i == 0                           ? "'"
             : i + 1 < physics_engines.size() ? ", '"
                                              : " or '") +
            std::string(physics_engines[i].word) + "'";
  }
  return text;
}

}  // namespace proleg::sim
