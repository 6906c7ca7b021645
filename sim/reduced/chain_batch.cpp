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
    if (static_cast<std::size_t>(kernel->width) <= 2 * chains - 2) {
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
        blocks_(chains.size(), static_cast<std::size_t>(kernel.width),
                ChainMemory<double>::size(form_.counts) + ChainScratch<double>::size(form_.counts)),
        memory_of_first_(blocks_.block(0), form_.counts, blocks_.width()) {
    for (std::size_t lane = 0; lane < blocks_.lanes(); ++lane) {
      set_constants(lane, *chains[std::min(lane, chains.size() - 1)]);
    }
    place();
    for (std::size_t lane = 0; lane < blocks_.lanes(); ++lane) {
      // Now the positions of the links from the centre of mass are known.
      const Point& first = chains[std::min(lane, chains.size() - 1)]->first_link;
      const ChainMemory<double> memory = memory_of(lane);
      of(lane, memory.center, 0) = first.x - of(lane, memory.link_position, 0);
      of(lane, memory.center, 1) = first.z - of(lane, memory.link_position, 1);
    }
  }

  [[nodiscard]] std::size_t size() const { return blocks_.size(); }
  [[nodiscard]] const ChainKernel& kernel() const { return kernel_; }
  [[nodiscard]] const ChainCounts& counts() const { return form_.counts; }

  void step() {
    blocks_.step([&](double* block) { return kernel_.step_strong(form_, block); },
                 [&](double* block) { kernel_.step_weak(form_, block); },
                 [&](std::size_t from, std::size_t to) { copy(from, to); });
    forget_places();
  }

  void forget_places() { places_are_current_ = false; }
  /// The links' positions of the present state, not of that before the last step.
  void place() {
    if (!places_are_current_) {
      for (std::size_t block = 0; block < blocks_.blocks(); ++block) {
        kernel_.place(form_, blocks_.block(block));
      }
      places_are_current_ = true;
    }
  }

  /// The first number of an array of a chain; the next ones follow at distances of stride().
  [[nodiscard]] double* first_of(std::size_t chain, double* ChainMemory<double>::*array) const {
    return blocks_.block_of(chain) + (memory_of_first_.*array - blocks_.block(0)) + chain % blocks_.width();
  }
  [[nodiscard]] std::size_t stride() const { return blocks_.width(); }
  [[nodiscard]] ChainMemory<double> memory_of(std::size_t lane) const {
    return {blocks_.block_of(lane), form_.counts, blocks_.width()};
  }
  [[nodiscard]] double& of(std::size_t lane, double* array, std::size_t i) const {
    return array[i * blocks_.width() + lane % blocks_.width()];
  }

 private:
  void copy(std::size_t from, std::size_t to) {
    const std::size_t width = blocks_.width();
    const ChainMemory<double> source = memory_of(from);
    const ChainMemory<double> target = memory_of(to);
    const auto copy_numbers = [&](const double* begin, double* out, std::size_t count) {
      begin += from % width;
      out += to % width;
      for (std::size_t i = 0; i < count * width; i += width) {
        out[i] = begin[i];
      }
    };
    const auto before_contacts = static_cast<std::size_t>(source.contact_key - source.mass) / width;
    copy_numbers(source.mass, target.mass, before_contacts);
    const auto contacts = static_cast<std::size_t>(of(from, source.contact_count, 0));
    copy_numbers(source.contact_key, target.contact_key, contacts);
    copy_numbers(source.normal_impulse, target.normal_impulse, contacts);
    copy_numbers(source.friction_impulse, target.friction_impulse, contacts);
  }

  void set_constants(std::size_t lane, const ChainModel& chain) {
    const ChainMemory<double> memory = memory_of(lane);
    double mass = 0.0;
    for (std::size_t i = 0; i < chain.masses.size(); ++i) {
      of(lane, memory.mass, i) = chain.masses[i];
      of(lane, memory.inertia, i) = chain.inertias[i];
      mass += chain.masses[i];
    }
    of(lane, memory.inverse_mass, 0) = 1.0 / mass;
    of(lane, memory.gravity, 0) = chain.gravity.x;
    of(lane, memory.gravity, 1) = chain.gravity.z;
    for (std::size_t i = 0; i < chain.terrain_friction.size(); ++i) {
      of(lane, memory.terrain_friction, i) = chain.terrain_friction[i];
    }
    for (std::size_t i = 0; i < chain.self_friction.size(); ++i) {
      of(lane, memory.self_friction, i) = chain.self_friction[i];
    }
  }

  const ChainKernel& kernel_;
  ChainModel form_of_;  ///< owns what form_ points to
  ChainForm form_;
  LaneBlocks blocks_;
  ChainMemory<double> memory_of_first_;
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
  implementation_->of(chain, implementation_->memory_of(chain).wanted_speed, joint) = speed;
}

void ChainBatch::set_max_torque(std::size_t chain, std::size_t joint, double torque) {
  implementation_->of(chain, implementation_->memory_of(chain).max_torque, joint) = torque;
}

double ChainBatch::joint_angle(std::size_t chain, std::size_t joint) const {
  return implementation_->of(chain, implementation_->memory_of(chain).joint_angle, joint);
}

double ChainBatch::motor_torque(std::size_t chain, std::size_t joint) const {
  return implementation_->of(chain, implementation_->memory_of(chain).motor_torque, joint);
}

void ChainBatch::set_wanted_speeds(std::size_t chain, std::span<const double> signs, std::span<const double> speeds) {
  double* const wanted = implementation_->first_of(chain, &ChainMemory<double>::wanted_speed);
  const std::size_t stride = implementation_->stride();
  for (std::size_t joint = 0; joint < speeds.size(); ++joint) {
    wanted[joint * stride] = signs[joint] * speeds[joint];
  }
}

void ChainBatch::read_joints(std::size_t chain, std::span<const double> signs, std::span<double> angles,
                             std::span<double> torques) const {
  const double* const angle = implementation_->first_of(chain, &ChainMemory<double>::joint_angle);
  const double* const torque = implementation_->first_of(chain, &ChainMemory<double>::motor_torque);
  const std::size_t stride = implementation_->stride();
  for (std::size_t joint = 0; joint < angles.size(); ++joint) {
    angles[joint] = signs[joint] * angle[joint * stride];
    torques[joint] = signs[joint] * torque[joint * stride];
  }
}

void ChainBatch::add_contact_forces(std::size_t chain, std::span<double> sums) const {
  const double* const force = implementation_->first_of(chain, &ChainMemory<double>::contact_force);
  const std::size_t stride = implementation_->stride();
  for (std::size_t link = 0; link < sums.size(); ++link) {
    sums[link] += force[link * stride];
  }
}

Point ChainBatch::center(std::size_t chain) const {
  const ChainMemory<double> memory = implementation_->memory_of(chain);
  return {implementation_->of(chain, memory.center, 0), implementation_->of(chain, memory.center, 1)};
}

ChainBatch::LinkPlace ChainBatch::link_place(std::size_t chain, std::size_t link) const {
  implementation_->place();
  const ChainMemory<double> memory = implementation_->memory_of(chain);
  const auto of = [&](double* array, std::size_t i) { return implementation_->of(chain, array, i); };
  double angle = of(memory.angle, 0);
  for (std::size_t joint = 0; joint < link; ++joint) {
    angle += of(memory.joint_angle, joint);
  }
  const auto half = sine_cosine<2>(Lanes<2>::number(angle * 0.5));
  return {{of(memory.center, 0) + of(memory.link_position, 2 * link),
           of(memory.center, 1) + of(memory.link_position, 2 * link + 1)},
          half.sine[0],
          half.cosine[0]};
}

ChainBatch::LinkMotion ChainBatch::link_motion(std::size_t chain, std::size_t link) const {
  const ChainMemory<double> memory = implementation_->memory_of(chain);
  const auto of = [&](double* array, std::size_t i) { return implementation_->of(chain, array, i); };
  return {{of(memory.center_speed, 0) + of(memory.link_speed, 2 * link),
           of(memory.center_speed, 1) + of(memory.link_speed, 2 * link + 1)},
          of(memory.rotation, link)};
}

std::uint8_t ChainBatch::pressed(std::size_t chain, std::size_t link) const {
  return static_cast<std::uint8_t>(implementation_->of(chain, implementation_->memory_of(chain).pressed, link));
}

double ChainBatch::contact_force(std::size_t chain, std::size_t link) const {
  return implementation_->of(chain, implementation_->memory_of(chain).contact_force, link);
}

std::size_t ChainBatch::contact_count(std::size_t chain) const {
  return static_cast<std::size_t>(implementation_->of(chain, implementation_->memory_of(chain).contact_count, 0));
}

ContactSliding ChainBatch::sliding(std::size_t chain) const {
  const ChainMemory<double> memory = implementation_->memory_of(chain);
  return {implementation_->of(chain, memory.sliding, 0), implementation_->of(chain, memory.sliding, 1),
          implementation_->of(chain, memory.sliding, 2)};
}

double ChainBatch::failure(std::size_t chain) const {
  return implementation_->of(chain, implementation_->memory_of(chain).failed, 0);
}

std::vector<double> ChainBatch::state(std::size_t chain) const {
  const ChainMemory<double> memory = implementation_->memory_of(chain);
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
  const ChainMemory<double> memory = implementation_->memory_of(chain);
  const ChainMemory<double> from = other.implementation_->memory_of(other_chain);
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
