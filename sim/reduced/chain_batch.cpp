#include "sim/reduced/chain_batch.hpp"

#include <algorithm>
#include <span>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/chain_scratch.hpp"
#include "sim/reduced/lane_blocks.hpp"
#include "sim/reduced/sine.hpp"

namespace proleg::sim::reduced {
namespace {

ChainCounts counts_of(const ChainModel& chain) {
  // Two convex outlines touch in at most two points; more than three such pairs for a shape are no crawling robot.
  return {chain.links.size(), chain.joints.size(), chain.shapes.size(), chain.terrain.size(),
          6 * chain.shapes.size() + 4};
}

}  // namespace

std::vector<const ChainKernel*> supported_kernels() {
  std::vector<const ChainKernel*> kernels{&base_kernel};
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") != 0) {
    kernels.push_back(&avx2_kernel);
  }
  if (__builtin_cpu_supports("avx512f") != 0) {
    kernels.push_back(&avx512_kernel);
  }
#endif
  return kernels;
}

const ChainKernel& choose_kernel(std::size_t chains) {
  const std::vector<const ChainKernel*> kernels = supported_kernels();
  const ChainKernel* chosen = kernels.front();
  for (const ChainKernel* kernel : kernels) {
    if (static_cast<std::size_t>(kernel->width) + 2 <= 2 * chains) {
      chosen = kernel;
    }
  }
  return *chosen;
}

class ChainBatch::Implementation {
 public:
  Implementation(const Models& chains, const ChainKernel& kernel)
      : kernel_(kernel),
        form_of_(*chains.front()),
        form_{counts_of(form_of_),     form_of_.links.data(),   form_of_.joints.data(), form_of_.shapes.data(),
              form_of_.terrain.data(), form_of_.self_collision, form_of_.step_s},
        blocks_(chains.size(), static_cast<std::size_t>(kernel.width), ChainMemory<double>::size(form_.counts),
                ChainScratch<double>::size(form_.counts)),
        memory_(blocks_.block(0), form_.counts, static_cast<std::size_t>(kernel.width)) {
    for (std::size_t lane = 0; lane < blocks_.lanes(); ++lane) {
      set_constants(lane, *chains[std::min(lane, chains.size() - 1)]);
    }
    place();
    for (std::size_t lane = 0; lane < blocks_.lanes(); ++lane) {
      // Now the positions of the links from the centre of mass are known.
      const Point& first = chains[std::min(lane, chains.size() - 1)]->first_link;
      of(lane, memory_.center, 0) = first.x - of(lane, memory_.link_position, 0);
      of(lane, memory_.center, 1) = first.z - of(lane, memory_.link_position, 1);
    }
  }

  [[nodiscard]] std::size_t size() const { return blocks_.size(); }
  [[nodiscard]] const ChainKernel& kernel() const { return kernel_; }
  [[nodiscard]] const ChainCounts& counts() const { return form_.counts; }

  void step() {
    blocks_.step([&](double* block) { return kernel_.step_strong(form_, block, blocks_.scratch()); },
                 [&](double* block) { kernel_.step_weak(form_, block, blocks_.scratch()); },
                 [&](std::size_t from, std::size_t to) { copy(memory_.mass, from, to); },
                 [&](std::size_t from, std::size_t to) { copy(memory_.is_free, from, to); });
    forget_places();
  }

  void forget_places() { places_are_current_ = false; }
  /// The links' positions of the present state, not of that before the last step.
  void place() {
    if (!places_are_current_) {
      for (std::size_t block = 0; block < blocks_.blocks(); ++block) {
        kernel_.place(form_, blocks_.block(block), blocks_.scratch());
      }
      places_are_current_ = true;
    }
  }

  /// Of the first block.
  [[nodiscard]] const ChainMemory<double>& memory() const { return memory_; }
  /// Number i of an array of memory(), but of this lane.
  [[nodiscard]] double& of(std::size_t lane, const double* array, std::size_t i) const {
    return blocks_.of(lane, array, i);
  }

 private:
  /// From this array on.
  void copy(const double* first, std::size_t from, std::size_t to) {
    blocks_.copy(from, to, first, blocks_.numbers_between(first, memory_.contact_key));
    const auto contacts = static_cast<std::size_t>(of(from, memory_.contact_count, 0));
    for (const double* const array : {memory_.contact_key, memory_.normal_impulse, memory_.friction_impulse}) {
      blocks_.copy(from, to, array, contacts);
    }
  }

  void set_constants(std::size_t lane, const ChainModel& chain) {
    double mass = 0.0;
    for (std::size_t i = 0; i < chain.masses.size(); ++i) {
      of(lane, memory_.mass, i) = chain.masses[i];
      of(lane, memory_.inertia, i) = chain.inertias[i];
      mass += chain.masses[i];
    }
    of(lane, memory_.inverse_mass, 0) = 1.0 / mass;
    of(lane, memory_.gravity, 0) = chain.gravity.x;
    of(lane, memory_.gravity, 1) = chain.gravity.z;
    for (std::size_t i = 0; i < chain.terrain_friction.size(); ++i) {
      of(lane, memory_.terrain_friction, i) = chain.terrain_friction[i];
    }
    for (std::size_t i = 0; i < chain.self_friction.size(); ++i) {
      of(lane, memory_.self_friction, i) = chain.self_friction[i];
    }
  }

  const ChainKernel& kernel_;
  ChainModel form_of_;  ///< owns what form_ points to
  ChainForm form_;
  LaneBlocks blocks_;
  ChainMemory<double> memory_;  ///< of the first block
  bool places_are_current_ = false;
};

ChainBatch::ChainBatch(const Models& chains, const ChainKernel* kernel)
    : implementation_(
          std::make_unique<Implementation>(chains, kernel != nullptr ? *kernel : choose_kernel(chains.size()))) {}
ChainBatch::~ChainBatch() = default;

std::size_t ChainBatch::size() const { return implementation_->size(); }
const ChainKernel& ChainBatch::kernel() const { return implementation_->kernel(); }
void ChainBatch::step() { implementation_->step(); }

void ChainBatch::set_wanted_speed(std::size_t chain, std::size_t joint, double speed) {
  implementation_->of(chain, implementation_->memory().wanted_speed, joint) = speed;
}

void ChainBatch::set_max_torque(std::size_t chain, std::size_t joint, double torque) {
  implementation_->of(chain, implementation_->memory().max_torque, joint) = torque;
}

double ChainBatch::joint_angle(std::size_t chain, std::size_t joint) const {
  return implementation_->of(chain, implementation_->memory().joint_angle, joint);
}

double ChainBatch::motor_torque(std::size_t chain, std::size_t joint) const {
  return implementation_->of(chain, implementation_->memory().motor_torque, joint);
}

void ChainBatch::set_wanted_speeds(std::size_t chain, std::span<const double> signs, std::span<const double> speeds) {
  const double* const wanted = implementation_->memory().wanted_speed;
  for (std::size_t joint = 0; joint < speeds.size(); ++joint) {
    implementation_->of(chain, wanted, joint) = signs[joint] * speeds[joint];
  }
}

void ChainBatch::read_joints(std::size_t chain, std::span<const double> signs, std::span<double> angles,
                             std::span<double> torques) const {
  const ChainMemory<double>& memory = implementation_->memory();
  for (std::size_t joint = 0; joint < angles.size(); ++joint) {
    angles[joint] = signs[joint] * implementation_->of(chain, memory.joint_angle, joint);
    torques[joint] = signs[joint] * implementation_->of(chain, memory.motor_torque, joint);
  }
}

void ChainBatch::add_contact_forces(std::size_t chain, std::span<double> sums) const {
  for (std::size_t link = 0; link < sums.size(); ++link) {
    sums[link] += contact_force(chain, link);
  }
}

Point ChainBatch::center(std::size_t chain) const {
  const ChainMemory<double>& memory = implementation_->memory();
  return {implementation_->of(chain, memory.center, 0), implementation_->of(chain, memory.center, 1)};
}

void ChainBatch::read_links(std::size_t chain, std::span<LinkPlace> places) const {
  implementation_->place();
  const ChainMemory<double>& memory = implementation_->memory();
  const auto of = [&](double* array, std::size_t i) { return implementation_->of(chain, array, i); };
  const Point center = this->center(chain);
  double angle = of(memory.angle, 0);
  for (std::size_t link = 0; link < places.size(); link += 2) {
    Lanes<2>::Number angles = Lanes<2>::number(angle);
    if (link + 1 < places.size()) {
      angles[1] += of(memory.joint_angle, link);
    }
    const auto half = sine_cosine<2>(angles * 0.5);
    for (std::size_t lane = 0; lane < 2 && link + lane < places.size(); ++lane) {
      places[link + lane] = {{center.x + of(memory.link_position, 2 * (link + lane)),
                              center.z + of(memory.link_position, 2 * (link + lane) + 1)},
                             half.sine[lane],
                             half.cosine[lane]};
    }
    if (link + 2 < places.size()) {
      angle = angles[1] + of(memory.joint_angle, link + 1);
    }
  }
}

ChainBatch::LinkMotion ChainBatch::link_motion(std::size_t chain, std::size_t link) const {
  const ChainMemory<double>& memory = implementation_->memory();
  const auto of = [&](double* array, std::size_t i) { return implementation_->of(chain, array, i); };
  return {{of(memory.center_speed, 0) + of(memory.link_speed, 2 * link),
           of(memory.center_speed, 1) + of(memory.link_speed, 2 * link + 1)},
          of(memory.rotation, link)};
}

std::uint8_t ChainBatch::pressed(std::size_t chain, std::size_t link) const {
  return static_cast<std::uint8_t>(implementation_->of(chain, implementation_->memory().pressed, link));
}

double ChainBatch::contact_force(std::size_t chain, std::size_t link) const {
  return implementation_->of(chain, implementation_->memory().contact_force, link);
}

std::size_t ChainBatch::contact_count(std::size_t chain) const {
  return static_cast<std::size_t>(implementation_->of(chain, implementation_->memory().contact_count, 0));
}

ContactSliding ChainBatch::sliding(std::size_t chain) const {
  const ChainMemory<double>& memory = implementation_->memory();
  return {implementation_->of(chain, memory.sliding, 0), implementation_->of(chain, memory.sliding, 1),
          implementation_->of(chain, memory.sliding, 2)};
}

double ChainBatch::failure(std::size_t chain) const {
  return implementation_->of(chain, implementation_->memory().failed, 0);
}

std::vector<double> ChainBatch::state(std::size_t chain) const {
  const ChainMemory<double>& memory = implementation_->memory();
  const ChainCounts& counts = implementation_->counts();
  std::vector<double> state;
  const auto add = [&](double* array, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      state.push_back(implementation_->of(chain, array, i));
    }
  };
  add(memory.center, 2);
  add(memory.center_speed, 2);
  add(memory.angle, 1);
  add(memory.joint_angle, counts.joints);
  add(memory.link_speed, 2 * counts.links);
  add(memory.rotation, counts.links);
  return state;
}

void ChainBatch::place_like(std::size_t chain, const ChainBatch& other, std::size_t other_chain, const Point& center) {
  const ChainMemory<double>& memory = implementation_->memory();
  const ChainMemory<double>& from = other.implementation_->memory();
  implementation_->of(chain, memory.angle, 0) = other.implementation_->of(other_chain, from.angle, 0);
  for (std::size_t joint = 0; joint < implementation_->counts().joints; ++joint) {
    implementation_->of(chain, memory.joint_angle, joint) = other.joint_angle(other_chain, joint);
    implementation_->of(chain, memory.wanted_speed, joint) =
        other.implementation_->of(other_chain, from.wanted_speed, joint);
    implementation_->of(chain, memory.max_torque, joint) =
        other.implementation_->of(other_chain, from.max_torque, joint);
  }
  implementation_->of(chain, memory.center, 0) = center.x;
  implementation_->of(chain, memory.center, 1) = center.z;
  implementation_->forget_places();
}

}  // namespace proleg::sim::reduced
