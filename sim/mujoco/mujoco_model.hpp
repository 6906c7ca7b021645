#pragma once

#include <memory>
#include <string>

#include <mujoco/mujoco.h>

namespace proleg::sim::mujoco {

struct DeleteMujoco {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using Model = std::unique_ptr<mjModel, DeleteMujoco>;
using Data = std::unique_ptr<mjData, DeleteMujoco>;

/// Compiles MJCF text. Throws InputError with MuJoCo's reason and the name `file`. From the first call on, an error of
/// MuJoCo throws PhysicsError and does not end the process.
[[nodiscard]] Model compile_mjcf(const std::string& text, const std::string& file);

}  // namespace proleg::sim::mujoco
