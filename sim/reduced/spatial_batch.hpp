#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <ranges>
#include <span>
#include <utility>
#include <vector>

#include "sim/physics/contact_sliding.hpp"
#include "sim/reduced/chain_kernel.hpp"
#include "sim/reduced/spatial_model.hpp"

namespace proleg::sim::reduced {

/// As ChainBatch, for chains with joints of any axis. Angles, speeds and torques of joints are those of the robot.
class SpatialBatch {
 public:
  /// chains: SpatialModels or what is derived from it, at least one; all have the form of the first. kernel: as in
  /// ChainBatch.
  template <std::ranges::input_range Chains>
  explicit SpatialBatch(const Chains& chains, const ChainKernel* kernel = nullptr)
      : SpatialBatch(pointers_to(chains), kernel) {}
  ~SpatialBatch();
  SpatialBatch(const SpatialBatch&) = delete;
  SpatialBatch& operator=(const SpatialBatch&) = delete;

  [[nodiscard]] std::size_t size() const;

  /// All chains. One that breaks down affects no other.
  void step();

  // Of a chain.
  void set_wanted_speeds(std::size_t chain, std::span<const double> speeds);  ///< rad/s
  void set_wanted_speed(std::size_t chain, std::size_t joint, double speed);
  void set_max_torque(std::size_t chain, std::size_t joint, double torque);                        ///< Nm
  void read_joints(std::size_t chain, std::span<double> angles, std::span<double> torques) const;  ///< rad, Nm
  [[nodiscard]] double joint_angle(std::size_t chain, std::size_t joint) const;
  [[nodiscard]] double motor_torque(std::size_t chain, std::size_t joint) const;
  void add_contact_forces(std::size_t chain, std::span<double> sums) const;  ///< N, by link

  [[nodiscard]] Point3 center(std::size_t chain) const;  ///< of mass
  struct LinkPlace {
    Point3 position;  ///< of its centre of mass
    Point3 axes[3];   ///< where the axes of the robot's frame, that it had at angles 0, point now
  };
  [[nodiscard]] LinkPlace link_place(std::size_t chain, std::size_t link) const;
  struct LinkMotion {
    Point3 velocity;          ///< of its centre of mass, m/s
    Point3 rotation;          ///< rad/s
    Point3 angular_momentum;  ///< about its centre of mass, kg m^2/s
  };
  [[nodiscard]] LinkMotion link_motion(std::size_t chain, std::size_t link) const;
  [[nodiscard]] std::uint8_t pressed(std::size_t chain, std::size_t link) const;  ///< bit 0 rear, bit 1 front sensor
  [[nodiscard]] double contact_force(std::size_t chain, std::size_t link) const;  ///< N
  [[nodiscard]] std::size_t contact_count(std::size_t chain) const;
  [[nodiscard]] ContactSliding sliding(std::size_t chain) const;
  /// Two links, not neighbours, that touched each other at the start of the last step, if links must not.
  [[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> touching_links(std::size_t chain) const;
  [[nodiscard]] bool failed(std::size_t chain) const;
  /// All numbers on which the next steps depend, but contacts.
  [[nodiscard]] std::vector<double> state(std::size_t chain) const;

  /// Of the first link: the rotation of the robot since angles 0, as a quaternion.
  struct Orientation {
    double w;
    double x;
    double y;
    double z;
  };
  [[nodiscard]] Orientation orientation(std::size_t chain) const;
  /// Puts a chain at rest somewhere else, with the same angles. center: of mass.
  void move(std::size_t chain, const Point3& center, const Orientation& orientation);

 private:
  using Models = std::vector<const SpatialModel*>;
  class Implementation;

  SpatialBatch(const Models& chains, const ChainKernel* kernel);

  template <typename Chains>
  static Models pointers_to(const Chains& chains) {
    Models pointers;
    for (const SpatialModel& chain : chains) {
      pointers.push_back(&chain);
    }
    return pointers;
  }

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::sim::reduced
