#pragma once

#include "host/server/robot_session.hpp"

namespace proleg::tools {

/// Three sessions behind one page: a robot, its remote control, and recordings. Each operation goes to the one that its
/// name tells; STOP and the holder of control go to the robot, then to the remote control.
class SessionRouter final : public host::RobotSession {
 public:
  /// All must outlive the router.
  SessionRouter(host::RobotSession& recordings, host::RobotSession& remote, host::RobotSession& robot)
      : recordings_(recordings), remote_(remote), robot_(robot) {}

  void operate(const host::OperationRequest& request) override;
  void stop(const host::StopRequest& request) override;
  void holder_changed(bool has_holder, bool is_away) override;

 private:
  host::RobotSession& recordings_;
  host::RobotSession& remote_;
  host::RobotSession& robot_;
};

}  // namespace proleg::tools
