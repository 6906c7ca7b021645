#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/robot_control/plugin_library.hpp"

namespace proleg::host {

/// Runs calls one after the other in a thread of its own, and abandons a call that does not return.
class CallThread {
 public:
  CallThread();
  /// Does not wait: the thread ends by itself, also after an abandoned call, if that ever returns.
  ~CallThread();
  CallThread(const CallThread&) = delete;
  CallThread& operator=(const CallThread&) = delete;

  /// Runs a call and waits for its end. Returns false if it has not ended after the timeout, and then for all later
  /// calls, which do not run. The call must own what it uses: it may still run. It must not throw.
  [[nodiscard]] bool run(std::function<void()> call, std::chrono::microseconds timeout);
  /// Whether a call was abandoned because it did not return in time.
  [[nodiscard]] bool is_lost() const { return is_lost_; }

 private:
  struct Shared;

  std::shared_ptr<Shared> shared_;
  bool is_lost_ = false;
};

/// A <parameter> of the robot's file.
struct RobotControlParameter {
  std::string name;
  std::string value;
  std::uint32_t joint = PROLEG_ALL_JOINTS;  ///< index in kernel order
  std::uint32_t line = 0;
};

struct RobotControlJoint {
  std::string name;
  double lower_limit_deg = -90.0;
  double upper_limit_deg = 90.0;
  double max_speed_deg_s = 360.0;
};

/// The description of the robot for a plug-in.
struct RobotControlSetup {
  std::string file;  ///< name of the robot's file, for errors
  int line = 0;      ///< line of <robot_control>, for errors
  std::uint32_t tick_us = 10'000;
  std::vector<RobotControlJoint> joints;  ///< joints in kernel order
  std::vector<RobotControlParameter> parameters;
};

/// The checked description of the robot by a plug-in.
struct RobotControlDescription {
  unsigned sensor_modules = 0;
  unsigned sensors_per_module = 0;
  std::string topology;
  std::vector<double> lower_limit_deg;  ///< lower limit of each joint, -360 to 0
  std::vector<double> upper_limit_deg;  ///< upper limit of each joint, 0 to 360
};

/// A robot that a plug-in drives: attached when this object is made, detached when it ends (thesis, appendix A.4). Each
/// function calls the function of the plug-in with the same name (robot_control.h) in a thread of its own, waits for
/// it, and checks what it returns. All functions but the destructor throw RobotControlError.
class RobotControl {
 public:
  /// Durations for which the host waits: for a function without a timeout of its own, and beyond the timeout of the
  /// others.
  struct Patience {
    std::chrono::milliseconds connect{30'000};
    std::chrono::milliseconds request{1000};
    std::chrono::milliseconds grace{2000};  ///< time beyond a timeout after which the plug-in is abandoned
  };
  using Show = std::function<void(const std::string&)>;

  /// show: receives the lines that the plug-in shows; called from another thread. Throws RobotFileError if
  /// the plug-in rejects the parameters.
  RobotControl(Plugin plugin, RobotControlSetup setup, Show show, Patience patience);
  RobotControl(Plugin plugin, RobotControlSetup setup, Show show)
      : RobotControl(std::move(plugin), std::move(setup), std::move(show), Patience()) {}
  ~RobotControl();
  RobotControl(const RobotControl&) = delete;
  RobotControl& operator=(const RobotControl&) = delete;

  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] const RobotControlSetup& setup() const;
  [[nodiscard]] const RobotControlDescription& description() const { return description_; }
  /// Whether a function of the plug-in did not return; no other function is called any more.
  [[nodiscard]] bool is_lost() const { return thread_.is_lost(); }

  void connect();
  void disconnect();
  void enable_servos(bool on);
  void send_command(const std::string& command, std::span<const double> values, std::uint32_t destination);
  void send_command_by_value(const std::string& command, double value);
  /// Sends an angle in degrees for each joint.
  void send_goal_positions(std::span<const double> degrees) {
    send_command("goal_position", degrees, PROLEG_ALL_JOINTS);
  }
  [[nodiscard]] std::vector<std::uint8_t> request_all_information();
  /// Requests one number for each joint (for "contact": for each sensor), in the range of the kind.
  [[nodiscard]] std::vector<double> request_information(const std::string& kind);
  void test();
  void reset_command_buffer();

 private:
  struct Session;
  struct Call;

  void open();
  void describe();
  /// Runs a function of the plug-in. what: name of the function, for errors.
  void call(const std::string& what, std::chrono::milliseconds timeout,
            const std::function<int(Session&, Call&)>& function);
  [[nodiscard]] bool try_call(std::chrono::milliseconds timeout, const std::shared_ptr<Call>& call,
                              const std::function<int(Session&, Call&)>& function);
  [[noreturn]] void fail(const std::string& text) const;

  Patience patience_;
  std::shared_ptr<Session> session_;
  CallThread thread_;
  RobotControlDescription description_;
};

}  // namespace proleg::host
