#include "tests/sim/reduced/golden/golden_chains.hpp"

#include <array>
#include <cstdint>

namespace proleg::sim::reduced::golden {
namespace {

constexpr double half_length = 0.036;  // m, between the joints of a link

/// What all chains have in common.
ChainModel<Planar> make_form() {
  ChainModel<Planar> form;
  for (std::size_t link = 0; link < link_count; ++link) {
    form.links.push_back({{half_length, 0.0}, {-half_length, 0.0}, {1.0, 0.0}, {0.0, -1.0}});
    form.shapes.push_back({link, Rectangle{{0.0, 0.0}, {1.0, 0.0}, 0.03, 0.026}, 0.04});
  }
  // The last link also has a foot that is turned by a right-angled triangle of sides 7, 24, 25.
  form.shapes.push_back({link_count - 1, Rectangle{{-0.02, -0.03}, {0.96, -0.28}, 0.02, 0.005}, 0.06});
  form.joints.assign(joint_count, {-1.5, 1.5});
  form.terrain = {Rectangle{{0.0, -0.5}, {1.0, 0.0}, 50.0, 0.5},     // the floor
                  Rectangle{{0.5, 0.0}, {1.0, 0.0}, 0.2, 0.02},      // a step
                  Rectangle{{-0.7, -0.1}, {0.96, 0.28}, 0.3, 0.2}};  // a hill
  form.self_collision = true;
  form.step_s = 0.001;
  return form;
}

/// What all snakes have in common.
ChainModel<Spatial> make_snake_form() {
  ChainModel<Spatial> form;
  for (std::size_t link = 0; link < link_count; ++link) {
    form.links.push_back({{0.0, half_length, 0.0}, {0.0, -half_length, 0.0}, {1.0, 0.0, 0.0}});
    Spatial::Shape box;
    box.link = link;
    box.sides[0] = {0.026, 0.0, 0.0};
    box.sides[1] = {0.0, 0.03, 0.0};
    box.sides[2] = {0.0, 0.0, 0.026};
    box.radius = 0.05;
    for (unsigned number = 0; number < Spatial::corners_of_shape; ++number) {
      const auto sign = [&](unsigned bit) { return (number & bit) != 0 ? 1.0 : -1.0; };
      const int sensor = sign(4) > 0.0 ? 0 : (sign(2) < 0.0 ? 1 : 2);
      box.corners[number] = {{0.026 * sign(1), 0.03 * sign(2), 0.026 * sign(4)}, sensor};
    }
    form.shapes.push_back(box);
  }
  for (std::size_t joint = 0; joint < joint_count; ++joint) {
    // Right-angled triangles of sides 7, 24, 25.
    const Point3 axis = joint % 2 == 0 ? Point3{0.96, 0.0, 0.28} : Point3{-0.28, 0.0, 0.96};
    form.joints.push_back({{-1.5, 1.5}, axis});
  }
  form.terrain = {{{0.0, 0.0, 0.0}, {0.96, 0.28, 0.0}, 2.0, 0.5, 0.05}};
  form.self_collision = true;
  form.step_s = 0.001;
  return form;
}

/// -512 to 512: a triangle wave with 2048 phases.
int triangle(std::uint64_t phase) {
  const auto within = static_cast<int>(phase % 2048);
  return within < 1024 ? within - 512 : 1536 - within;
}

/// -512 to 511, another number for each set of arguments.
int scattered(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  std::uint64_t bits = a * 0x9E3779B97F4A7C15U + b * 0xBF58476D1CE4E5B9U + c * 0x94D049BB133111EBU;
  bits ^= bits >> 29U;
  bits *= 0xBF58476D1CE4E5B9U;
  return static_cast<int>(bits >> 54U) - 512;
}

}  // namespace

std::vector<ChainModel<Planar>> make_chains() {
  constexpr std::array frictions{0.0, 0.05, 0.1, 0.3, 0.5, 1.0, 2.0};
  std::vector<ChainModel<Planar>> chains(chain_count, make_form());
  for (std::size_t number = 0; number < chain_count; ++number) {
    ChainModel<Planar>& chain = chains[number];
    for (std::size_t link = 0; link < link_count; ++link) {
      const double mass = 0.05 + 0.00625 * static_cast<double>((number * 5 + link * 3) % 17);
      chain.masses.push_back(mass);
      chain.inertias.push_back(mass * 0.0006);
    }
    const std::size_t shapes = chain.shapes.size();
    for (std::size_t i = 0; i < shapes * chain.terrain.size(); ++i) {
      chain.friction.push_back(frictions[(number + i) % frictions.size()]);
    }
    for (std::size_t i = 0; i < shapes * shapes; ++i) {
      chain.friction.push_back(frictions[number % frictions.size()]);
    }
    chain.gravity = {0.125 * static_cast<double>(number % 3), -9.81};
    // The first half falls onto the hill.
    const double height = number < chain_count / 2 ? 0.25 : 0.0625;
    chain.first_link = {-0.75 + 0.125 * static_cast<double>(number),
                        height + 0.015625 * static_cast<double>(number % 4)};
  }
  return chains;
}

std::vector<ChainModel<Spatial>> make_snakes() {
  constexpr std::array frictions{0.0, 0.05, 0.1, 0.3, 0.5, 1.0, 2.0};
  std::vector<ChainModel<Spatial>> snakes(chain_count, make_snake_form());
  for (std::size_t number = 0; number < chain_count; ++number) {
    ChainModel<Spatial>& snake = snakes[number];
    for (std::size_t link = 0; link < link_count; ++link) {
      const double mass = 0.05 + 0.00625 * static_cast<double>((number * 5 + link * 3) % 17);
      snake.masses.push_back(mass);
      for (const double part : {0.0006, 0.0004, 0.0005, 0.0, 0.0001, 0.0}) {
        snake.inertias.push_back(mass * part);
      }
      snake.friction.push_back(frictions[(number + link) % frictions.size()]);
    }
    snake.gravity = {0.125 * static_cast<double>(number % 3), 0.0, -9.81};
    snake.first_link = {0.0, 0.125 * static_cast<double>(number % 4), 0.03125 * static_cast<double>(number % 5 + 1)};
    // Half of them lie at an angle.
    if (number % 2 == 1) {
      snake.orientation = {0.96, 0.0, 0.0, 0.28};
    }
  }
  return snakes;
}

double max_torque(std::size_t chain, std::size_t joint) {
  constexpr std::array torques{0.4, 0.1, 0.05, 0.02};
  const bool is_limp = chain % 7 == 3 && joint == chain % joint_count;
  return is_limp ? 0.0 : torques[chain / 4 % torques.size()];
}

double wanted_speed(std::size_t chain, std::size_t joint, std::size_t step) {
  int speed = 0;  // 1/128 rad/s
  switch (chain % 4) {
    case 0:  // a travelling wave
      speed = triangle(step + joint * (300 + chain) + 512);
      break;
    case 1:  // rolls up and unrolls
      speed = 2 * triangle(step / 2 + 1024 + 8 * joint);
      break;
    case 2:  // jerks
      speed = scattered(chain, joint, step / 200);
      break;
    default:  // one way for long
      speed = (step / 3000 + chain / 4) % 2 == 0 ? 200 : -200;
      break;
  }
  return static_cast<double>(speed) / 128.0;
}

}  // namespace proleg::sim::reduced::golden
