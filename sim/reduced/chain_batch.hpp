#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <ranges>
#include <span>
#include <vector>

#include "sim/physics/contact_sliding.hpp"
#include "sim/reduced/chain_kernel.hpp"
#include "sim/reduced/chain_model.hpp"

namespace proleg::sim::reduced {

/// The kernels that this processor can run, narrowest first.
[[nodiscard]] std::vector<const ChainKernel*> supported_kernels();
/// The widest kernel of whose lanes the chains fill more than half; for one chain, or none, the narrowest.
[[nodiscard]] const ChainKernel& choose_kernel(std::size_t chains);

/// Chains of one form that make their steps together. What a chain does depends neither on the others nor on the
/// kernel. Angles, speeds and torques of joints are those of the plane (ShapeForm, JointForm).
class ChainBatch {
 public:
  /// chains: ChainModels or what is derived from it, at least one; all have the form of the first. kernel: nothing: the
  /// widest one that this processor has and the chains fill.
  template <std::ranges::input_range Chains>
  explicit ChainBatch(const Chains& chains, const ChainKernel* kernel = nullptr)
      : ChainBatch(pointers_to(chains), kernel) {}
  ~ChainBatch();
  ChainBatch(const ChainBatch&) = delete;
  ChainBatch& operator=(const ChainBatch&) = delete;

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] const ChainKernel& kernel() const;

  /// All chains. One that breaks down affects no other.
  void step();

  // Of a chain.
  void set_wanted_speed(std::size_t chain, std::size_t joint, double speed);      ///< rad/s
  void set_max_torque(std::size_t chain, std::size_t joint, double torque);       ///< Nm
  [[nodiscard]] double joint_angle(std::size_t chain, std::size_t joint) const;   ///< rad
  [[nodiscard]] double motor_torque(std::size_t chain, std::size_t joint) const;  ///< Nm, in the last step
  // The same for all joints or links of a chain. signs: 1 or -1 by joint; speeds, angles and torques are multiplied by
  // it.
  void set_wanted_speeds(std::size_t chain, std::span<const double> signs, std::span<const double> speeds);
  void read_joints(std::size_t chain, std::span<const double> signs, std::span<double> angles,
                   std::span<double> torques) const;
  void add_contact_forces(std::size_t chain, std::span<double> sums) const;  ///< N

  [[nodiscard]] Point center(std::size_t chain) const;  ///< of mass
  /// A link's centre of mass, and the rotation of the link since all angles were 0.
  struct LinkPlace {
    Point position;
    double half_sine;  ///< of half the angle
    double half_cosine;
  };
  /// Of the first links of a chain.
  void read_links(std::size_t chain, std::span<LinkPlace> places) const;
  [[nodiscard]] LinkPlace link_place(std::size_t chain, std::size_t link) const {
    std::vector<LinkPlace> places(link + 1);
    read_links(chain, places);
    return places.back();
  }
  /// Of its centre of mass, m/s; and its rotation, rad/s.
  struct LinkMotion {
    Point velocity;
    double rotation;
  };
  [[nodiscard]] LinkMotion link_motion(std::size_t chain, std::size_t link) const;
  [[nodiscard]] std::uint8_t pressed(std::size_t chain, std::size_t link) const;  ///< bit 0 rear, bit 1 front sensor
  [[nodiscard]] double contact_force(std::size_t chain, std::size_t link) const;  ///< N
  [[nodiscard]] std::size_t contact_count(std::size_t chain) const;
  [[nodiscard]] ContactSliding sliding(std::size_t chain) const;
  /// 0, not_finite or too_many_contacts.
  [[nodiscard]] double failure(std::size_t chain) const;
  [[nodiscard]] bool failed(std::size_t chain) const { return failure(chain) != 0.0; }
  /// All numbers on which the next steps depend, but contacts.
  [[nodiscard]] std::vector<double> state(std::size_t chain) const;

  /// Puts a chain at rest where another one is: its joints have the same angles and their motors the
  /// same wanted speeds and torques; its centre of mass is given.
  void place_like(std::size_t chain, const ChainBatch& other, std::size_t other_chain, const Point& center);

 private:
  using Models = std::vector<const ChainModel*>;
  class Implementation;

  ChainBatch(const Models& chains, const ChainKernel* kernel);

  template <typename Chains>
  static Models pointers_to(const Chains& chains) {
    Models pointers;
    for (const ChainModel& chain : chains) {
      pointers.push_back(&chain);
    }
    return pointers;
  }

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::sim::reduced
