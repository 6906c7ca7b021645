#pragma once

#include "host/server/robot_session.hpp"

namespace proleg::tools {

/// Two sessions behind one page: a robot, and recordings. Operations go by their names; STOP and the holder of control
/// go to the robot.
class SessionRouter final : public host::RobotSession {
 public:
  /// Both must outlive the router.
  SessionRouter(host::RobotSession& recordings, host::RobotSession& robot) : recordings_(recordings), robot_(robot) {}

  void operate(const host::OperationRequest& request) override;
  void stop(const host::StopRequest& request) override;
  void holder_changed(bool has_holder, bool is_away) override;

 private:
  host::RobotSession& recordings_;
  host::RobotSession& robot_;
};

}  // namespace proleg::tools
