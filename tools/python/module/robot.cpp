// The module proleg._robot: robots of modules. It is a module of its own because few programs need it.

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/robot/state_text.hpp"
#include "host/transport/open_transport.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "sim/scenario/module_sensors.hpp"
#include "sim/scenario/overrides.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/python/module/conversions.hpp"
#include "tools/python/module/driven_robot.hpp"
#include "tools/python/module/long_call.hpp"
#include "tools/python/module/parts.hpp"

namespace py = pybind11;

namespace proleg::python {
namespace {

/// What `proleg drive` refuses before it opens the bus.
void check(const sim::Scenario& scenario, const std::optional<std::string>& record) {
  sim::require_sensors(scenario, sim::sensors_of_modules, "a module");
  tools::ScenarioOptions options;
  options.overrides = sim::words_of(scenario.overrides);
  options.overrides.engine.reset();  // it says what simulate() computes with, and changes nothing of the robot
  tools::refuse_world_options(options, {{"--move", !scenario.moves.empty()}});
  options.record = record;
  check_outputs(tools::planned_recording(options));
}

/// Everything but bad input is a failure of the robot or its bus: a RunError.
template <typename Action>
auto guarded(const Action& action) {
  try {
    return action();
  } catch (const InputError&) {
    throw;
  } catch (const tools::BadInput&) {
    throw;
  } catch (const FileError&) {
    throw;
  } catch (const std::filesystem::filesystem_error&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw RunFailure(error.what());
  }
}

class Robot {
 public:
  Robot(const std::optional<std::string>& bus, const sim::Scenario& scenario, const std::optional<std::string>& record,
        const std::optional<double>& idle_s) {
    check(scenario, record);
    const Unlocked unlocked;
    robot_ = guarded([&] { return std::make_unique<DrivenRobot>(tools::BusOptions{bus}, scenario, record, idle_s); });
  }
  ~Robot() {
    if (getpid() != process_) {
      static_cast<void>(robot_.release());  // the thread and the bus are the parent's
    } else {
      const Unlocked unlocked;
      robot_.reset();
    }
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// node, serial number, joint or None, name, state of the drive, of each joint module.
  py::list modules() {
    require_open();
    const OneThread use(is_used_, "Robot");
    if (robot_->has_started()) {
      throw InputError("modules", 0, "a robot that moves", "a look at its modules before run()");
    }
    py::list all;
    for (const host::ScannedNode& node : scan()) {
      if (node.is_module) {
        all.append(py::make_tuple(node.node, node.serial, node.joint, node.name,
                                  std::string(host::drive_text(node.statusword)), node.software));
      }
    }
    return all;
  }

  py::dict run(std::uint32_t ticks) {
    require_open();
    const OneThread use(is_used_, "Robot");
    if (!robot_->has_started()) {
      guarded([&] { robot_->start(); });
    }
    guarded([&] { robot_->begin_call(ticks); });
    const EndOfCall end{*robot_};
    wait([&](std::chrono::milliseconds time) { return robot_->wait_for(ticks, time); });
    RobotTicks taken = guarded([&] { return robot_->take(ticks); });
    const std::size_t joints = robot_->scenario().robot.joints.size();
    py::dict result;
    result["first_tick"] = taken.first;
    result["setpoints"] = array_of(std::move(taken.setpoints), {ticks, joints});
    result["angles"] = array_of(std::move(taken.angles), {ticks, joints});
    result["currents"] = array_of(std::move(taken.currents), {ticks, joints});
    result["setpoint_hash"] = taken.setpoint_hash;
    result["differences"] = taken.differences;
    result["missing"] = taken.missing;
    return result;
  }

  /// Before the robot moves, the start value changes.
  void change(const std::string& word) {
    require_open();
    const OneThread use(is_used_, "Robot");
    if (!robot_->has_started()) {
      robot_->set(word);
      return;
    }
    robot_->change(word);
    wait([&](std::chrono::milliseconds time) { return guarded([&] { return robot_->is_changed(time); }); });
  }

  [[nodiscard]] bool has_started() const { return getpid() == process_ && robot_->has_started(); }
  [[nodiscard]] std::vector<std::string> reports() { return robot_->take_reports(); }

  /// A Ctrl-C does not break it off. Any thread may call it, also while another one makes a call, which then ends.
  /// Throws RunFailure if a servo may still have power.
  void stop() {
    if (getpid() != process_ || is_stopped_) {
      return;
    }
    is_stopped_ = true;
    std::string not_off;
    {
      const Unlocked unlocked;
      not_off = robot_->stop();
    }
    if (!not_off.empty()) {
      throw RunFailure(not_off);
    }
  }

 private:
  struct EndOfCall {
    DrivenRobot& robot;
    ~EndOfCall() { robot.end_call(); }
  };

  void require_open() const {
    if (getpid() != process_) {
      throw InputError("Robot", 0, "a call in a process that was forked", "the process that drives the robot");
    }
    if (is_stopped_) {
      throw InputError("Robot", 0, "a robot that was stopped", "a new Robot()");
    }
  }

  std::vector<host::ScannedNode> scan() {
    const Unlocked unlocked;
    return guarded([&] { return robot_->scan(); });
  }

  template <typename IsDone>
  static void wait(const IsDone& is_done) {
    const Unlocked unlocked;
    SignalWatch watch;
    while (!is_done(std::chrono::milliseconds(50))) {
      watch.check();
    }
  }

  const pid_t process_ = getpid();
  bool is_stopped_ = false;
  bool is_used_ = false;
  std::unique_ptr<DrivenRobot> robot_;
};

}  // namespace
}  // namespace proleg::python

namespace pybind11::detail {
template <>
class type_caster<proleg::python::Robot> : public caster_of_made<proleg::python::Robot> {};
}  // namespace pybind11::detail

PYBIND11_MODULE(_robot, module) {
  using proleg::python::Robot;
  proleg::python::share_with_core(module);
  module.def("use_programs_of", &proleg::host::use_programs_of, py::arg("folder"));
  py::class_<Robot>(module, "Robot")
      .def(py::init<const std::optional<std::string>&, const proleg::sim::Scenario&, const std::optional<std::string>&,
                    const std::optional<double>&>(),
           py::arg("bus"), py::arg("scenario"), py::arg("record"), py::arg("idle"))
      .def("modules", &Robot::modules)
      .def("run", &Robot::run, py::arg("ticks"))
      .def("change", &Robot::change, py::arg("word"))
      .def("stop", &Robot::stop)
      .def("reports", &Robot::reports)
      .def_property_readonly("has_started", &Robot::has_started);
  proleg::python::refuse_copies(module.attr("Robot"));
}
