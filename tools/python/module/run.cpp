#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/run_measures.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/run/simulation_texts.hpp"
#include "tools/python/module/conversions.hpp"
#include "tools/python/module/long_call.hpp"
#include "tools/python/module/parts.hpp"

namespace py = pybind11;

namespace proleg::python {
namespace {

/// The numbers of a series, tick by tick: a row for each tick, of some numbers for each joint or link.
template <typename Number>
struct Series {
  std::vector<std::size_t> row;  ///< its shape
  std::vector<Number> numbers{};

  void reserve(std::size_t ticks) {
    std::size_t size = ticks;
    for (const std::size_t part : row) {
      size *= part;
    }
    numbers.reserve(size);
  }
  [[nodiscard]] py::array_t<Number> array() {
    std::size_t size = 1;
    for (const std::size_t part : row) {
      size *= part;
    }
    std::vector<std::size_t> shape{numbers.size() / std::max<std::size_t>(size, 1)};
    shape.insert(shape.end(), row.begin(), row.end());
    return array_of(std::move(numbers), std::move(shape));
  }
};

/// What a run keeps of each tick.
class Log {
 public:
  /// names: of the series to keep. Throws InputError for an unknown one.
  Log(const sim::Scenario& scenario, const std::vector<std::string>& names, std::uint32_t ticks)
      : joints_(scenario.robot.joints.size()), links_(scenario.robot.links.size()) {
    for (const std::string& name : names) {
      const auto known = std::ranges::find(series_names, name);
      if (known == series_names.end()) {
        throw InputError("keep", 0, in_quotes(name),
                         "one of " + listed(std::vector<std::string>(series_names.begin(), series_names.end())));
      }
      kept_[static_cast<std::size_t>(known - series_names.begin())] = true;
    }
    require_memory(ticks);
    for_each_kept([ticks](Kept /*which*/, auto& series) { series.reserve(ticks); });
  }

  void add(const sim::Simulation& simulation) {
    const sim::Plant& plant = simulation.plant();
    const auto append = [this](Kept which, auto& series, const auto& numbers) {
      if (keeps(which)) {
        series.numbers.insert(series.numbers.end(), numbers.begin(), numbers.end());
      }
    };
    append(setpoints, setpoints_, simulation.setpoints());
    if (keeps(angles)) {
      for (const double angle : plant.joint_angles()) {
        angles_.numbers.push_back(angle * (180.0 / std::numbers::pi));
      }
    }
    append(torques, torques_, plant.motor_torques());
    append(currents, currents_, plant.servo_currents());
    append(contacts, contacts_, simulation.latched_contacts());
    append(forces, forces_, plant.contact_forces());
    for (const sim::Pose& pose : plant.link_poses()) {
      if (keeps(positions)) {
        positions_.numbers.insert(positions_.numbers.end(), {pose.position.x(), pose.position.y(), pose.position.z()});
      }
      if (keeps(orientations)) {
        const Eigen::Quaterniond& turn = pose.orientation;
        orientations_.numbers.insert(orientations_.numbers.end(), {turn.w(), turn.x(), turn.y(), turn.z()});
      }
    }
  }

  [[nodiscard]] py::dict arrays() {
    py::dict all;
    for_each_kept(
        [&all](Kept which, auto& series) { all[py::str(std::string(series_names[which]))] = series.array(); });
    return all;
  }

  static constexpr std::array<std::string_view, 8> series_names{
      "setpoints", "angles", "torques", "currents", "contacts", "contact_forces", "positions", "orientations"};

 private:
  /// In the order of the names.
  enum Kept : std::size_t { setpoints, angles, torques, currents, contacts, forces, positions, orientations };

  [[nodiscard]] bool keeps(Kept which) const { return kept_[which]; }

  /// Calls use(which, series) for each series that is kept.
  template <typename Use>
  void for_each_kept(const Use& use) {
    const auto call = [&](Kept which, auto& series) {
      if (keeps(which)) {
        use(which, series);
      }
    };
    call(setpoints, setpoints_);
    call(angles, angles_);
    call(torques, torques_);
    call(currents, currents_);
    call(contacts, contacts_);
    call(forces, forces_);
    call(positions, positions_);
    call(orientations, orientations_);
  }

  /// A day of a long robot has more numbers than most computers have memory.
  void require_memory(std::uint32_t ticks) const {
    const std::array<std::size_t, 8> bytes_of_row{4 * joints_, 8 * joints_, 8 * joints_, 8 * joints_,
                                                  links_,      8 * links_,  24 * links_, 32 * links_};
    constexpr std::size_t most = std::size_t{4} << 30U;
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      bytes += kept_[i] ? bytes_of_row[i] * ticks : 0;
    }
    if (bytes > most) {
      throw InputError("keep", 0,
                       number_text(static_cast<double>(bytes) / 1e9) + " GB for " + std::to_string(ticks) + " ticks",
                       "series of at most 4.3 GB: fewer of them, or a recording instead");
    }
  }

  std::size_t joints_;
  std::size_t links_;
  std::array<bool, 8> kept_{};
  Series<std::int32_t> setpoints_{{joints_}};
  Series<double> angles_{{joints_}};
  Series<double> torques_{{joints_}};
  Series<double> currents_{{joints_}};
  Series<std::uint8_t> contacts_{{links_}};
  Series<double> forces_{{links_}};
  Series<double> positions_{{links_, 3}};
  Series<double> orientations_{{links_, 4}};
};

py::dict measures_dict(const sim::MeasureValues& values) {
  py::dict all;
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    all[py::str(std::string(declaration.name))] = values[declaration.measure];
  }
  return all;
}

/// A run from its start to its end.
py::dict simulate(sim::Scenario scenario, const std::vector<std::string>& keep,
                  const std::optional<std::string>& losses_word, const std::optional<std::string>& record) {
  const std::uint32_t ticks = tools::run_ticks(scenario);
  sim::Losses losses;
  if (losses_word) {
    losses = sim::read_losses(*losses_word, scenario.robot);
    losses.require_effect(ticks, scenario.kernel);
  }
  if (record) {
    tools::ScenarioOptions options;
    options.record = record;
    check_outputs(tools::planned_recording(options));
  }
  if (const auto contradiction = sim::find_contradiction(scenario)) {
    throw InputError(scenario.path, 0, contradiction->found, contradiction->expected);
  }
  Log log(scenario, keep, ticks);
  std::unique_ptr<sim::Simulation> simulation;
  std::uint64_t lost_frames = 0;
  {
    const Unlocked unlocked;
    SignalWatch watch;
    simulation =
        std::make_unique<sim::Simulation>(scenario, &losses);  // made before any file: it may refuse the scenario
    std::unique_ptr<sim::Recorder> recorder;
    if (record) {
      recorder = std::make_unique<sim::Recorder>(follow_links(*record), scenario, "simulate", tools::build_id);
    }
    while (simulation->tick() < ticks) {
      const Change* const change = simulation->advance();
      lost_frames += simulation->chain().lost().size();
      log.add(*simulation);
      if (recorder) {
        if (change != nullptr) {
          recorder->record_change(*change);
        }
        recorder->record_tick(simulation->sample());
      }
      watch.check();
    }
    if (recorder) {
      recorder->finish(tools::results_of(*simulation, scenario, lost_frames));
    }
  }
  const sim::Plant& plant = simulation->plant();
  py::dict result;
  result["displacement"] = plant.displacement();
  result["duration"] = simulation->time_s();
  result["setpoint_hash"] = simulation->setpoint_hash().hex();
  result["servo_hash"] = simulation->servo_hash().hex();
  result["world_hash"] = simulation->world_hash();
  result["motion_hash"] = simulation->motion_hash();
  result["lost_frames"] = lost_frames;
  result["measures"] = measures_dict(simulation->measures());
  result["clipped_ticks"] = std::vector<std::uint32_t>(simulation->chain().clipped_ticks().begin(),
                                                       simulation->chain().clipped_ticks().end());
  result["series"] = log.arrays();
  return result;
}

}  // namespace

void add_run(py::module_& module) {
  module.def("simulate", &simulate, py::arg("scenario"), py::arg("keep"), py::arg("losses"), py::arg("record"));
  py::list names;
  for (const std::string_view name : Log::series_names) {
    names.append(std::string(name));
  }
  module.attr("series_names") = py::tuple(names);
  py::list measures;
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    measures.append(py::make_tuple(std::string(declaration.name), std::string(declaration.unit),
                                   declaration.higher_is_better, std::string(declaration.help)));
  }
  module.attr("measures") = py::tuple(measures);
}

}  // namespace proleg::python
