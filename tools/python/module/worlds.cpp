#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/loop/driven_worlds.hpp"
#include "tools/python/module/conversions.hpp"
#include "tools/python/module/long_call.hpp"
#include "tools/python/module/parts.hpp"

namespace py = pybind11;

namespace proleg::python {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

/// Degrees as the core has them, 90 degrees = 2^30, rounded to the nearest and saturated at +-180 degrees.
std::int32_t setpoint_of(double angle_deg) {
  constexpr double quarter_turn_steps = 1 << 30;
  return static_cast<std::int32_t>(
      std::clamp(std::nearbyint(angle_deg / 90.0 * quarter_turn_steps), -2147483648.0, 2147483647.0));
}

/// The robots and what a program that learns is given of them. The columns of an observation are those of names().
class Worlds {
 public:
  Worlds(const sim::Scenario& scenario, std::size_t count) : scenarios_(count, scenario) {}

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const char* quantity : {"angle_deg.", "speed_deg_per_s.", "current_mA."}) {
      for (const sim::Joint& joint : robot().joints) {
        names.push_back(quantity + joint.name);
      }
    }
    for (const char* quantity : {"contact_rear.", "contact_front."}) {
      for (const sim::Link& link : robot().links) {
        names.push_back(quantity + link.name);
      }
    }
    for (const char* quantity : {"qw.", "qx.", "qy.", "qz."}) {
      names.push_back(quantity + robot().links.front().name);
    }
    return names;
  }

  /// All robots stand at their start. World i has the seed of the call plus i. start: degrees, (worlds, joints).
  py::array_t<double> reset(std::uint64_t seed, const py::array_t<double>& start) {
    const std::vector<std::int32_t> setpoints = setpoints_of(start);
    const OneThread use(is_used_, "Worlds");
    {
      const Unlocked unlocked;
      std::vector<const sim::Scenario*> pointers;
      for (std::size_t i = 0; i < scenarios_.size(); ++i) {
        scenarios_[i].kernel.seed = seed + i;
        pointers.push_back(&scenarios_[i]);
      }
      worlds_.reset();
      worlds_ = std::make_unique<sim::DrivenWorlds>(pointers, setpoints);
      angles_.assign(scenarios_.size() * joints(), 0.0);
      distances_.assign(scenarios_.size(), 0.0);
      read_angles();
    }
    return observation(angles_);
  }

  /// A tick. Returns the observation, and of each world: m that it came forward in the tick; whether it has ended.
  py::tuple step(const py::array_t<double>& setpoints) {
    if (!worlds_) {
      throw InputError("step", 0, "a step before reset()", "reset() first");
    }
    const std::vector<std::int32_t> wanted = setpoints_of(setpoints);
    const OneThread use(is_used_, "Worlds");
    const std::vector<double> before = angles_;
    std::vector<double> reward(scenarios_.size());
    std::vector<std::uint8_t> done(scenarios_.size());
    {
      const Unlocked unlocked;
      worlds_->advance(wanted);
      read_angles();
      for (std::size_t i = 0; i < scenarios_.size(); ++i) {
        if (worlds_->runs(i)) {
          const double distance = worlds_->plant(i).meter().forward_distance();
          reward[i] = distance - distances_[i];
          distances_[i] = distance;
        }
        done[i] = worlds_->runs(i) && worlds_->tick() < sim::tick_count(scenarios_[i]) ? 0 : 1;
      }
    }
    const std::size_t count = reward.size();
    return py::make_tuple(observation(before), array_of(std::move(reward), {count}),
                          array_of(std::move(done), {count}));
  }

  [[nodiscard]] std::vector<std::string> failures() {
    const OneThread use(is_used_, "Worlds");
    std::vector<std::string> failures(scenarios_.size());
    for (std::size_t i = 0; worlds_ && i < failures.size(); ++i) {
      failures[i] = worlds_->failure(i);
    }
    return failures;
  }
  /// (worlds, links, 3) m.
  [[nodiscard]] py::array_t<double> positions() {
    const OneThread use(is_used_, "Worlds");
    std::vector<double> numbers;
    for (std::size_t i = 0; worlds_ && i < scenarios_.size(); ++i) {
      for (const sim::Pose& pose : worlds_->plant(i).link_poses()) {
        numbers.insert(numbers.end(), {pose.position.x(), pose.position.y(), pose.position.z()});
      }
    }
    return array_of(std::move(numbers), {worlds_ ? scenarios_.size() : 0, robot().links.size(), 3});
  }
  /// Of each world, m: how far the centre of mass is from its start.
  [[nodiscard]] py::array_t<double> displacements() {
    const OneThread use(is_used_, "Worlds");
    std::vector<double> numbers(scenarios_.size());
    for (std::size_t i = 0; worlds_ && i < numbers.size(); ++i) {
      numbers[i] = worlds_->plant(i).displacement();
    }
    const std::size_t count = numbers.size();
    return array_of(std::move(numbers), {count});
  }
  [[nodiscard]] std::size_t size() const { return scenarios_.size(); }
  [[nodiscard]] std::size_t joints() const { return robot().joints.size(); }

 private:
  [[nodiscard]] const sim::RobotModel& robot() const { return scenarios_.front().robot; }

  [[nodiscard]] std::vector<std::int32_t> setpoints_of(const py::array_t<double>& angles) const {
    if (angles.ndim() != 2 || static_cast<std::size_t>(angles.shape(0)) != size() ||
        static_cast<std::size_t>(angles.shape(1)) != joints()) {
      throw InputError("setpoints", 0, "an array of another shape",
                       "(" + std::to_string(size()) + ", " + std::to_string(joints()) + ")");
    }
    std::vector<std::int32_t> setpoints;
    setpoints.reserve(size() * joints());
    const auto numbers = angles.unchecked<2>();
    for (py::ssize_t i = 0; i < numbers.shape(0); ++i) {
      for (py::ssize_t k = 0; k < numbers.shape(1); ++k) {
        if (!std::isfinite(numbers(i, k))) {
          throw InputError("setpoints[" + std::to_string(i) + ", " + std::to_string(k) + "]", 0, word_of(numbers(i, k)),
                           "degrees");
        }
        setpoints.push_back(setpoint_of(numbers(i, k)));
      }
    }
    return setpoints;
  }

  void read_angles() {
    auto next = angles_.begin();
    for (std::size_t i = 0; i < size(); ++i) {
      for (const double angle : worlds_->plant(i).joint_angles()) {
        *next++ = angle * degrees;
      }
    }
  }

  /// before: the angles a tick ago.
  [[nodiscard]] py::array_t<double> observation(const std::vector<double>& before) const {
    const double tick_s = scenarios_.front().kernel.tick_period_us * 1e-6;
    const std::size_t width = 3 * joints() + 2 * robot().links.size() + 4;
    std::vector<double> numbers;
    numbers.reserve(size() * width);
    for (std::size_t i = 0; i < size(); ++i) {
      const sim::Plant& plant = worlds_->plant(i);
      const auto own = angles_.begin() + static_cast<std::ptrdiff_t>(i * joints());
      numbers.insert(numbers.end(), own, own + static_cast<std::ptrdiff_t>(joints()));
      for (std::size_t joint = 0; joint < joints(); ++joint) {
        numbers.push_back((angles_[i * joints() + joint] - before[i * joints() + joint]) / tick_s);
      }
      numbers.insert(numbers.end(), plant.servo_currents().begin(), plant.servo_currents().end());
      for (const unsigned bit : {0U, 1U}) {
        for (const std::uint8_t contacts : worlds_->contacts(i)) {
          numbers.push_back((contacts >> bit) & 1U);
        }
      }
      const Eigen::Quaterniond& head = plant.link_poses().front().orientation;
      numbers.insert(numbers.end(), {head.w(), head.x(), head.y(), head.z()});
    }
    return array_of(std::move(numbers), {size(), width});
  }

  std::vector<sim::Scenario> scenarios_;
  std::unique_ptr<sim::DrivenWorlds> worlds_;
  std::vector<double> angles_;     ///< degrees, of all joints of all worlds
  std::vector<double> distances_;  ///< m, forward, of each world
  bool is_used_ = false;
};

}  // namespace
}  // namespace proleg::python

namespace pybind11::detail {
template <>
class type_caster<proleg::python::Worlds> : public caster_of_made<proleg::python::Worlds> {};
}  // namespace pybind11::detail

namespace proleg::python {

void add_worlds(py::module_& module) {
  py::class_<Worlds>(module, "Worlds")
      .def(py::init<const sim::Scenario&, std::size_t>(), py::arg("scenario"), py::arg("count"))
      .def("reset", &Worlds::reset, py::arg("seed"), py::arg("start"))
      .def("step", &Worlds::step, py::arg("setpoints"))
      .def_property_readonly("names", &Worlds::names)
      .def_property_readonly("failures", &Worlds::failures)
      .def_property_readonly("positions", &Worlds::positions)
      .def_property_readonly("displacements", &Worlds::displacements);
  refuse_copies(module.attr("Worlds"));
}

}  // namespace proleg::python
