#pragma once

#include <memory>
#include <string>

#include <mujoco/mujoco.h>

namespace proleg::bench {

struct DeleteMujoco {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using MujocoModel = std::unique_ptr<mjModel, DeleteMujoco>;
using MujocoData = std::unique_ptr<mjData, DeleteMujoco>;

/// Compiles MJCF text. Throws std::runtime_error with MuJoCo's reason.
[[nodiscard]] MujocoModel compile_mjcf(const std::string& text);

}  // namespace proleg::bench
