#pragma once

#include <cstddef>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/kernel.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/sine.hpp"
#include "sim/reduced/vectors.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

/// How links turn and what it takes. With Contacts and FreeJoints this is all of a step that depends on the kind.
template <typename Kind, int width>
class Mechanics;

/// In a plane the state has an angle for the first link, and the rotations of the links.
template <int width>
class Mechanics<Planar, width> {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Plane<Number>;

  Mechanics(const ChainForm<Planar>& /*form*/, const ChainMemory<Planar, Number>& memory,
            const ChainScratch<Planar, Number>& scratch)
      : m_(memory), s_(scratch) {}

  /// How a link is turned.
  struct LinkTurn {
    Number angle;
    SineCosine<Number> of_angle;

    [[nodiscard]] Vector operator*(const Point& p) const {
      return {of_angle.cosine * p.x - of_angle.sine * p.z, of_angle.sine * p.x + of_angle.cosine * p.z};
    }
  };
  [[nodiscard]] LinkTurn first_turn() const { return {m_.orientation[0], sine_cosine<width>(m_.orientation[0])}; }
  /// turn: that of the link before joint j; becomes that of the link behind.
  void turn_joint(std::size_t j, LinkTurn& turn) const {
    turn.angle += m_.joint_angle[j];
    turn.of_angle = sine_cosine<width>(turn.angle);
  }
  void keep_turn(std::size_t link, const LinkTurn& turn) const {
    s_.sine[link] = turn.of_angle.sine;
    s_.cosine[link] = turn.of_angle.cosine;
  }

  /// The inertia of a link about its own centre of mass.
  [[nodiscard]] Number own_inertia(std::size_t link) const { return m_.inertia[link]; }
  /// The angular velocity that the speed of joint j gives the link behind.
  [[nodiscard]] Number joint_spin(std::size_t j) const { return s_.speed[j]; }
  /// The part of a torque that acts along the axis of joint j.
  [[nodiscard]] Number along_axis(std::size_t /*j*/, const Number& torque) const { return torque; }

  /// The angular momentum of a link about its own centre of mass less that of the drift.
  [[nodiscard]] Number missing_momentum(std::size_t link) const {
    return m_.inertia[link] * (m_.rotation[link] - s_.spin[link]);
  }
  void set_new_momentum(std::size_t /*link*/) const {}
  /// The angular momentum that a link gains in the step, about its own centre of mass.
  [[nodiscard]] Number gained_momentum(std::size_t link) const {
    return m_.inertia[link] * (s_.new_rotation[link] - m_.rotation[link]);
  }

  /// What the state keeps of a result.
  static Number kept(const Number& value) { return value; }
  static Vector kept(const Vector& value) { return value; }
  void keep_momentum(Mask /*done*/, std::size_t /*link*/) const {}
  void turn_first_link(Mask done, const Number& rotation, double step_s) const {
    put_where(done, m_.orientation[0], m_.orientation[0] + rotation * step_s);
  }

 private:
  const ChainMemory<Planar, Number>& m_;
  const ChainScratch<Planar, Number>& s_;
};

/// In space the state has a quaternion for the first link, and the angular momenta of the links, not their rotations:
/// so a body that turns freely keeps its momentum, whatever its inertia is after the step.
template <int width>
class Mechanics<Spatial, width> {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Space<Number>;
  using Inertia = Tensor<Number>;

  Mechanics(const ChainForm<Spatial>& form, const ChainMemory<Spatial, Number>& memory,
            const ChainScratch<Spatial, Number>& scratch)
      : form_(form), m_(memory), s_(scratch) {}

  /// How a link is turned.
  struct LinkTurn : Turn<Number> {
    [[nodiscard]] Vector operator*(const Point3& p) const { return Turn<Number>::operator*(vector(p)); }
  };
  [[nodiscard]] LinkTurn first_turn() const {
    const Number w = m_.orientation[0];
    const Number x = m_.orientation[1];
    const Number y = m_.orientation[2];
    const Number z = m_.orientation[3];
    LinkTurn turn;
    turn.x = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)};
    turn.y = {2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)};
    turn.z = cross(turn.x, turn.y);
    return turn;
  }
  /// turn: that of the link before joint j; becomes that of the link behind. The joint turns it about its axis
  /// (Rodrigues).
  void turn_joint(std::size_t j, LinkTurn& turn) const {
    const Vector axis = turn * form_.joints[j].axis;
    const SineCosine<Number> by = sine_cosine<width>(m_.joint_angle[j]);
    const auto turned_vector = [&](const Vector& v) {
      return v * by.cosine + cross(axis, v) * by.sine + axis * (dot(axis, v) * (1.0 - by.cosine));
    };
    turn.x = turned_vector(turn.x);
    turn.y = turned_vector(turn.y);
    turn.z = cross(turn.x, turn.y);
    put(s_.axis, j, axis);
  }
  void keep_turn(std::size_t link, const Turn<Number>& turn) const { put(m_.link_turn, link, turn); }

  /// The inertia of a link about its own centre of mass.
  [[nodiscard]] Inertia own_inertia(std::size_t link) const {
    const Inertia own = turned_inertia(at<Turn<Number>>(m_.link_turn, link), at<Inertia>(m_.inertia, link));
    put(s_.turned_inertia, link, own);
    return own;
  }
  /// The angular velocity that the speed of joint j gives the link behind.
  [[nodiscard]] Vector joint_spin(std::size_t j) const { return at<Vector>(s_.axis, j) * s_.speed[j]; }
  /// The part of a torque that acts along the axis of joint j.
  [[nodiscard]] Number along_axis(std::size_t j, const Vector& torque) const {
    return dot(at<Vector>(s_.axis, j), torque);
  }

  /// The angular momentum of a link about its own centre of mass less that of the drift.
  [[nodiscard]] Vector missing_momentum(std::size_t link) const {
    return at<Vector>(m_.spin_momentum, link) - at<Inertia>(s_.turned_inertia, link) * at<Vector>(s_.spin, link);
  }
  void set_new_momentum(std::size_t link) const {
    put(s_.new_momentum, link, at<Inertia>(s_.turned_inertia, link) * at<Vector>(s_.new_rotation, link));
  }
  /// The angular momentum that a link gains in the step, about its own centre of mass.
  [[nodiscard]] Vector gained_momentum(std::size_t link) const {
    return at<Vector>(s_.new_momentum, link) - at<Vector>(m_.spin_momentum, link);
  }

  /// What the state keeps of a result. The sum with 0 makes -0 to 0, which are different bits and may depend on the
  /// other lanes.
  static Number kept(const Number& value) { return value + 0.0; }
  static Vector kept(const Vector& value) { return value + Vector{}; }
  void keep_momentum(Mask done, std::size_t link) const {
    put_where(done, m_.spin_momentum, link, kept(at<Vector>(s_.new_momentum, link)));
  }
  /// Turns the first link as ODE does: by the first order of the rotation, made a unit quaternion again.
  void turn_first_link(Mask done, const Vector& rotation, double step_s) const {
    const Number w = m_.orientation[0];
    const Vector v = at<Vector>(m_.orientation + 1, 0);
    const Vector half = rotation * Lanes<width>::number(0.5 * step_s);
    const Number new_w = w - dot(half, v);
    const Vector new_v = v + half * w + cross(half, v);
    const Number scale = 1.0 / square_root(new_w * new_w + dot(new_v, new_v));
    put_where(done, m_.orientation[0], kept(new_w * scale));
    put_where(done, m_.orientation + 1, 0, kept(new_v * scale));
  }

 private:
  [[nodiscard]] static Vector vector(const Point3& p) {
    return {Lanes<width>::number(p.x), Lanes<width>::number(p.y), Lanes<width>::number(p.z)};
  }

  const ChainForm<Spatial>& form_;
  const ChainMemory<Spatial, Number>& m_;
  const ChainScratch<Spatial, Number>& s_;
};

}  // namespace
}  // namespace proleg::sim::reduced
