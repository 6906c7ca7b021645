#include "sim/mujoco/mujoco_model.hpp"

#include <array>
#include <cstring>
#include <mutex>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/mujoco/box_collision.hpp"
#include "sim/physics/physics_error.hpp"

namespace proleg::sim::mujoco {
namespace {

// MuJoCo ends the process when this returns; an exception is the only way out.
[[noreturn]] void raise_error(const char* text) { throw PhysicsError("MuJoCo reports: " + one_line(text)); }

/// MuJoCo's own function writes a file where the program was started. MujocoWorld reads warnings from its data.
void ignore_warning(const char* /*text*/) {}

}  // namespace

Model compile_mjcf(const std::string& text, const std::string& file) {
  static std::mutex mutex;  // MuJoCo keeps the last model that it compiled
  const std::lock_guard lock(mutex);
  mju_user_error = raise_error;
  mju_user_warning = ignore_warning;
  mend_box_collision();
  constexpr const char* name = "robot.xml";
  const auto files = std::make_unique<mjVFS>();  // of megabytes
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(text.size())) != 0) {
    throw PhysicsError("MuJoCo takes no model of " + std::to_string(text.size()) + " bytes");
  }
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], text.data(), text.size());
  std::array<char, 1000> reason{};
  Model model(mj_loadXML(name, files.get(), reason.data(), static_cast<int>(reason.size())));
  mj_deleteVFS(files.get());
  if (model == nullptr) {
    throw InputError(file, 0, "what MuJoCo refuses: " + one_line(reason.data()),
                     "a robot and an environment that it has (or --engine ode)");
  }
  return model;
}

}  // namespace proleg::sim::mujoco
