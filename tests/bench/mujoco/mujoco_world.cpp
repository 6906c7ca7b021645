#include "tests/bench/mujoco/mujoco_world.hpp"

#include <stdexcept>
#include <string>

namespace proleg::bench {
namespace {

std::string& last_warning() {
  static std::string text;
  return text;
}

/// MuJoCo's own handler writes a file where the program was started.
void keep_warning(const char* text) { last_warning() = text; }

}  // namespace

MujocoWorld::MujocoWorld(const mjModel& model)
    : model_(model), data_(mj_makeData(&model)), joint_of_(static_cast<std::size_t>(model.nv)) {
  if (data_ == nullptr) {
    throw std::runtime_error("MuJoCo finds no memory for a world");
  }
  last_warning().clear();
  mju_user_warning = keep_warning;
  for (std::size_t joint = 0;; ++joint) {
    const int id = mj_name2id(&model, mjOBJ_JOINT, ("joint " + std::to_string(joint)).c_str());
    if (id < 0) {
      break;
    }
    angle_place_.push_back(model.jnt_qposadr[id]);
    joint_of_[static_cast<std::size_t>(model.jnt_dofadr[id])] = joint;
  }
  speeds_.resize(angle_place_.size());
}

void MujocoWorld::step() {
  mj_step1(&model_, data_.get());
  aim_motors();
  mj_step2(&model_, data_.get());
  if (!last_warning().empty()) {
    throw std::runtime_error("MuJoCo warns: " + last_warning());
  }
}

/// A constraint pulls towards a reference acceleration: here the one that leads to the wanted speed within the step.
void MujocoWorld::aim_motors() {
  for (int row = data_->ne; row < data_->ne + data_->nf; ++row) {
    const double wanted = speeds_[joint_of_[static_cast<std::size_t>(data_->efc_id[row])]];
    data_->efc_aref[row] = (wanted - data_->efc_vel[row]) / model_.opt.timestep;
  }
}

Eigen::Vector3d MujocoWorld::center_of_mass() {
  mj_kinematics(&model_, data_.get());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double mass = 0.0;
  for (int body = 1; body < model_.nbody; ++body) {
    sum += model_.body_mass[body] * Eigen::Map<const Eigen::Vector3d>(data_->xipos + 3 * body);
    mass += model_.body_mass[body];
  }
  return sum / mass;
}

}  // namespace proleg::bench
