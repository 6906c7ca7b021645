#include "sim/reduced/spatial_batch.hpp"

#include <algorithm>
#include <initializer_list>

#include "sim/reduced/chain_batch.hpp"
#include "sim/reduced/lane_blocks.hpp"
#include "sim/reduced/spatial_memory.hpp"
#include "sim/reduced/spatial_scratch.hpp"

namespace proleg::sim::reduced {

class SpatialBatch::Implementation {
 public:
  Implementation(const Models& chains, const ChainKernel& kernel)
      : kernel_(kernel),
        form_of_(*chains.front()),
        form_{{form_of_.links.size(), form_of_.joints.size(), form_of_.boxes.size(),
               corners_of_box * form_of_.boxes.size()},
              form_of_.links.data(),
              form_of_.joints.data(),
              form_of_.boxes.data(),
              form_of_.floor,
              form_of_.self_collision,
              form_of_.step_s},
        blocks_(chains.size(), static_cast<std::size_t>(kernel.width), SpatialMemory<double>::size(form_.counts),
                SpatialScratch<double>::size(form_.counts)),
        memory_(blocks_.block(0), form_.counts, static_cast<std::size_t>(kernel.width)) {
    for (std::size_t lane = 0; lane < blocks_.lanes(); ++lane) {
      set_constants(lane, *chains[std::min(lane, chains.size() - 1)]);
    }
    forget_places();
    place();
    for (std::size_t lane = 0; lane < blocks_.lanes(); ++lane) {
      // Now the positions of the links from the centre of mass are known.
      const Point3& first = chains[std::min(lane, chains.size() - 1)]->first_link;
      of(lane, memory_.center, 0) = first.x - of(lane, memory_.link_position, 0);
      of(lane, memory_.center, 1) = first.y - of(lane, memory_.link_position, 1);
      of(lane, memory_.center, 2) = first.z - of(lane, memory_.link_position, 2);
    }
  }

  [[nodiscard]] std::size_t size() const { return blocks_.size(); }
  [[nodiscard]] const SpatialCounts& counts() const { return form_.counts; }
  [[nodiscard]] const BoxForm& box(std::size_t number) const { return form_.boxes[number]; }

  void step() {
    blocks_.step([&](double* block) { return kernel_.step_strong_in_space(form_, block, blocks_.scratch()); },
                 [&](double* block) { kernel_.step_weak_in_space(form_, block, blocks_.scratch()); },
                 [&](std::size_t from, std::size_t to) { copy(memory_.mass, from, to); },
                 [&](std::size_t from, std::size_t to) { copy(memory_.is_free, from, to); });
    forget_places();
  }

  void forget_places() { places_are_current_ = false; }
  /// The places of the links in the present state, not those before the last step.
  void place() {
    if (!places_are_current_) {
      for (std::size_t block = 0; block < blocks_.blocks(); ++block) {
        kernel_.place_in_space(form_, blocks_.block(block), blocks_.scratch());
      }
      places_are_current_ = true;
    }
  }

  /// Of the first block.
  [[nodiscard]] const SpatialMemory<double>& memory() const { return memory_; }
  /// Number i of an array of memory(), but of this lane.
  [[nodiscard]] double& of(std::size_t lane, const double* array, std::size_t i) const {
    return blocks_.of(lane, array, i);
  }
  [[nodiscard]] Point3 point_of(std::size_t lane, const double* array, std::size_t i) const {
    return {of(lane, array, 3 * i), of(lane, array, 3 * i + 1), of(lane, array, 3 * i + 2)};
  }

 private:
  /// From this array on.
  void copy(const double* first, std::size_t from, std::size_t to) {
    blocks_.copy(from, to, first, blocks_.numbers_between(first, memory_.contact_corner));
    const auto contacts = static_cast<std::size_t>(of(from, memory_.contact_count, 0));
    blocks_.copy(from, to, memory_.contact_corner, contacts);
    blocks_.copy(from, to, memory_.impulse, 3 * contacts);
  }

  void set_constants(std::size_t lane, const SpatialModel& chain) {
    const auto set = [&](double* array, std::span<const double> values) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        of(lane, array, i) = values[i];
      }
    };
    set(memory_.mass, chain.masses);
    set(memory_.inertia, chain.inertias);
    set(memory_.friction, chain.friction);
    set(memory_.orientation, chain.orientation);
    const double gravity[] = {chain.gravity.x, chain.gravity.y, chain.gravity.z};
    set(memory_.gravity, gravity);
    double mass = 0.0;
    for (const double of_link : chain.masses) {
      mass += of_link;
    }
    of(lane, memory_.inverse_mass, 0) = 1.0 / mass;
  }

  const ChainKernel& kernel_;
  SpatialModel form_of_;  ///< owns what form_ points to
  SpatialForm form_;
  LaneBlocks blocks_;
  SpatialMemory<double> memory_;  ///< of the first block
  bool places_are_current_ = false;
};

SpatialBatch::SpatialBatch(const Models& chains, const ChainKernel* kernel)
    : implementation_(
          std::make_unique<Implementation>(chains, kernel != nullptr ? *kernel : choose_kernel(chains.size()))) {}
SpatialBatch::~SpatialBatch() = default;

std::size_t SpatialBatch::size() const { return implementation_->size(); }
void SpatialBatch::step() { implementation_->step(); }

void SpatialBatch::set_wanted_speed(std::size_t chain, std::size_t joint, double speed) {
  implementation_->of(chain, implementation_->memory().wanted_speed, joint) = speed;
}

void SpatialBatch::set_wanted_speeds(std::size_t chain, std::span<const double> speeds) {
  const SpatialMemory<double>& memory = implementation_->memory();
  for (std::size_t joint = 0; joint < speeds.size(); ++joint) {
    implementation_->of(chain, memory.wanted_speed, joint) = speeds[joint];
  }
}

void SpatialBatch::set_max_torque(std::size_t chain, std::size_t joint, double torque) {
  implementation_->of(chain, implementation_->memory().max_torque, joint) = torque;
}

void SpatialBatch::read_joints(std::size_t chain, std::span<double> angles, std::span<double> torques) const {
  const SpatialMemory<double>& memory = implementation_->memory();
  for (std::size_t joint = 0; joint < angles.size(); ++joint) {
    angles[joint] = implementation_->of(chain, memory.joint_angle, joint);
    torques[joint] = implementation_->of(chain, memory.motor_torque, joint);
  }
}

double SpatialBatch::joint_angle(std::size_t chain, std::size_t joint) const {
  return implementation_->of(chain, implementation_->memory().joint_angle, joint);
}

double SpatialBatch::motor_torque(std::size_t chain, std::size_t joint) const {
  return implementation_->of(chain, implementation_->memory().motor_torque, joint);
}

void SpatialBatch::add_contact_forces(std::size_t chain, std::span<double> sums) const {
  const SpatialMemory<double>& memory = implementation_->memory();
  for (std::size_t link = 0; link < sums.size(); ++link) {
    sums[link] += implementation_->of(chain, memory.contact_force, link);
  }
}

Point3 SpatialBatch::center(std::size_t chain) const {
  return implementation_->point_of(chain, implementation_->memory().center, 0);
}

SpatialBatch::LinkPlace SpatialBatch::link_place(std::size_t chain, std::size_t link) const {
  implementation_->place();
  const SpatialMemory<double>& memory = implementation_->memory();
  const Point3 middle = center(chain);
  const Point3 from_middle = implementation_->point_of(chain, memory.link_position, link);
  LinkPlace place{{middle.x + from_middle.x, middle.y + from_middle.y, middle.z + from_middle.z}, {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place.axes[axis] = implementation_->point_of(chain, memory.link_turn, 3 * link + axis);
  }
  return place;
}

SpatialBatch::LinkMotion SpatialBatch::link_motion(std::size_t chain, std::size_t link) const {
  const SpatialMemory<double>& memory = implementation_->memory();
  const Point3 of_center = implementation_->point_of(chain, memory.center_speed, 0);
  const Point3 own = implementation_->point_of(chain, memory.link_speed, link);
  return {{of_center.x + own.x, of_center.y + own.y, of_center.z + own.z},
          implementation_->point_of(chain, memory.rotation, link),
          implementation_->point_of(chain, memory.spin_momentum, link)};
}

std::uint8_t SpatialBatch::pressed(std::size_t chain, std::size_t link) const {
  return static_cast<std::uint8_t>(implementation_->of(chain, implementation_->memory().pressed, link));
}

double SpatialBatch::contact_force(std::size_t chain, std::size_t link) const {
  return implementation_->of(chain, implementation_->memory().contact_force, link);
}

std::size_t SpatialBatch::contact_count(std::size_t chain) const {
  return static_cast<std::size_t>(implementation_->of(chain, implementation_->memory().contact_count, 0));
}

ContactSliding SpatialBatch::sliding(std::size_t chain) const {
  const Point3 sliding = implementation_->point_of(chain, implementation_->memory().sliding, 0);
  return {sliding.x, sliding.y, sliding.z};
}

std::optional<std::pair<std::size_t, std::size_t>> SpatialBatch::touching_links(std::size_t chain) const {
  const double code = implementation_->of(chain, implementation_->memory().overlap, 0);
  if (code == 0.0) {
    return std::nullopt;
  }
  const std::size_t boxes = implementation_->counts().boxes;
  const std::size_t pair = static_cast<std::size_t>(code) - 1;
  return std::pair(implementation_->box(pair % boxes).link, implementation_->box(pair / boxes).link);
}

bool SpatialBatch::failed(std::size_t chain) const {
  return implementation_->of(chain, implementation_->memory().failed, 0) != 0.0;
}

std::vector<double> SpatialBatch::state(std::size_t chain) const {
  const SpatialMemory<double>& memory = implementation_->memory();
  const SpatialCounts& counts = implementation_->counts();
  std::vector<double> state;
  const auto add = [&](double* array, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      state.push_back(implementation_->of(chain, array, i));
    }
  };
  add(memory.center, 3);
  add(memory.center_speed, 3);
  add(memory.orientation, 4);
  add(memory.joint_angle, counts.joints);
  add(memory.link_speed, 3 * counts.links);
  add(memory.spin_momentum, 3 * counts.links);
  return state;
}

SpatialBatch::Orientation SpatialBatch::orientation(std::size_t chain) const {
  double* const numbers = implementation_->memory().orientation;
  return {implementation_->of(chain, numbers, 0), implementation_->of(chain, numbers, 1),
          implementation_->of(chain, numbers, 2), implementation_->of(chain, numbers, 3)};
}

void SpatialBatch::move(std::size_t chain, const Point3& center, const Orientation& orientation) {
  const SpatialMemory<double>& memory = implementation_->memory();
  const SpatialCounts& counts = implementation_->counts();
  const auto set = [&](double* array, std::initializer_list<double> values) {
    std::size_t i = 0;
    for (const double value : values) {
      implementation_->of(chain, array, i++) = value;
    }
  };
  const auto clear = [&](double* array, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      implementation_->of(chain, array, i) = 0.0;
    }
  };
  set(memory.center, {center.x, center.y, center.z});
  set(memory.orientation, {orientation.w, orientation.x, orientation.y, orientation.z});
  clear(memory.center_speed, 3);
  clear(memory.link_speed, 3 * counts.links);
  clear(memory.spin_momentum, 3 * counts.links);
  clear(memory.rotation, 3 * counts.links);
  clear(memory.motor_torque, counts.joints);
  clear(memory.contact_force, counts.links);
  clear(memory.pressed, counts.links);
  clear(memory.sliding, 3);
  clear(memory.contact_count, 1);
  implementation_->forget_places();
}

}  // namespace proleg::sim::reduced
