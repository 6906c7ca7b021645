#include "sim/reduced/chain_batch.hpp"

#include <algorithm>
#include <span>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/lane_blocks.hpp"
#include "sim/reduced/sine.hpp"

namespace proleg::sim::reduced {
namespace {

std::array<double, 2> numbers_of(const Point& point) { return {point.x, point.z}; }
std::array<double, 3> numbers_of(const Point3& point) { return {point.x, point.y, point.z}; }

Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.z + b.z}; }
Point3 operator+(const Point3& a, const Point3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

template <typename Kind>
ChainCounts counts_of(const ChainModel<Kind>& chain) {
  return {chain.links.size(),    chain.joints.size(),
          chain.shapes.size(),   chain.terrain.size(),
          chain.friction.size(), Kind::contacts_of_shape * chain.shapes.size() + Kind::more_contacts};
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

template <typename Kind>
class ChainBatch<Kind>::Implementation {
 public:
  Implementation(const Models& chains, const ChainKernel& kernel)
      : steps_(kernel),
        form_of_(*chains.front()),
        form_{counts_of(form_of_),     form_of_.links.data(),   form_of_.joints.data(), form_of_.shapes.data(),
              form_of_.terrain.data(), form_of_.self_collision, form_of_.step_s},
        blocks_(chains.size(), static_cast<std::size_t>(kernel.width), Memory::size(form_.counts),
                ChainScratch<Kind, double>::size(form_.counts)),
        memory_(blocks_.block(0), form_.counts, static_cast<std::size_t>(kernel.width)) {
    for (std::size_t lane = 0; lane < blocks_.lanes(); ++lane) {
      set_constants(lane, *chains[std::min(lane, chains.size() - 1)]);
    }
    place();
    for (std::size_t lane = 0; lane < blocks_.lanes(); ++lane) {
      // Now the positions of the links from the centre of mass are known.
      const auto first = numbers_of(chains[std::min(lane, chains.size() - 1)]->first_link);
      for (std::size_t axis = 0; axis < Kind::axes; ++axis) {
        of(lane, memory_.center, axis) = first[axis] - of(lane, memory_.link_position, axis);
      }
    }
  }

  [[nodiscard]] std::size_t size() const { return blocks_.size(); }
  [[nodiscard]] const ChainForm<Kind>& form() const { return form_; }

  void step() {
    blocks_.step([&](double* block) { return steps_.step_strong(form_, block, blocks_.scratch()); },
                 [&](double* block) { steps_.step_weak(form_, block, blocks_.scratch()); },
                 [&](std::size_t from, std::size_t to) { copy(memory_.mass, from, to); },
                 [&](std::size_t from, std::size_t to) { copy(memory_.is_free, from, to); });
    forget_places();
  }

  void forget_places() { places_are_current_ = false; }
  /// Computes the places of the links in the present state, not those before the last step.
  void place() {
    if (!places_are_current_) {
      for (std::size_t block = 0; block < blocks_.blocks(); ++block) {
        steps_.place(form_, blocks_.block(block), blocks_.scratch());
      }
      places_are_current_ = true;
    }
  }

  /// The arrays of the first block.
  [[nodiscard]] const ChainMemory<Kind, double>& memory() const { return memory_; }
  /// Number i of an array of memory(), but of this lane.
  [[nodiscard]] double& of(std::size_t lane, const double* array, std::size_t i) const {
    return blocks_.of(lane, array, i);
  }
  /// Point number i of an array of memory(), but of this lane.
  [[nodiscard]] Point point_of(std::size_t lane, const double* array, std::size_t i) const {
    if constexpr (Kind::axes == 2) {
      return {of(lane, array, 2 * i), of(lane, array, 2 * i + 1)};
    } else {
      return {of(lane, array, 3 * i), of(lane, array, 3 * i + 1), of(lane, array, 3 * i + 2)};
    }
  }
  void set(std::size_t lane, double* array, std::span<const double> values) const {
    for (std::size_t i = 0; i < values.size(); ++i) {
      of(lane, array, i) = values[i];
    }
  }
  void clear(std::size_t lane, double* array, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) {
      of(lane, array, i) = 0.0;
    }
  }

 private:
  using Memory = ChainMemory<Kind, double>;

  /// Copies a lane from this array on, with those contacts that it has.
  void copy(const double* first, std::size_t from, std::size_t to) {
    blocks_.copy(from, to, first, blocks_.numbers_between(first, memory_.contact_key));
    const auto contacts = static_cast<std::size_t>(of(from, memory_.contact_count, 0));
    blocks_.copy(from, to, memory_.contact_key, contacts);
    blocks_.copy(from, to, memory_.impulse, Kind::axes * contacts);
  }

  void set_constants(std::size_t lane, const ChainModel<Kind>& chain) {
    set(lane, memory_.mass, chain.masses);
    set(lane, memory_.inertia, chain.inertias);
    set(lane, memory_.gravity, numbers_of(chain.gravity));
    set(lane, memory_.friction, chain.friction);
    set(lane, memory_.orientation, chain.orientation);
    double mass = 0.0;
    for (const double of_link : chain.masses) {
      mass += of_link;
    }
    of(lane, memory_.inverse_mass, 0) = 1.0 / mass;
  }

  const KernelSteps<Kind>& steps_;
  ChainModel<Kind> form_of_;  ///< owns what form_ points to
  ChainForm<Kind> form_;
  LaneBlocks blocks_;
  Memory memory_;  ///< the arrays of the first block
  bool places_are_current_ = false;
};

template <typename Kind>
ChainBatch<Kind>::ChainBatch(const Models& chains, const ChainKernel* kernel)
    : implementation_(
          std::make_unique<Implementation>(chains, kernel != nullptr ? *kernel : choose_kernel(chains.size()))) {}
template <typename Kind>
ChainBatch<Kind>::~ChainBatch() = default;

template <typename Kind>
std::size_t ChainBatch<Kind>::size() const {
  return implementation_->size();
}

template <typename Kind>
void ChainBatch<Kind>::step() {
  implementation_->step();
}

template <typename Kind>
void ChainBatch<Kind>::set_wanted_speed(std::size_t chain, std::size_t joint, double speed) {
  implementation_->of(chain, implementation_->memory().wanted_speed, joint) = speed;
}

template <typename Kind>
void ChainBatch<Kind>::set_max_torque(std::size_t chain, std::size_t joint, double torque) {
  implementation_->of(chain, implementation_->memory().max_torque, joint) = torque;
}

template <typename Kind>
double ChainBatch<Kind>::joint_angle(std::size_t chain, std::size_t joint) const {
  return implementation_->of(chain, implementation_->memory().joint_angle, joint);
}

template <typename Kind>
double ChainBatch<Kind>::motor_torque(std::size_t chain, std::size_t joint) const {
  return implementation_->of(chain, implementation_->memory().motor_torque, joint);
}

template <typename Kind>
void ChainBatch<Kind>::set_wanted_speeds(std::size_t chain, std::span<const double> signs,
                                         std::span<const double> speeds) {
  const double* const wanted = implementation_->memory().wanted_speed;
  for (std::size_t joint = 0; joint < speeds.size(); ++joint) {
    implementation_->of(chain, wanted, joint) = signs[joint] * speeds[joint];
  }
}

template <typename Kind>
void ChainBatch<Kind>::read_joints(std::size_t chain, std::span<const double> signs, std::span<double> angles,
                                   std::span<double> torques) const {
  const auto& memory = implementation_->memory();
  for (std::size_t joint = 0; joint < angles.size(); ++joint) {
    angles[joint] = signs[joint] * implementation_->of(chain, memory.joint_angle, joint);
    torques[joint] = signs[joint] * implementation_->of(chain, memory.motor_torque, joint);
  }
}

template <typename Kind>
void ChainBatch<Kind>::add_contact_forces(std::size_t chain, std::span<double> sums) const {
  for (std::size_t link = 0; link < sums.size(); ++link) {
    sums[link] += contact_force(chain, link);
  }
}

template <typename Kind>
typename Kind::Point ChainBatch<Kind>::center(std::size_t chain) const {
  return implementation_->point_of(chain, implementation_->memory().center, 0);
}

template <typename Kind>
typename Kind::LinkPlace ChainBatch<Kind>::link_place(std::size_t chain, std::size_t link) const {
  implementation_->place();
  const auto& memory = implementation_->memory();
  const Point position = center(chain) + implementation_->point_of(chain, memory.link_position, link);
  if constexpr (Kind::axes == 2) {
    double angle = implementation_->of(chain, memory.orientation, 0);
    for (std::size_t joint = 0; joint < link; ++joint) {
      angle += joint_angle(chain, joint);
    }
    const auto half = sine_cosine<2>(Lanes<2>::number(angle * 0.5));
    return {position, half.sine[0], half.cosine[0]};
  } else {
    const auto axis = [&](std::size_t i) { return implementation_->point_of(chain, memory.link_turn, 3 * link + i); };
    return {position, {axis(0), axis(1), axis(2)}};
  }
}

template <typename Kind>
void ChainBatch<Kind>::read_links(std::size_t chain, std::span<LinkPlace> places) const {
  if constexpr (Kind::axes == 2) {
    implementation_->place();
    const auto& memory = implementation_->memory();
    const Point center = this->center(chain);
    double angle = implementation_->of(chain, memory.orientation, 0);
    for (std::size_t link = 0; link < places.size(); link += 2) {
      Lanes<2>::Number angles = Lanes<2>::number(angle);
      if (link + 1 < places.size()) {
        angles[1] += joint_angle(chain, link);
      }
      const auto half = sine_cosine<2>(angles * 0.5);
      for (std::size_t lane = 0; lane < 2 && link + lane < places.size(); ++lane) {
        places[link + lane] = {center + implementation_->point_of(chain, memory.link_position, link + lane),
                               half.sine[lane], half.cosine[lane]};
      }
      if (link + 2 < places.size()) {
        angle = angles[1] + joint_angle(chain, link + 1);
      }
    }
  } else {
    for (std::size_t link = 0; link < places.size(); ++link) {
      places[link] = link_place(chain, link);
    }
  }
}

template <typename Kind>
typename Kind::LinkMotion ChainBatch<Kind>::link_motion(std::size_t chain, std::size_t link) const {
  const auto& memory = implementation_->memory();
  const Point velocity = implementation_->point_of(chain, memory.center_speed, 0) +
                         implementation_->point_of(chain, memory.link_speed, link);
  if constexpr (Kind::axes == 2) {
    return {velocity, implementation_->of(chain, memory.rotation, link)};
  } else {
    return {velocity, implementation_->point_of(chain, memory.rotation, link),
            implementation_->point_of(chain, memory.spin_momentum, link)};
  }
}

template <typename Kind>
std::uint8_t ChainBatch<Kind>::pressed(std::size_t chain, std::size_t link) const {
  return static_cast<std::uint8_t>(implementation_->of(chain, implementation_->memory().pressed, link));
}

template <typename Kind>
double ChainBatch<Kind>::contact_force(std::size_t chain, std::size_t link) const {
  return implementation_->of(chain, implementation_->memory().contact_force, link);
}

template <typename Kind>
std::size_t ChainBatch<Kind>::contact_count(std::size_t chain) const {
  return static_cast<std::size_t>(implementation_->of(chain, implementation_->memory().contact_count, 0));
}

template <typename Kind>
ContactSliding ChainBatch<Kind>::sliding(std::size_t chain) const {
  const auto& memory = implementation_->memory();
  return {implementation_->of(chain, memory.sliding, 0), implementation_->of(chain, memory.sliding, 1),
          implementation_->of(chain, memory.sliding, 2)};
}

template <typename Kind>
std::optional<std::pair<std::size_t, std::size_t>> ChainBatch<Kind>::touching_links(std::size_t chain) const {
  if constexpr (Kind::axes == 3) {
    const double code = implementation_->of(chain, implementation_->memory().overlap, 0);
    if (code != 0.0) {
      const ChainForm<Kind>& form = implementation_->form();
      const std::size_t pair = static_cast<std::size_t>(code) - 1;
      return std::pair(form.shapes[pair % form.counts.shapes].link, form.shapes[pair / form.counts.shapes].link);
    }
  }
  return std::nullopt;
}

template <typename Kind>
double ChainBatch<Kind>::failure(std::size_t chain) const {
  return implementation_->of(chain, implementation_->memory().failed, 0);
}

template <typename Kind>
std::vector<double> ChainBatch<Kind>::state(std::size_t chain) const {
  const auto& memory = implementation_->memory();
  const ChainCounts& counts = implementation_->form().counts;
  std::vector<double> state;
  const auto add = [&](double* array, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      state.push_back(implementation_->of(chain, array, i));
    }
  };
  add(memory.center, Kind::axes);
  add(memory.center_speed, Kind::axes);
  add(memory.orientation, Kind::orientation_numbers);
  add(memory.joint_angle, counts.joints);
  add(memory.link_speed, Kind::axes * counts.links);
  if constexpr (Kind::axes == 2) {
    add(memory.rotation, counts.links);
  } else {
    add(memory.spin_momentum, 3 * counts.links);
  }
  return state;
}

template <typename Kind>
void ChainBatch<Kind>::place_like(std::size_t chain, const ChainBatch& other, std::size_t other_chain,
                                  const Point& center) {
  const auto& memory = implementation_->memory();
  const auto& from = other.implementation_->memory();
  implementation_->set(chain, memory.orientation, other.orientation(other_chain));
  for (std::size_t joint = 0; joint < implementation_->form().counts.joints; ++joint) {
    implementation_->of(chain, memory.joint_angle, joint) = other.joint_angle(other_chain, joint);
    set_wanted_speed(chain, joint, other.implementation_->of(other_chain, from.wanted_speed, joint));
    set_max_torque(chain, joint, other.implementation_->of(other_chain, from.max_torque, joint));
  }
  implementation_->set(chain, memory.center, numbers_of(center));
  implementation_->forget_places();
}

template <typename Kind>
typename ChainBatch<Kind>::Orientation ChainBatch<Kind>::orientation(std::size_t chain) const {
  Orientation numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = implementation_->of(chain, implementation_->memory().orientation, i);
  }
  return numbers;
}

template <typename Kind>
void ChainBatch<Kind>::move(std::size_t chain, const Point& center, const Orientation& orientation) {
  const auto& memory = implementation_->memory();
  const ChainCounts& counts = implementation_->form().counts;
  const auto clear = [&](double* array, std::size_t count) { implementation_->clear(chain, array, count); };
  implementation_->set(chain, memory.center, numbers_of(center));
  implementation_->set(chain, memory.orientation, orientation);
  clear(memory.center_speed, Kind::axes);
  clear(memory.link_speed, Kind::axes * counts.links);
  clear(memory.rotation, Kind::spin_axes * counts.links);
  if constexpr (Kind::axes == 3) {
    clear(memory.spin_momentum, 3 * counts.links);
  }
  clear(memory.motor_torque, counts.joints);
  clear(memory.contact_force, counts.links);
  clear(memory.pressed, counts.links);
  clear(memory.sliding, 3);
  clear(memory.contact_count, 1);
  implementation_->forget_places();
}

template class ChainBatch<Planar>;
template class ChainBatch<Spatial>;

}  // namespace proleg::sim::reduced
