#include "tools/proleg/ui/bus_session.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/ui/bus_view.hpp"
#include "tools/proleg/ui/recording_folder.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
using RobotState = DrivenRobot::State;

constexpr double slowest_pose = 1.0;
constexpr double fastest_pose = 180.0;
constexpr double usual_pose_speed = 60.0;

json gait_json(const GaitCheck& check) {
  return {{"compared", check.compared()},
          {"differences", check.differences()},
          {"missing", check.missing()},
          {"first_difference", check.first_difference() ? json(*check.first_difference()) : json()},
          {"end", check.end_of_comparison() ? json(*check.end_of_comparison()) : json()}};
}

}  // namespace

BusSession::BusSession(const sim::Scenario& file, BusAccess& bus, std::string address, BusSessionOptions options,
                       BusSharing& sharing, SessionRequests& requests, host::SessionOutput& output)
    : SessionThread(requests, output),
      file_(file),
      address_(std::move(address)),
      options_(std::move(options)),
      bus_(bus.connection()),
      sharing_(sharing),
      monitor_(bus_),
      monitor_attachment_(bus_, monitor_),
      shared_(bus.context(), bus_),
      bus_views_(address_, bus_, monitor_),
      stops_(file, bus_, output),
      edits_(file, file),
      delivery_(edits_),
      started_(file),
      rows_(file) {
  output_.publish("robot", robot_document(file, "bus"));
  output_.set_signals(rows_.layout(), file.kernel.tick_period_us);
  monitor_.set_reads_touch(true);
  begin_scan();
  begin_thread();
}

BusSession::~BusSession() { end_thread(); }

void BusSession::serve() {
  constexpr Microseconds look_period_us = 5'000;
  stop_at_once();
  look_at_holder();
  look_at_jobs();
  take_operations();
  poll_robot();
  stops_.answer();
  if (scan_ && scan_->is_done()) {
    end_scan();
  }
  add_idle_rows();
  publish_all(Clock::now());
  bus_.run_until(bus_.now() + look_period_us, [this] { return requests_.are_there(); });
}

void BusSession::close() { let_robot_rest("the end of the program"); }

void BusSession::fail(const std::string& why) {
  has_failed_ = true;
  failure_ = why;
  is_session_new_ = true;
  try {
    let_robot_rest("an error");
  } catch (...) {
    // Without a master the modules stop by themselves.
    robot_.reset();
    sharing_.end_power();
    throw;
  }
}

void BusSession::let_robot_rest(const std::string& by) {
  if (robot_) {
    stop_robot(by);
  }
  constexpr std::chrono::seconds at_most{25};  // longer than GaitRun::has_stopped() waits
  for (const auto end = Clock::now() + at_most; robot_ && Clock::now() < end;) {
    bus_.run_for(5'000);
    poll_robot();
    publish_all(Clock::now());
  }
}

void BusSession::begin_scan() {
  end_scan();
  scan_.emplace(bus_);
  scan_attachment_.emplace(bus_, *scan_);
  scan_->start(bus_.now());
}

void BusSession::end_scan() {
  scan_attachment_.reset();
  scan_.reset();
}

void BusSession::stop_at_once() {
  const Stops stops = take_stops();
  if (stops.empty()) {
    return;
  }
  stopped_by_ = stops.back().by;
  is_session_new_ = true;
  stops_.give(stops, robot_ ? &*robot_ : nullptr);
}

/// A robot with power needs somebody who drives it.
void BusSession::look_at_holder() {
  const bool is_absent = driver_.look(requests_.take_holder(), Clock::now());
  if (is_absent && robot_ && robot_->state() != RobotState::stopping && robot_->state() != RobotState::stopped) {
    stop_robot("nobody drives");
    output_.notice(host::NoticeLevel::warning, "the robot stops: nobody drives it");
  }
}

/// Programs that take part in the bus ask modules what the monitor asks, too: two at a time get each other's answers.
void BusSession::look_at_jobs() {
  for (host::Descriptor& end : sharing_.take_programs()) {
    shared_.add(std::move(end));
  }
  shared_.look_at_connection(sharing_.longest_loss());
  const bool has_job = sharing_.has_job();
  if (has_job) {
    end_scan();
  }
  monitor_.set_reads(!robot_ && !has_job);
}

json BusSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{
      {"power", &BusSession::power}, {"run", &BusSession::go_on},   {"pause", &BusSession::pause},
      {"pose", &BusSession::pose},   {"set", &BusSession::set},     {"undo", &BusSession::undo},
      {"redo", &BusSession::redo},   {"reset", &BusSession::reset}, {"record", &BusSession::record},
      {"scan", &BusSession::scan},   {"ping", &BusSession::ping}};
  const Handler handler = handler_of(handlers, operation.name);
  if (has_failed_ && operation.name != "scan" && operation.name != "ping") {
    throw std::runtime_error("the session has failed; start proleg ui again");
  }
  return (this->*handler)(operation.arguments);
}

DrivenRobot& BusSession::powered() {
  if (!robot_) {
    throw std::runtime_error("the servos have no power");
  }
  if (robot_->state() == RobotState::stopping || robot_->state() == RobotState::stopped) {
    throw std::runtime_error("the robot is stopping");
  }
  if (robot_->state() == RobotState::starting) {
    throw std::runtime_error("the robot is starting");
  }
  return *robot_;
}

json BusSession::power(const json& arguments) {
  const auto on = argument<bool>(arguments, "on", "true or false");
  if (!on) {
    throw InputError("on", 0, "no value", "true or false");
  }
  if (*on) {
    start_robot(true);
  } else if (robot_) {
    stop_robot({});
  }
  return json::object();
}

json BusSession::go_on(const json& /*arguments*/) {
  if (!robot_) {
    start_robot(false);
  } else if (powered().state() == RobotState::held) {
    robot_->follow_gait();
  }
  is_session_new_ = true;
  return json::object();
}

json BusSession::pause(const json& /*arguments*/) {
  if (powered().state() != RobotState::held) {
    robot_->hold();
  }
  is_session_new_ = true;
  return json::object();
}

json BusSession::pose(const json& arguments) {
  if (powered().state() != RobotState::held) {
    throw std::runtime_error("the joints follow the gait; hold them first");
  }
  const auto angles = argument<std::vector<json>>(arguments, "angles", "degrees of each joint, or null");
  const double speed = argument<double>(arguments, "speed", "degrees a second").value_or(usual_pose_speed);
  const std::size_t joints = file_.robot.joints.size();
  if (!angles || angles->size() != joints) {
    throw InputError("angles", 0, angles ? std::to_string(angles->size()) + " values" : "no value",
                     std::to_string(joints) + " values");
  }
  if (!(speed >= slowest_pose && speed <= fastest_pose)) {
    throw InputError("speed", 0, exact_text(speed), "1 to 180 degrees a second");
  }
  std::vector<DrivenRobot::Goal> goals;
  for (unsigned joint = 0; joint < joints; ++joint) {
    const json& angle = (*angles)[joint];
    if (angle.is_null()) {
      continue;
    }
    if (!angle.is_number() || !(angle.get<double>() >= -90.0 && angle.get<double>() <= 90.0)) {
      throw InputError("angles", 0, shortened(angle.dump()), "-90 to 90 degrees, or null");
    }
    goals.push_back({joint, static_cast<std::int32_t>(angle.get<double>() / 90.0 * (1 << 30))});
  }
  robot_->go_to(goals, speed);
  return json::object();
}

json BusSession::set(const json& arguments) {
  const auto words = argument<std::vector<std::string>>(arguments, "words", "texts such as \"amplitude:J2=30\"");
  const auto gesture = argument<std::uint64_t>(arguments, "gesture", "a whole number");
  std::vector<Setting> internal_values = edits_.read(words.value_or(std::vector<std::string>{}));
  std::erase_if(internal_values, [](const Setting& setting) { return !setting.internal; });
  if (!internal_values.empty()) {
    static_cast<void>(powered());
  }
  edits_.set(*words, gesture);
  are_parameters_new_ = true;
  delivery_.add(internal_values);
  return {{"tick", nullptr}};
}

json BusSession::undo(const json& /*arguments*/) {
  if (!edits_.undo()) {
    throw std::runtime_error("there is nothing to undo");
  }
  are_parameters_new_ = true;
  return json::object();
}

json BusSession::redo(const json& /*arguments*/) {
  if (!edits_.redo()) {
    throw std::runtime_error("there is nothing to redo");
  }
  are_parameters_new_ = true;
  return json::object();
}

json BusSession::reset(const json& arguments) {
  edits_.reset(edits_.places_of(parameter_names(arguments)));
  are_parameters_new_ = true;
  return json::object();
}

json BusSession::record(const json& arguments) {
  const auto file = argument<std::string>(arguments, "file", "a file name");
  if (robot_ && file) {
    throw std::runtime_error("a recording of a robot has the whole run: switch the power off first");
  }
  planned_recording_ = file ? new_recording(options_.recordings, *file).string() : std::string();
  is_session_new_ = true;
  return file ? json{{"file", planned_recording_}} : json::object();
}

json BusSession::scan(const json& /*arguments*/) {
  if (robot_) {
    throw std::runtime_error("the robot has power; its modules are known");
  }
  if (sharing_.has_job()) {
    throw std::runtime_error("a job on the modules goes on");
  }
  if (!scan_) {
    begin_scan();
  }
  monitor_.read_limits_again();
  return json::object();
}

json BusSession::ping(const json& /*arguments*/) { return json::object(); }

void BusSession::start_robot(bool holds) {
  if (robot_) {
    throw std::runtime_error(robot_->state() == RobotState::stopping ? "the robot is stopping"
                                                                     : "the robot has power already");
  }
  look_at_holder();  // whoever asks for the start may have taken control since the last look
  if (!driver_.has_driver()) {
    throw std::runtime_error("nobody drives");
  }
  if (!sharing_.begin_power()) {
    throw std::runtime_error("a job on the modules goes on");
  }
  try {
    make_robot(holds);
  } catch (...) {
    sharing_.end_power();
    throw;
  }
  end_scan();
  monitor_.set_reads(false);  // the master needs the bus, and reads what it needs
  delivery_.begin_run();
  are_parameters_new_ = true;
  dropped_changes_ = 0;
  failure_.clear();
  stopped_by_.clear();
  started_with_ = holds ? "power" : "run";
  stops_.clear();
  is_session_new_ = true;
}

void BusSession::make_robot(bool holds) {
  started_ = edits_.scenario_as_wanted();
  std::unique_ptr<sim::Recorder> recorder;
  if (!holds && !planned_recording_.empty()) {
    recorder = std::make_unique<sim::Recorder>(planned_recording_, started_, "drive", options_.build_id,
                                               sim::EarlierFile::is_refused);
  }
  const bool is_recording = recorder != nullptr;
  robot_.emplace(
      started_, bus_, holds, std::move(recorder),
      DrivenRobot::Listener{
          [this](const sim::TickSample& sample, std::span<const double> angles, const std::vector<bool>& measured) {
            output_.add_row(rows_.run_of(sample.tick), sample.tick, rows_.fill(sample, angles, measured));
          },
          [this](const Change& change) {
            delivery_.confirm(change);
            are_parameters_new_ = true;
          },
          [this](const std::string& line, bool is_error) {
            output_.notice(is_error ? host::NoticeLevel::error : host::NoticeLevel::warning, line);
          }});
  if (is_recording) {
    recording_ = std::exchange(planned_recording_, {});
  }
}

/// by: empty: as somebody wished who drives.
void BusSession::stop_robot(const std::string& by) {
  if (!by.empty()) {
    stopped_by_ = by;
  }
  robot_->stop();
  is_session_new_ = true;
}

void BusSession::poll_robot() {
  if (!robot_) {
    return;
  }
  const RobotState before = robot_->state();
  robot_->poll();
  if (robot_->state() != before) {
    is_session_new_ = true;
  }
  if (robot_->failure() && failure_.empty()) {
    failure_ = *robot_->failure();
    output_.notice(host::NoticeLevel::error, failure_);
  }
  if (!recording_.empty() && !robot_->is_recording()) {
    output_.notice(host::NoticeLevel::info, "the recording is in " + std::exchange(recording_, {}));
    is_session_new_ = true;
  }
  give_changes();
  gait_ = gait_json(robot_->gait().check());
  if (robot_->state() == RobotState::stopped) {
    if (!robot_->are_all_off()) {
      output_.notice(host::NoticeLevel::error,
                     "not all modules have confirmed that their servos have no power: switch the robot off; modules "
                     "without a host stop by themselves within 1.5 s");
    }
    robot_.reset();
    sharing_.end_power();
  }
}

/// Gives the modules the coming changes, when they have those before.
void BusSession::give_changes() {
  if (!robot_->has_room_for_changes()) {
    return;
  }
  if (robot_->dropped_changes() > dropped_changes_) {
    dropped_changes_ = robot_->dropped_changes();
    delivery_.give_up();
    are_parameters_new_ = true;
    output_.notice(host::NoticeLevel::error, "a change had no effect: not all modules have got it in time");
  }
  if (const std::vector<Setting> settings = delivery_.next(); !settings.empty()) {
    robot_->change(settings);
  }
}

/// Without power there are no ticks, but viewers see what is measured.
void BusSession::add_idle_rows() {
  if (robot_ && robot_->state() != RobotState::starting && robot_->state() != RobotState::stopping) {
    return;
  }
  std::vector<std::optional<std::int32_t>> angles(file_.robot.joints.size());
  for (const host::MonitoredNode& node : monitor_.nodes()) {
    const auto module = std::ranges::find(file_.modules, node.node, &sim::ModulePlace::node);
    if (module != file_.modules.end()) {
      angles[static_cast<std::size_t>(module - file_.modules.begin())] = node.position;
    }
  }
  for (const RobotRows::Idle& row : rows_.idle(Clock::now(), angles)) {
    output_.add_row(row.run, row.tick, row.values);
  }
}

std::string BusSession::state_name() const {
  if (has_failed_) {
    return "failed";
  }
  if (!robot_) {
    return "off";
  }
  switch (robot_->state()) {
    case RobotState::starting:
      return "starting";
    case RobotState::held:
      return "held";
    case RobotState::joining:
    case RobotState::running:
      return "running";
    case RobotState::stopping:
    case RobotState::stopped:
      break;
  }
  return "stopping";
}

void BusSession::publish_all(Clock::time_point now) {
  if (are_parameters_new_) {
    output_.publish("parameters", parameters_document(file_, edits_.parameters()));
    is_session_new_ = true;
    are_parameters_new_ = false;
  }
  const bool is_due = now >= publish_at_;
  if (std::optional<BusView> view = bus_views_.due(now)) {
    publish_bus(std::move(*view));
  }
  if (is_due) {
    publish_at_ = now + publish_period;
  }
  if (is_session_new_ || is_due) {
    publish_session();
    is_session_new_ = false;
  }
}

void BusSession::publish_session() {
  const std::uint32_t tick = robot_ ? robot_->gait().check().ticks() : 0;
  const std::string& recording = recording_.empty() ? planned_recording_ : recording_;
  output_.publish("session", {{"kind", "bus"},
                              {"state", state_name()},
                              {"run", rows_.run()},
                              {"tick", tick},
                              {"time_s", static_cast<double>(std::uint64_t{tick} * file_.kernel.tick_period_us) / 1e6},
                              {"stopped_by", text_or_null(stopped_by_)},
                              {"started_with", robot_ ? text_or_null(started_with_) : json()},
                              {"recording", text_or_null(recording)},
                              {"changed", edits_.differs_from_file()},
                              {"undo", text_or_null(edits_.history().name_to_undo())},
                              {"redo", text_or_null(edits_.history().name_to_redo())},
                              {"failure", text_or_null(failure_)},
                              {"gait", gait_}});
}

void BusSession::publish_bus(BusView view) {
  view.stop_confirmed = stops_.confirmed();
  if (robot_) {
    view.watch = &robot_->gait().gait_watch();
    if (const auto median_us = robot_->gait().answers_us().median()) {
      view.latency_ms = static_cast<double>(*median_us) * 1e-3;
    }
  }
  output_.publish("bus", bus_document(file_.modules, view));
}

}  // namespace proleg::tools
