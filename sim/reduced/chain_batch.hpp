#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <ranges>
#include <span>
#include <utility>
#include <vector>

#include "sim/physics/contact_sliding.hpp"
#include "sim/reduced/kernel.hpp"

namespace proleg::sim::reduced {

/// The properties of a chain that a ChainBatch needs.
template <typename Kind>
struct ChainModel {
  // Equal in all chains of a batch.
  std::vector<typename Kind::Link> links;
  std::vector<typename Kind::Joint> joints;
  std::vector<typename Kind::Shape> shapes;
  std::vector<typename Kind::Solid> terrain;
  bool self_collision = false;
  double step_s = 0.0;

  // May differ from chain to chain.
  std::vector<double> masses;    ///< kg, by link
  std::vector<double> inertias;  ///< kg m^2, Kind::inertia_numbers by link, about its centre of mass
  /// Coulomb coefficients. Planar: by shape, then by solid; then by shape and shape. Spatial: by shape, with the floor.
  std::vector<double> friction;
  typename Kind::Point gravity;     ///< m/s^2
  typename Kind::Point first_link;  ///< m: the centre of mass of the first link at the start
  /// The orientation of the first link at the start. In a plane it is 0: the form is as the links lie then.
  std::array<double, Kind::orientation_numbers> orientation{Kind::unturned};

  /// Whether chains may share a batch.
  [[nodiscard]] bool has_form_of(const ChainModel& other) const {
    return links == other.links && joints == other.joints && shapes == other.shapes && terrain == other.terrain &&
           self_collision == other.self_collision && step_s == other.step_s;
  }
};

/// The kernels that this processor can run, narrowest first.
[[nodiscard]] std::vector<const ChainKernel*> supported_kernels();
/// The widest kernel of whose lanes the chains fill more than half; for one chain, or none, the narrowest.
[[nodiscard]] const ChainKernel& choose_kernel(std::size_t chains);

/// Chains of one form that make their steps together. What a chain does depends neither on the others nor on the
/// kernel. Angles, speeds and torques of joints are those of Kind::Joint.
template <typename Kind>
class ChainBatch {
 public:
  using Point = typename Kind::Point;
  using LinkPlace = typename Kind::LinkPlace;
  using LinkMotion = typename Kind::LinkMotion;
  using Orientation = std::array<double, Kind::orientation_numbers>;

  /// chains: ChainModels or what is derived from it, at least one; all have the form of the first. kernel: if
  /// none, choose_kernel().
  template <std::ranges::input_range Chains>
  explicit ChainBatch(const Chains& chains, const ChainKernel* kernel = nullptr)
      : ChainBatch(pointers_to(chains), kernel) {}
  ~ChainBatch();
  ChainBatch(const ChainBatch&) = delete;
  ChainBatch& operator=(const ChainBatch&) = delete;

  [[nodiscard]] std::size_t size() const;

  /// Steps all chains. One that breaks down affects no other.
  void step();

  void set_wanted_speed(std::size_t chain, std::size_t joint, double speed);      ///< rad/s
  void set_max_torque(std::size_t chain, std::size_t joint, double torque);       ///< Nm
  [[nodiscard]] double joint_angle(std::size_t chain, std::size_t joint) const;   ///< rad
  [[nodiscard]] double motor_torque(std::size_t chain, std::size_t joint) const;  ///< Nm, in the last step
  // These act on all joints or links of a chain. signs: 1 or -1 by joint; speeds, angles and torques are multiplied by
  // it.
  void set_wanted_speeds(std::size_t chain, std::span<const double> signs, std::span<const double> speeds);
  void read_joints(std::size_t chain, std::span<const double> signs, std::span<double> angles,
                   std::span<double> torques) const;
  void add_contact_forces(std::size_t chain, std::span<double> sums) const;  ///< N, by link

  [[nodiscard]] Point center(std::size_t chain) const;  ///< centre of mass
  [[nodiscard]] LinkPlace link_place(std::size_t chain, std::size_t link) const;
  /// The places of the first links of a chain.
  void read_links(std::size_t chain, std::span<LinkPlace> places) const;
  [[nodiscard]] LinkMotion link_motion(std::size_t chain, std::size_t link) const;
  [[nodiscard]] std::uint8_t pressed(std::size_t chain, std::size_t link) const;  ///< bit 0 rear, bit 1 front sensor
  [[nodiscard]] double contact_force(std::size_t chain, std::size_t link) const;  ///< N
  [[nodiscard]] std::size_t contact_count(std::size_t chain) const;
  [[nodiscard]] ContactSliding sliding(std::size_t chain) const;
  /// Two links, not neighbours, that touched each other at the start of the last step, if links must not (Spatial).
  [[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> touching_links(std::size_t chain) const;
  /// Why a chain is lost: not_finite or too_many_contacts; 0 if it is not.
  [[nodiscard]] double failure(std::size_t chain) const;
  [[nodiscard]] bool failed(std::size_t chain) const { return failure(chain) != 0.0; }
  /// The numbers on which the next steps depend, except those of contacts.
  [[nodiscard]] std::vector<double> state(std::size_t chain) const;

  /// Puts a chain that has made no step where another one is: its joints have the same angles and their motors the same
  /// wanted speeds and torques; its centre of mass is given.
  void place_like(std::size_t chain, const ChainBatch& other, std::size_t other_chain, const Point& center);
  /// The orientation of the first link (Kind::orientation_numbers).
  [[nodiscard]] Orientation orientation(std::size_t chain) const;
  /// Puts a chain at rest somewhere else, with the same angles. center: the centre of mass.
  void move(std::size_t chain, const Point& center, const Orientation& orientation);

 private:
  using Models = std::vector<const ChainModel<Kind>*>;
  class Implementation;

  ChainBatch(const Models& chains, const ChainKernel* kernel);

  template <typename Chains>
  static Models pointers_to(const Chains& chains) {
    Models pointers;
    for (const ChainModel<Kind>& chain : chains) {
      pointers.push_back(&chain);
    }
    return pointers;
  }

  std::unique_ptr<Implementation> implementation_;
};

extern template class ChainBatch<Planar>;
extern template class ChainBatch<Spatial>;

}  // namespace proleg::sim::reduced
