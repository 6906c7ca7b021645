#include "tools/python/module/driven_robot.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/computer/threads/quiet_thread.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/common/scenario_run.hpp"

namespace proleg::python {
namespace {

constexpr Microseconds look_period_us = 20'000;
constexpr std::uint32_t longest_s = 86'400;

/// A measurement arrives some ticks after its SYNC.
constexpr std::uint32_t ticks_of_measuring = 4;

std::uint32_t ticks_of(const sim::Scenario& scenario, std::uint32_t seconds) {
  return static_cast<std::uint32_t>(std::uint64_t{seconds} * 1'000'000 / scenario.kernel.tick_period_us);
}

}  // namespace

DrivenRobot::DrivenRobot(const tools::BusOptions& bus, sim::Scenario scenario, const std::optional<std::string>& record,
                         std::optional<double> idle_s)
    : scenario_(std::move(scenario)), record_(record), idle_s_(idle_s), bus_(std::make_unique<tools::BusAccess>(bus)) {
  if (const auto line = tools::fit_servo_period(scenario_, bus.address())) {
    reports_.push_back(*line);
  }
}

DrivenRobot::~DrivenRobot() { static_cast<void>(stop()); }

std::vector<host::ScannedNode> DrivenRobot::scan() {
  const std::lock_guard lock(scan_mutex_);
  if (!bus_) {
    throw std::runtime_error("the robot was stopped");
  }
  host::BusScan all(bus_->connection());
  tools::scan(*bus_, all);
  return all.nodes();
}

void DrivenRobot::set(const std::string& word) { sim::apply_setting(scenario_, word); }

void DrivenRobot::start() {
  tools::ScenarioOptions options;
  options.record = record_;
  recorder_ = tools::open_recorder(options, scenario_, "drive");
  thread_ = start_quiet_thread([this] { run(); });
}

void DrivenRobot::change(const std::string& word) {
  const std::lock_guard lock(mutex_);
  word_ = word;
  asked_ = std::max(asked_, made());
}

bool DrivenRobot::is_changed(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  asked_ = std::max(asked_, made());
  if (!changed_.wait_for(lock, timeout, [this] { return !word_ || !moves_; })) {
    return false;
  }
  if (failure_) {
    std::rethrow_exception(failure_);
  }
  if (const std::exception_ptr refusal = std::exchange(refusal_, nullptr)) {
    std::rethrow_exception(refusal);
  }
  return true;
}

void DrivenRobot::begin_call(std::uint32_t count) {
  const std::lock_guard lock(mutex_);
  if (failure_) {
    std::rethrow_exception(failure_);
  }
  asked_ = std::max(first_ + count, made());
}

void DrivenRobot::end_call() {
  const std::lock_guard lock(mutex_);
  asked_ = made();
}

/// Throws std::runtime_error if the program has made no call for too long.
void DrivenRobot::require_call() {
  const std::lock_guard lock(mutex_);
  if (idle_s_ && (made() - std::min(made(), asked_)) * (scenario_.kernel.tick_period_us * 1e-6) > *idle_s_) {
    throw std::runtime_error("idle: found no call of the program for " + number_text(*idle_s_) +
                             " s, so the robot has stopped; expected run() sooner, or Robot(..., idle=SECONDS)");
  }
}

bool DrivenRobot::wait_for(std::uint32_t count, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return ticks_.size() >= count + ticks_of_measuring || !moves_; });
}

RobotTicks DrivenRobot::take(std::uint32_t count) {
  const std::lock_guard lock(mutex_);
  if (ticks_.size() < count) {
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    throw std::runtime_error("the robot does not move any more");
  }
  RobotTicks taken;
  taken.first = first_;
  taken.differences = differences_;
  taken.missing = missing_;
  for (std::uint32_t i = 0; i < count; ++i) {
    Tick tick = std::move(ticks_.front());
    ticks_.pop_front();
    taken.setpoints.insert(taken.setpoints.end(), tick.setpoints.begin(), tick.setpoints.end());
    taken.angles.insert(taken.angles.end(), tick.angles.begin(), tick.angles.end());
    taken.currents.insert(taken.currents.end(), tick.currents.begin(), tick.currents.end());
    taken.setpoint_hash = std::move(tick.hash);
  }
  first_ += count;
  return taken;
}

std::string DrivenRobot::stop() {
  stops_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
  {
    const std::lock_guard lock(scan_mutex_);
    bus_.reset();
  }
  recorder_.reset();
  const std::lock_guard lock(mutex_);
  moves_ = false;
  return std::exchange(not_off_, {});
}

std::vector<std::string> DrivenRobot::take_reports() {
  const std::lock_guard lock(mutex_);
  return std::exchange(reports_, {});
}

void DrivenRobot::run() {
  try {
    host::BusConnection& bus = bus_->connection();
    tools::GaitRun gait(scenario_, bus, {ticks_of(scenario_, longest_s)});
    drive(gait, bus);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = failure_ ? failure_ : std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  moves_ = false;
  changed_.notify_all();
}

void DrivenRobot::drive(tools::GaitRun& gait, host::BusConnection& bus) {
  bool has_moved = false;
  try {
    set_up(gait, bus);
    has_moved = true;
    while (!stops_ && gait.check().ticks() < ticks_of(scenario_, longest_s)) {
      bus.run_until(bus.now() + look_period_us, [&] { return gait.has_ended() || stops_; });
      report(gait);
      take_ticks(gait, false);
      require_call();
      take_changes(gait);
      gait.release_changes();
      if (gait.has_ended()) {
        throw std::runtime_error(gait.why_ended());
      }
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  ramp_down(gait, bus);
  if (!has_moved) {
    const std::lock_guard lock(mutex_);
    not_off_.clear();  // why it did not start says more
  }
  if (recorder_) {
    const double seconds =
        static_cast<double>(std::uint64_t{gait.check().ticks()} * scenario_.kernel.tick_period_us) / 1e6;
    recorder_->finish({{"simulated_s", exact_text(seconds)},
                       {"differences", std::to_string(gait.check().differences())},
                       {"frames_missing", std::to_string(gait.check().missing())},
                       {"setpoint_hash", gait.check().setpoint_hash().hex()},
                       {"servo_hash", gait.check().servo_hash().hex()}});
  }
}

/// Throws std::runtime_error if the robot cannot be started. Nothing has moved then.
void DrivenRobot::set_up(tools::GaitRun& gait, host::BusConnection& bus) {
  constexpr Microseconds at_most = 60'000'000;  // the master gives up by itself; this bounds a master with a fault
  gait.start();
  bus.run_until(bus.now() + at_most, [&] {
    report(gait);
    return gait.state() == canopen::MasterState::running || gait.has_ended() || stops_;
  });
  if (gait.state() == canopen::MasterState::running) {
    gait.watch();
  } else if (!stops_) {
    const std::string reason = gait.why_ended();
    if (gait.has_bad_setup()) {
      throw tools::BadInput(scenario_.path + ": " + reason);
    }
    throw std::runtime_error(reason);
  }
}

void DrivenRobot::ramp_down(tools::GaitRun& gait, host::BusConnection& bus) {
  gait.stop();
  for (bool has_stopped = false; !has_stopped;) {
    bus.run_until(bus.now() + look_period_us, [&] {
      report(gait);
      return has_stopped = gait.has_stopped();
    });
    take_ticks(gait, has_stopped);
  }
  gait.compare_setpoints();
  const std::lock_guard lock(mutex_);
  if (!gait.are_all_off()) {
    not_off_ =
        "not all modules have confirmed that their servos have no power: switch the robot off; modules without a host "
        "stop by themselves within 1.5 s";
  } else if (!gait.check().different_setpoints().empty()) {
    reports_.push_back("set-points of " + listed(gait.check().different_setpoints()) +
                       " differ from those of this computer");
  }
}

void DrivenRobot::take_ticks(tools::GaitRun& gait, bool at_end) {
  const std::lock_guard lock(mutex_);
  const std::size_t joints = scenario_.robot.joints.size();
  try {
    gait.take_ticks(
        at_end,
        {.tick =
             [&](const Change* change) {
               const std::span<const std::int32_t> setpoints = gait.check().setpoints();
               const std::vector<double> nothing(joints, std::numeric_limits<double>::quiet_NaN());
               ticks_.push_back(
                   {{setpoints.begin(), setpoints.end()}, nothing, nothing, gait.check().setpoint_hash().hex()});
               if (recorder_) {
                 if (change != nullptr) {
                   recorder_->record_change(*change);
                 }
                 recorder_->record_tick(gait.check().sample(gait.drive()));
               }
             },
         .measured = [this](const host::Measurement& measured) { note(measured); }});
  } catch (...) {
    // A recording that cannot be written ends the run, and never its stop.
    failure_ = failure_ ? failure_ : std::current_exception();
    stops_ = true;
  }
  differences_ = gait.check().differences();
  missing_ = gait.check().missing();
  changed_.notify_all();
}

/// A measurement at SYNC k is one at the end of tick k - 1.
void DrivenRobot::note(const host::Measurement& measured) {
  if (measured.tick <= first_ || measured.tick - 1 - first_ >= ticks_.size()) {
    return;
  }
  Tick& tick = ticks_[measured.tick - 1 - first_];
  if (measured.values.angle != canopen::Monitoring::not_measured) {
    constexpr double degrees_of_unit = 90.0 / (1 << 14);
    tick.angles[measured.joint] = measured.values.angle * degrees_of_unit;
  }
  tick.currents[measured.joint] = measured.values.current_ma;
}

void DrivenRobot::take_changes(tools::GaitRun& gait) {
  const std::lock_guard lock(mutex_);
  if (!word_) {
    return;
  }
  try {
    gait.add_change(*word_);
  } catch (const InputError&) {
    refusal_ = std::current_exception();
  }
  word_.reset();
  changed_.notify_all();
}

void DrivenRobot::report(tools::GaitRun& gait) {
  const std::lock_guard lock(mutex_);
  gait.report_events(false, [this](const std::string& line) { reports_.push_back(line); });
}

}  // namespace proleg::python
