#include "tests/bench/mujoco/mujoco_model.hpp"

#include <array>
#include <cstring>
#include <stdexcept>

namespace proleg::bench {

MujocoModel compile_mjcf(const std::string& text) {
  constexpr const char* name = "robot.xml";
  const auto files = std::make_unique<mjVFS>();  // of megabytes
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(text.size())) != 0) {
    throw std::runtime_error("MuJoCo takes no file of " + std::to_string(text.size()) + " bytes");
  }
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], text.data(), text.size());
  std::array<char, 1000> reason{};
  MujocoModel model(mj_loadXML(name, files.get(), reason.data(), static_cast<int>(reason.size())));
  mj_deleteVFS(files.get());
  if (model == nullptr) {
    throw std::runtime_error("MuJoCo refuses the model: " + std::string(reason.data()));
  }
  return model;
}

}  // namespace proleg::bench
