#pragma once

// A step of chains with joints of any axis on flat ground at height 0 (method: sim/reduced/chain_step.hpp).
// While all motors are strong enough, six unknowns remain: velocity of the centre of mass and rotation of the first link.

#include "prototype/spatial_form.hpp"
#include "sim/reduced/sine.hpp"

namespace proleg::sim::reduced {
namespace {

template <int width>
class SpatialStep {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Space<Number>;

  SpatialStep(const SpatialForm& form, SpatialMemory<width>& memory, SpatialStatistics& statistics)
      : f_(form), m_(memory), t_(statistics) {}

  unsigned step_strong() {
    prepare();
    Mask open = Lanes<width>::none();
    for (std::size_t j = 0; j < f_.joints; ++j) {
      open |= m_.is_free[j] > 0.0;
    }
    free_count_ = 0;
    solve<false>();
    find_torques();
    open |= free_weak_joints(~open);
    keep(~open);
    t_.steps += width;
    t_.contacts_in_union += static_cast<double>(rows_);
    for (int lane = 0; lane < width; ++lane) {
      t_.contacts += m_.contact_count[lane];
    }
    unsigned bits = 0;
    for (int lane = 0; lane < width; ++lane) {
      bits |= open[lane] != 0 ? 1U << static_cast<unsigned>(lane) : 0U;
    }
    return bits;
  }

  void step_weak() {
    prepare();
    Mask open = Lanes<width>::all();
    for (std::size_t round = 0; any(open); ++round) {
      free_count_ = 0;
      for (std::size_t j = 0; j < f_.joints; ++j) {
        if (any(m_.is_free[j] > 0.0)) {
          free_[free_count_++] = j;
        }
      }
      solve<true>();
      find_torques();
      const Mask changed = round > f_.joints ? Lanes<width>::none() : free_weak_joints(open);
      keep(open & ~changed);
      open &= changed;
      t_.weak_rounds += 1;
    }
  }

 private:
  static constexpr std::size_t max_unknowns = 3 + max_joints;
  static void put_where(Mask mask, Number& place, Number value) { place = select(mask, value, place); }
  static void put_where(Mask mask, Vector& place, const Vector& value) { place = select(mask, value, place); }
  static Number number(double value) { return Lanes<width>::number(value); }

  void prepare() {
    place_links();
    const double steps_per_s = 1.0 / f_.step_s;
    for (std::size_t j = 0; j < f_.joints; ++j) {
      lowest_[j] = (f_.lower[j] - m_.joint_angle[j]) * steps_per_s;
      highest_[j] = (f_.upper[j] - m_.joint_angle[j]) * steps_per_s;
      speed_[j] = bounded(m_.wanted_speed[j], lowest_[j], highest_[j]);
      put_where(m_.max_torque[j] == 0.0, m_.is_free[j], number(1.0));
    }
    find_contacts();
    free_speed_ = m_.center_speed;
    free_speed_.z += m_.gravity * f_.step_s;
    find_inertia();
  }

  void place_links() {
    const Number w = m_.orientation[0], x = m_.orientation[1], y = m_.orientation[2], z = m_.orientation[3];
    turn_[0].x = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)};
    turn_[0].y = {2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)};
    turn_[0].z = cross(turn_[0].x, turn_[0].y);
    position_[0] = Vector{};
    Vector sum{};
    for (std::size_t i = 0; i < f_.links; ++i) {
      if (i > 0) {
        const std::size_t j = i - 1;
        const Point3& a = f_.axis[j];
        const Turn<Number>& before = turn_[j];
        axis_[j] = before * a;
        const SineCosine<Number> t = sine_cosine<width>(m_.joint_angle[j]);
        const auto turned = [&](const Vector& v) {
          const Vector along = axis_[j] * (dot(axis_[j], v) * (1.0 - t.cosine));
          return v * t.cosine + cross(axis_[j], v) * t.sine + along;
        };
        turn_[i].x = turned(before.x);
        turn_[i].y = turned(before.y);
        turn_[i].z = cross(turn_[i].x, turn_[i].y);
        joint_[j] = position_[j] + before * f_.rear[j];
        position_[i] = joint_[j] - turn_[i] * f_.front[i];
      }
      sum = sum + position_[i] * m_.mass[i];
    }
    const Vector mean = sum * m_.inverse_mass;
    for (std::size_t i = 0; i < f_.links; ++i) {
      position_[i] = position_[i] - mean;
      inertia_[i] = turned_tensor(turn_[i], m_.inertia[i]);
    }
    for (std::size_t j = 0; j < f_.joints; ++j) {
      joint_[j] = joint_[j] - mean;
    }
  }

  void find_contacts() {
    constexpr double rest_depth = 1e-6;
    const double factor = 0.2 / f_.step_s;
    rows_ = 0;
    m_.contact_count = Number{};
    for (std::size_t s = 0; s < f_.shapes; ++s) {
      const std::size_t link = f_.shape_link[s];
      const Turn<Number>& turn = turn_[link];
      const Number height = m_.center.z + position_[link].z;
      for (std::size_t c = 8 * s; c < 8 * s + 8; ++c) {
        const Point3& corner = f_.corner[c];
        const Number z = height + (turn.x.z * corner.x + turn.y.z * corner.y + turn.z.z * corner.z);
        const Mask touches = z < 0.0;
        if (!any(touches)) {
          m_.normal_impulse[c] = Number{};
          m_.friction_x[c] = Number{};
          m_.friction_y[c] = Number{};
          continue;
        }
        const std::size_t k = rows_++;
        slot_[k] = c;
        link_[k] = link;
        touches_[k] = touches;
        arm_[k] = position_[link] + turn * corner;
        depth_speed_[k] = (-z - rest_depth) * factor;
        friction_[k] = m_.friction[s];
        m_.contact_count += select(touches, number(1.0), Number{});
      }
    }
  }

  void find_drift() {
    Vector velocity{}, spin{}, sum{};
    drift_[0] = Vector{};
    spin_[0] = Vector{};
    for (std::size_t i = 1; i < f_.links; ++i) {
      const std::size_t j = i - 1;
      velocity = velocity + cross(spin, joint_[j] - position_[j]);
      spin = spin + axis_[j] * speed_[j];
      velocity = velocity - cross(spin, joint_[j] - position_[i]);
      drift_[i] = velocity;
      spin_[i] = spin;
      sum = sum + velocity * m_.mass[i];
    }
    const Vector mean = sum * m_.inverse_mass;
    for (std::size_t i = 0; i < f_.links; ++i) {
      drift_[i] = drift_[i] - mean;
    }
  }

  void find_inertia() {
    total_ = Tensor<Number>{};
    for (std::size_t i = f_.links; i-- > 0;) {
      total_ = total_ + inertia_[i] + Tensor<Number>::of_point(m_.mass[i], position_[i]);
      if (i > 0) {
        inertia_behind_[i - 1] = total_;
      }
    }
  }

  template <bool weak>
  void solve() {
    for (std::size_t i = 0; i < free_count_; ++i) {
      put_where(m_.is_free[free_[i]] > 0.0, speed_[free_[i]], Number{});
    }
    find_drift();
    Vector momentum{}, linear{}, moment{};
    Number mass{};
    for (std::size_t i = f_.links; i-- > 0;) {
      const Vector change = (m_.link_speed[i] - drift_[i]) * m_.mass[i];
      momentum = momentum + m_.spin_momentum[i] - inertia_[i] * spin_[i] + cross(position_[i], change);
      if (weak && i > 0) {
        linear = linear + change;
        moment = moment + position_[i] * m_.mass[i];
        mass += m_.mass[i];
        momentum_behind_[i - 1] = linear;
        angular_behind_[i - 1] = momentum;
        moment_behind_[i - 1] = moment;
        mass_behind_[i - 1] = mass;
      }
    }
    base_speed_ = free_speed_;
    if constexpr (weak) {
      set_matrix(momentum);
    } else {
      inverse_ = total_.inverse();
      rotation_ = inverse_ * momentum;
    }
    set_rows<weak>();
    iterate<weak>();
    if constexpr (weak) {
      rotation_ = {u_[0], u_[1], u_[2]};
      for (std::size_t i = 0; i < free_count_; ++i) {
        const std::size_t j = free_[i];
        put_where(m_.is_free[j] > 0.0, speed_[j], u_[3 + i]);
      }
      find_drift();
    }
    for (std::size_t i = 0; i < f_.links; ++i) {
      new_speed_[i] = drift_[i] + cross(rotation_, position_[i]);
      new_momentum_[i] = inertia_[i] * (spin_[i] + rotation_);
    }
  }

  /// Inertia of rotation and free joints, inverted; the motion without contacts.
  void set_matrix(const Vector& momentum) {
    const std::size_t n = 3 + free_count_;
    Number a[max_unknowns][max_unknowns];
    Number rhs[max_unknowns];
    a[0][0] = total_.xx; a[1][0] = total_.xy; a[2][0] = total_.xz;
    a[1][1] = total_.yy; a[2][1] = total_.yz; a[2][2] = total_.zz;
    rhs[0] = momentum.x; rhs[1] = momentum.y; rhs[2] = momentum.z;
    Vector linear[max_joints], angular[max_joints];
    for (std::size_t i = 0; i < free_count_; ++i) {
      const std::size_t j = free_[i];
      const Mask is_free = m_.is_free[j] > 0.0;
      const Vector axis = select(is_free, axis_[j], Vector{});
      free_axis_[i] = axis;
      linear[i] = cross(axis, moment_behind_[j] - joint_[j] * mass_behind_[j]);
      angular[i] = inertia_behind_[j] * axis - cross(moment_behind_[j], cross(axis, joint_[j]));
      mean_[i] = linear[i] * m_.inverse_mass;
      a[3 + i][0] = angular[i].x;
      a[3 + i][1] = angular[i].y;
      a[3 + i][2] = angular[i].z;
      for (std::size_t k = 0; k <= i; ++k) {
        const std::size_t before = free_[k];
        a[3 + i][3 + k] =
            dot(free_axis_[k], angular[i] - cross(joint_[before], linear[i])) - dot(linear[k], mean_[i]);
      }
      a[3 + i][3 + i] = select(is_free, a[3 + i][3 + i], number(1.0));
      rhs[3 + i] = dot(axis, angular_behind_[j] - cross(joint_[j], momentum_behind_[j]));
    }
    // Cholesky without roots, then the inverse.
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        a[j][j] -= a[j][k] * a[j][k] * a[k][k];
      }
      const Number inverse = 1.0 / a[j][j];
      for (std::size_t i = j + 1; i < n; ++i) {
        Number value = a[i][j];
        for (std::size_t k = 0; k < j; ++k) {
          value -= a[i][k] * a[j][k] * a[k][k];
        }
        a[i][j] = value * inverse;
      }
    }
    for (std::size_t column = 0; column < n; ++column) {
      Number* x = inverse_matrix_[column];
      for (std::size_t i = 0; i < n; ++i) {
        x[i] = number(i == column ? 1.0 : 0.0);
        for (std::size_t k = column; k < i; ++k) {
          x[i] -= a[i][k] * x[k];
        }
      }
      for (std::size_t i = 0; i < n; ++i) {
        x[i] = x[i] / a[i][i];
      }
      for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) {
          x[i] -= a[k][i] * x[k];
        }
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      u_[i] = Number{};
      for (std::size_t k = 0; k < n; ++k) {
        u_[i] += inverse_matrix_[i][k] * rhs[k];
      }
    }
    for (std::size_t i = 0; i < free_count_; ++i) {
      const std::size_t j = free_[i];
      const Mask is_free = m_.is_free[j] > 0.0;
      most_impulse_[i] = select(is_free, m_.max_torque[j] * f_.step_s, Number{});
      motor_inverse_[i] = select(is_free, 1.0 / inverse_matrix_[3 + i][3 + i], Number{});
      motor_impulse_[i] = bounded(m_.motor_torque[j] * f_.step_s, -most_impulse_[i], most_impulse_[i]);
      for (std::size_t r = 0; r < n; ++r) {
        u_[r] += inverse_matrix_[3 + i][r] * motor_impulse_[i];
      }
    }
  }

  template <bool weak>
  void set_rows() {
    for (std::size_t k = 0; k < rows_; ++k) {
      const Vector r = arm_[k];
      const std::size_t link = link_[k];
      bias_[k] = drift_[link] + cross(spin_[link], r - position_[link]);
      const Vector turn[3] = {{Number{}, r.z, -r.y}, {-r.z, Number{}, r.x}, {r.y, -r.x, Number{}}};
      Number mobility[3];
      if constexpr (weak) {
        const std::size_t n = 3 + free_count_;
        Vector lever[max_joints];
        for (std::size_t i = 0; i < free_count_; ++i) {
          lever[i] = Vector{} - mean_[i];
          if (link > free_[i]) {
            lever[i] = lever[i] + cross(free_axis_[i], r - joint_[free_[i]]);
          }
        }
        for (std::size_t d = 0; d < 3; ++d) {
          Number* jacobian = jacobian_[k][d];
          jacobian[0] = turn[d].x;
          jacobian[1] = turn[d].y;
          jacobian[2] = turn[d].z;
          for (std::size_t i = 0; i < free_count_; ++i) {
            jacobian[3 + i] = d == 0 ? lever[i].x : d == 1 ? lever[i].y : lever[i].z;
          }
          mobility[d] = m_.inverse_mass;
          for (std::size_t i = 0; i < n; ++i) {
            Number sum{};
            for (std::size_t c = 0; c < n; ++c) {
              sum += inverse_matrix_[i][c] * jacobian[c];
            }
            response_[k][d][i] = sum;
            mobility[d] += sum * jacobian[i];
          }
        }
      } else {
        for (std::size_t d = 0; d < 3; ++d) {
          answer_[k][d] = inverse_ * turn[d];
          mobility[d] = m_.inverse_mass + dot(answer_[k][d], turn[d]);
        }
      }
      normal_inverse_[k] = select(touches_[k], 1.0 / mobility[2], Number{});
      friction_inverse_[k] = select(touches_[k], 1.0 / larger(mobility[0], mobility[1]), Number{});
      normal_[k] = select(touches_[k], m_.normal_impulse[slot_[k]], Number{});
      fx_[k] = select(touches_[k], m_.friction_x[slot_[k]], Number{});
      fy_[k] = select(touches_[k], m_.friction_y[slot_[k]], Number{});
    }
  }

  struct Motion {
    Vector speed, rotation;
  };

  template <bool weak>
  Number speed_along(std::size_t k, std::size_t d, const Motion& v) const {
    const Vector& r = arm_[k];
    Number speed;
    if (d == 0) {
      speed = (v.speed.x + bias_[k].x) + (v.rotation.y * r.z - v.rotation.z * r.y);
    } else if (d == 1) {
      speed = (v.speed.y + bias_[k].y) + (v.rotation.z * r.x - v.rotation.x * r.z);
    } else {
      speed = (v.speed.z + bias_[k].z) + (v.rotation.x * r.y - v.rotation.y * r.x);
    }
    if constexpr (weak) {
      for (std::size_t i = 3; i < 3 + free_count_; ++i) {
        speed += jacobian_[k][d][i] * u_[i];
      }
    }
    return speed;
  }

  template <bool weak>
  void apply(std::size_t k, std::size_t d, Number impulse, Motion& v) {
    Number& along = d == 0 ? v.speed.x : d == 1 ? v.speed.y : v.speed.z;
    along += impulse * m_.inverse_mass;
    if constexpr (weak) {
      const Number* response = response_[k][d];
      v.rotation.x += response[0] * impulse;
      v.rotation.y += response[1] * impulse;
      v.rotation.z += response[2] * impulse;
      for (std::size_t i = 3; i < 3 + free_count_; ++i) {
        u_[i] += response[i] * impulse;
      }
    } else {
      v.rotation = v.rotation + answer_[k][d] * impulse;
    }
  }

  template <bool weak>
  void push(std::size_t k, Motion& v) {
    const Number before = normal_[k];
    const Number value =
        larger(before + (depth_speed_[k] - speed_along<weak>(k, 2, v)) * normal_inverse_[k], Number{});
    normal_[k] = value;
    apply<weak>(k, 2, value - before, v);
  }

  template <bool weak>
  void rub(std::size_t k, Motion& v) {
    const Number old_x = fx_[k];
    const Number old_y = fy_[k];
    Number x = old_x - speed_along<weak>(k, 0, v) * friction_inverse_[k];
    Number y = old_y - speed_along<weak>(k, 1, v) * friction_inverse_[k];
    bound_friction(k, x, y);
    fx_[k] = x;
    fy_[k] = y;
    apply<weak>(k, 0, x - old_x, v);
    apply<weak>(k, 1, y - old_y, v);
  }

  void bound_friction(std::size_t k, Number& x, Number& y) const {
    const Number square = x * x + y * y;
    const Number most = most_friction_[k];
    const Mask is_over = square > most * most;
    const Number factor = select(is_over, most / root(select(is_over, square, number(1.0))), number(1.0));
    x *= factor;
    y *= factor;
  }

  template <bool weak>
  void turn_motors(Motion& v) {
    if constexpr (weak) {
      for (std::size_t i = 0; i < free_count_; ++i) {
        const std::size_t j = free_[i];
        const Number before = motor_impulse_[i];
        const Number speed = u_[3 + i];
        const Number most = most_impulse_[i];
        const Number own = bounded(before + (m_.wanted_speed[j] - speed) * motor_inverse_[i], -most, most);
        const Number low = before + (lowest_[j] - speed) * motor_inverse_[i];
        const Number high = before + (highest_[j] - speed) * motor_inverse_[i];
        const Number change = bounded(own, low, high) - before;
        motor_impulse_[i] = before + change;
        const Number* response = inverse_matrix_[3 + i];
        v.rotation.x += response[0] * change;
        v.rotation.y += response[1] * change;
        v.rotation.z += response[2] * change;
        for (std::size_t r = 3; r < 3 + free_count_; ++r) {
          u_[r] += response[r] * change;
        }
      }
    }
  }

  template <bool weak>
  void iterate() {
    constexpr int normal_sweeps = 4;
    constexpr int sweeps = 6;
    Motion v{base_speed_, weak ? Vector{u_[0], u_[1], u_[2]} : rotation_};
    for (std::size_t k = 0; k < rows_; ++k) {
      apply<weak>(k, 2, normal_[k], v);
    }
    for (int sweep = 0; sweep < normal_sweeps; ++sweep) {
      turn_motors<weak>(v);
      for (std::size_t k = 0; k < rows_; ++k) {
        push<weak>(k, v);
      }
    }
    for (std::size_t k = 0; k < rows_; ++k) {
      most_friction_[k] = normal_[k] * friction_[k];
      bound_friction(k, fx_[k], fy_[k]);
      apply<weak>(k, 0, fx_[k], v);
      apply<weak>(k, 1, fy_[k], v);
    }
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      turn_motors<weak>(v);
      for (std::size_t k = 0; k < rows_; ++k) {
        push<weak>(k, v);
        rub<weak>(k, v);
      }
    }
    base_speed_ = v.speed;
    if constexpr (weak) {
      u_[0] = v.rotation.x;
      u_[1] = v.rotation.y;
      u_[2] = v.rotation.z;
    } else {
      rotation_ = v.rotation;
    }
  }

  void find_torques() {
    const Vector push = base_speed_ - free_speed_;
    Vector linear{}, angular{};
    std::size_t k = rows_;
    for (std::size_t i = f_.links; i-- > 1;) {
      const Vector change = (new_speed_[i] - m_.link_speed[i] + push) * m_.mass[i];
      linear = linear + change;
      angular = angular + (new_momentum_[i] - m_.spin_momentum[i]) + cross(position_[i], change);
      for (; k > 0 && link_[k - 1] == i; --k) {
        const Vector impulse{fx_[k - 1], fy_[k - 1], normal_[k - 1]};
        linear = linear - impulse;
        angular = angular - cross(arm_[k - 1], impulse);
      }
      torque_impulse_[i - 1] = dot(axis_[i - 1], angular - cross(joint_[i - 1], linear));
    }
  }

  Mask free_weak_joints(Mask open) {
    Mask changed = Lanes<width>::none();
    for (std::size_t j = 0; j < f_.joints; ++j) {
      const Number most = m_.max_torque[j] * (f_.step_s * (1.0 + 1e-9));
      const Number impulse = torque_impulse_[j];
      const Mask at_lower = m_.wanted_speed[j] < lowest_[j];
      const Mask at_upper = m_.wanted_speed[j] > highest_[j];
      const Mask is_weak = ((impulse > most) & ~at_lower) | ((impulse < -most) & ~at_upper);
      const Mask is_new = open & is_weak & (m_.is_free[j] == 0.0);
      put_where(is_new, m_.is_free[j], number(1.0));
      changed |= is_new;
    }
    return changed;
  }

  void keep(Mask done) {
    const double h = f_.step_s;
    put_where(done, m_.center_speed, base_speed_);
    put_where(done, m_.center, m_.center + base_speed_ * number(h));
    const Number w = m_.orientation[0];
    const Vector v{m_.orientation[1], m_.orientation[2], m_.orientation[3]};
    const Vector half = rotation_ * number(0.5 * h);
    Number nw = w - dot(half, v);
    Vector nv = v + half * w + cross(half, v);
    const Number scale = 1.0 / root(nw * nw + dot(nv, nv));
    put_where(done, m_.orientation[0], nw * scale);
    put_where(done, m_.orientation[1], nv.x * scale);
    put_where(done, m_.orientation[2], nv.y * scale);
    put_where(done, m_.orientation[3], nv.z * scale);
    for (std::size_t j = 0; j < f_.joints; ++j) {
      put_where(done, m_.joint_angle[j], m_.joint_angle[j] + speed_[j] * h);
      put_where(done, m_.is_free[j], Number{});
      put_where(done, m_.motor_torque[j],
                bounded(torque_impulse_[j] * (1.0 / h), -m_.max_torque[j], m_.max_torque[j]));
    }
    for (std::size_t i = 0; i < f_.links; ++i) {
      put_where(done, m_.link_speed[i], new_speed_[i]);
      put_where(done, m_.spin_momentum[i], new_momentum_[i]);
    }
    for (std::size_t k = 0; k < rows_; ++k) {
      put_where(done, m_.normal_impulse[slot_[k]], select(touches_[k], normal_[k], Number{}));
      put_where(done, m_.friction_x[slot_[k]], select(touches_[k], fx_[k], Number{}));
      put_where(done, m_.friction_y[slot_[k]], select(touches_[k], fy_[k], Number{}));
    }
  }

  const SpatialForm& f_;
  SpatialMemory<width>& m_;
  SpatialStatistics& t_;

  Turn<Number> turn_[max_links];
  Vector position_[max_links], joint_[max_joints], axis_[max_joints];
  Tensor<Number> inertia_[max_links], inertia_behind_[max_joints], total_, inverse_;
  Number lowest_[max_joints], highest_[max_joints], speed_[max_joints], torque_impulse_[max_joints];
  Vector drift_[max_links], spin_[max_links], new_speed_[max_links], new_momentum_[max_links];
  Vector momentum_behind_[max_joints], angular_behind_[max_joints], moment_behind_[max_joints];
  Number mass_behind_[max_joints];
  Vector free_speed_, base_speed_, rotation_;

  std::size_t rows_ = 0;  ///< contacts of any lane
  std::size_t slot_[max_corners], link_[max_corners];
  Mask touches_[max_corners];
  Vector arm_[max_corners], bias_[max_corners], answer_[max_corners][3];
  Number depth_speed_[max_corners], friction_[max_corners], most_friction_[max_corners];
  Number normal_[max_corners], fx_[max_corners], fy_[max_corners];
  Number normal_inverse_[max_corners], friction_inverse_[max_corners];

  std::size_t free_count_ = 0, free_[max_joints];
  Vector free_axis_[max_joints], mean_[max_joints];
  Number inverse_matrix_[max_unknowns][max_unknowns], u_[max_unknowns];
  Number jacobian_[max_corners][3][max_unknowns], response_[max_corners][3][max_unknowns];
  Number most_impulse_[max_joints], motor_impulse_[max_joints], motor_inverse_[max_joints];
};

template <int width>
unsigned spatial_strong(const SpatialForm& form, void* memory, SpatialStatistics& statistics) {
  SpatialStep<width> step(form, *static_cast<SpatialMemory<width>*>(memory), statistics);
  return step.step_strong();
}
template <int width>
void spatial_weak(const SpatialForm& form, void* memory, SpatialStatistics& statistics) {
  SpatialStep<width> step(form, *static_cast<SpatialMemory<width>*>(memory), statistics);
  step.step_weak();
}
template <int width>
constexpr SpatialKernel spatial_kernel(const char* name) {
  return {name, width, sizeof(SpatialMemory<width>), spatial_strong<width>, spatial_weak<width>};
}

}  // namespace
}  // namespace proleg::sim::reduced
