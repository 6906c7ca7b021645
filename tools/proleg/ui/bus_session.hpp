#pragma once

// A robot on a bus that viewers watch, power, move and change. It runs in a thread of its own.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/robot/bus_connection.hpp"
#include "host/robot/bus_monitor.hpp"
#include "host/robot/bus_scan.hpp"
#include "host/robot/shared_bus.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/robot/bus_access.hpp"
#include "tools/proleg/ui/bus_sharing.hpp"
#include "tools/proleg/ui/bus_view.hpp"
#include "tools/proleg/ui/driven_robot.hpp"
#include "tools/proleg/ui/parameter_edits.hpp"
#include "tools/proleg/ui/robot_stops.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

struct BusSessionOptions {
  std::filesystem::path recordings;  ///< the folder of all recordings
  std::string build_id;
};

class BusSession final : private SessionThread {
 public:
  /// Carries out `requests`, and reports to `output`. file, bus, requests, output: must outlive the session. Another
  /// thread must not use the bus, but programs take part in it by `sharing`, which must outlive the session, too.
  BusSession(const sim::Scenario& file, BusAccess& bus, std::string address, BusSessionOptions options,
             BusSharing& sharing, SessionRequests& requests, host::SessionOutput& output);
  /// The joints ramp to the safe pose and lose their power first.
  ~BusSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() { return {"ping", "scan"}; }

 private:
  static constexpr std::chrono::milliseconds publish_period{500};  ///< of the session

  // SessionThread
  void serve() override;
  /// The robot loses its power; operations that need the robot are refused from now on.
  void fail(const std::string& why) override;
  /// The robot comes to rest before the program ends.
  void close() override;
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  void stop_at_once();
  void look_at_holder();
  void look_at_jobs();
  void poll_robot();
  void give_changes();
  void add_idle_rows();
  void end_scan();
  void let_robot_rest(const std::string& by);

  // The operations: take their arguments and return the value of the answer, or throw.
  using Handler = nlohmann::json (BusSession::*)(const nlohmann::json&);
  nlohmann::json power(const nlohmann::json& arguments);
  nlohmann::json go_on(const nlohmann::json& arguments);
  nlohmann::json pause(const nlohmann::json& arguments);
  nlohmann::json pose(const nlohmann::json& arguments);
  nlohmann::json set(const nlohmann::json& arguments);
  nlohmann::json undo(const nlohmann::json& arguments);
  nlohmann::json redo(const nlohmann::json& arguments);
  nlohmann::json reset(const nlohmann::json& arguments);
  nlohmann::json record(const nlohmann::json& arguments);
  nlohmann::json scan(const nlohmann::json& arguments);
  nlohmann::json ping(const nlohmann::json& arguments);

  void start_robot(bool holds);
  void make_robot(bool holds);
  void begin_scan();
  void stop_robot(const std::string& by);
  /// Throws unless servos have power, or are about to.
  [[nodiscard]] DrivenRobot& powered();
  void publish_all(Clock::time_point now);
  void publish_session();
  void publish_bus(BusView view);
  [[nodiscard]] std::string state_name() const;

  const sim::Scenario& file_;
  std::string address_;
  BusSessionOptions options_;
  host::BusConnection& bus_;
  BusSharing& sharing_;

  // The members from here on are used on the session's thread only.
  host::BusMonitor monitor_;
  host::BusAttachment monitor_attachment_;
  host::SharedBus shared_;
  BusViews bus_views_;
  RobotStops stops_;
  std::optional<host::BusScan> scan_;
  std::optional<host::BusAttachment> scan_attachment_;
  ParameterEdits edits_;
  ChangeDelivery delivery_;
  sim::Scenario started_;  ///< what the robot was started with
  std::optional<DrivenRobot> robot_;
  std::uint64_t dropped_changes_ = 0;
  std::string started_with_;
  std::string stopped_by_;
  std::string failure_;
  bool has_failed_ = false;
  nlohmann::json gait_;  ///< of the last run
  std::string planned_recording_;
  std::string recording_;
  RobotRows rows_;
  DriverWatch driver_;
  bool are_parameters_new_ = true;
  bool is_session_new_ = true;
  Clock::time_point publish_at_{};
};

}  // namespace proleg::tools
