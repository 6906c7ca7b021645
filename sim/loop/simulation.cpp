#include "sim/loop/simulation.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/geometry_reader.hpp"
#include "sim/scenario/plausibility.hpp"

namespace proleg::sim {
namespace {

constexpr double min_lift = 0.001;   // m, of one attempt
constexpr double max_lift = 1.0;     // m
constexpr double max_height = 10.0;  // m, of the centre of mass above the ground

double deepest_overlap(const Pose& motion, std::span<const Pose> links, const Scenario& scenario) {
  double deepest = 0.0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Pose link = motion * links[i];
    for (const StaticObject& object : scenario.environment.objects) {
      for (const Geometry& solid : object.geometries) {
        deepest = std::max(deepest, overlap_depth(scenario.robot.links[i].geometries, link, solid, object.pose));
      }
    }
  }
  return deepest;
}

Eigen::Vector3d center_of_mass(const Pose& motion, std::span<const Pose> links, const Scenario& scenario) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double mass = 0.0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const MassProperties& link = scenario.robot.links[i].mass;
    sum += link.mass * (motion * (links[i] * link.center));
    mass += link.mass;
  }
  return sum / mass;
}

/// Of the objects of the environment at the place of a point: the highest top of all, and of those that do not lie
/// above the point.
struct Ground {
  std::optional<double> highest;
  std::optional<double> below;
};

Ground ground_at(const Eigen::Vector3d& point, const EnvironmentModel& environment) {
  Ground ground;
  const auto raise = [](std::optional<double>& top, double height) { top = std::max(top.value_or(height), height); };
  for (const StaticObject& object : environment.objects) {
    for (const Geometry& solid : object.geometries) {
      if (solid.mesh) {
        if (const auto top = highest_over(*solid.mesh, object.pose * solid.pose, point.head<2>(), point.head<2>())) {
          raise(ground.highest, *top);
          if (*top <= point.z()) {
            raise(ground.below, *top);
          }
        }
        continue;
      }
      const Bounds bounds = bounds_of(solid, object.pose);
      if (contains_from_above(bounds, point)) {
        raise(ground.highest, bounds.highest.z());
        if (bounds.lowest.z() <= point.z()) {
          raise(ground.below, bounds.highest.z());
        }
      }
    }
  }
  return ground;
}

double lowest_point(const Pose& motion, std::span<const Pose> links, const Scenario& scenario) {
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Pose link = motion * links[i];
    lowest = std::min(lowest, (link * scenario.robot.links[i].mass.center).z());  // a link may have no geometry
    for (const Geometry& geometry : scenario.robot.links[i].geometries) {
      lowest = std::min(lowest, bounds_of(geometry, link).lowest.z());
    }
  }
  return lowest;
}

[[noreturn]] void refuse(const RobotMove& move, const std::string& found) {
  throw InputError("move to " + number_text(move.position.x()) + ',' + number_text(move.position.y()) + ',' +
                       number_text(move.position.z()),
                   0, found, "a place on the ground or at most 10 m above it");
}

}  // namespace

Simulation::Simulation(const Scenario& scenario, const Losses* losses) : Simulation(scenario, losses, nullptr) {}

Simulation::Simulation(const Scenario& scenario, std::unique_ptr<World> world)
    : Simulation(scenario, nullptr, std::move(world)) {}

Simulation::Simulation(const Scenario& scenario, const Losses* losses, std::unique_ptr<World> world)
    : scenario_(scenario),
      gait_(scenario),
      plant_(scenario, std::move(world)),
      touch_(scenario.robot.joints.size()),
      pulse_player_(plant_, gait_.schedule()),
      latched_contacts_(scenario.robot.links.size()),
      needs_readings_(gait_.chain().needs_readings()) {
  gait_.chain().set_losses(losses);
  if (needs_readings_) {
    read_modules();
  }
}

void Simulation::read_modules() {
  readings_.clear();
  for (unsigned joint = 0; joint < chain().joint_count(); ++joint) {
    readings_.push_back(plant_.joint_readings(joint));
  }
}

double Simulation::time_s() const { return tick() * (scenario_.kernel.tick_period_us * 1e-6); }

void Simulation::apply_moves() {
  for (; next_move_ < scenario_.moves.size() && scenario_.moves[next_move_].tick == tick(); ++next_move_) {
    plant_.move_robot(placement(scenario_.moves[next_move_], plant_.link_poses(), scenario_));
  }
}

const Change* Simulation::advance() {
  const Change* const change = begin_tick();
  for (std::uint32_t step = 0; step < plant_.steps_per_tick(); ++step) {
    begin_step(step);
    finish_step();
  }
  end_tick();
  return change;
}

const Change* Simulation::begin_tick() {
  apply_moves();
  last_first_move_ = std::exchange(first_move_, next_move_);
  const Change* const change = gait_.apply_due_changes();
  for (unsigned joint = 0; joint < chain().joint_count(); ++joint) {
    touch_.sample(plant_.link_contacts(), joint);
  }
  touch_.write_links(latched_contacts_);
  if (needs_readings_) {
    for (unsigned joint = 0; joint < chain().joint_count(); ++joint) {
      readings_[joint] = readings_[joint].only(chain().kernel(joint).needed_readings(joint));
      gait_.chain().set_readings(joint, readings_[joint]);
    }
    latched_readings_.swap(readings_);
    read_modules();
  }
  const std::uint32_t present = tick();
  gait_.advance(touch_.contacts());
  if (has_hashes_) {
    setpoint_hash_.append(setpoints());
    for (const ServoPulse& pulse : servo_pulses()) {
      servo_hash_.append(pulse.command);
    }
  }
  pulse_player_.begin_tick(present, servo_pulses());
  return change;
}

void Simulation::end_tick() {
  pulse_player_.end_tick(setpoints());
  if (has_hashes_) {
    world_hash_.append(plant_);
  }
}

TickSample Simulation::sample() {
  TickSample sample = gait_.sample();
  plant_.add_to(sample);
  sample.latched_contacts = latched_contacts_;
  sample.moves = std::span(scenario_.moves).subspan(last_first_move_, first_move_ - last_first_move_);
  sample.readings = latched_readings_;
  return sample;
}

Pose placement(const RobotMove& move, std::span<const Pose> links, const Scenario& scenario) {
  Pose motion;
  motion.orientation = Eigen::AngleAxisd(move.turn_deg * (std::numbers::pi / 180.0), Eigen::Vector3d::UnitZ());
  motion.position = move.position - motion.orientation * links.front().position;
  double lifted = 0.0;
  const auto lift = [&](double height) {
    lifted += height;
    if (!(lifted <= max_lift)) {
      refuse(move, "a robot inside or below what it stands on");
    }
    motion.position.z() += height;
  };
  const auto ground = [&] { return ground_at(center_of_mass(motion, links, scenario), scenario.environment); };
  if (const Ground here = ground(); here.highest && !here.below) {
    lift(*here.highest - lowest_point(motion, links, scenario));  // it would be below a thin floor
  }
  for (double depth = deepest_overlap(motion, links, scenario); depth > largest_start_depth;
       depth = deepest_overlap(motion, links, scenario)) {
    lift(std::max(depth, min_lift));
  }
  if (!scenario.environment.objects.empty()) {
    const Ground here = ground();
    if (!here.below) {
      refuse(move, "nothing below the robot");
    }
    const double height = center_of_mass(motion, links, scenario).z() - *here.below;
    if (height > max_height) {
      refuse(move, "a robot " + number_text(height) + " m above the ground");
    }
  }
  return motion;
}

}  // namespace proleg::sim
