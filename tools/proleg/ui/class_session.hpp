#pragma once

// What a teacher sees and does in the page of a class (docs/page-interface.md, "A class").

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/proleg/ui/class_room.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

/// The way of a teacher's requests: STOP goes to the robots at once, operations with files have a thread of their own.
class ClassRouter final : public host::RobotSession {
 public:
  /// All must outlive the router.
  ClassRouter(ClassRoom& room, SessionRequests& files, SessionRequests& session)
      : room_(room), files_(files), session_(session) {}

  void operate(const host::OperationRequest& request) override;
  void stop(const host::StopRequest& request) override;
  void holder_changed(bool /*has_holder*/, bool /*is_away*/) override {}

 private:
  ClassRoom& room_;
  SessionRequests& files_;
  SessionRequests& session_;
};

class ClassSession final : private SessionThread {
 public:
  /// address: where learners join. room, requests, output: must outlive the session.
  ClassSession(ClassRoom& room, std::string address, SessionRequests& requests, host::SessionOutput& output);
  ~ClassSession() override;

  /// The names of its operations.
  [[nodiscard]] static std::vector<std::string> operations() {
    return {"class.message", "class.lock", "class.let_in", "class.restart", "class.remove"};
  }

 private:
  // SessionThread
  void serve() override;
  void fail(const std::string& /*why*/) override {}
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  nlohmann::json send_message(const nlohmann::json& arguments);
  nlohmann::json lock(const nlohmann::json& arguments);
  nlohmann::json let_in(const nlohmann::json& arguments);
  nlohmann::json restart(const nlohmann::json& arguments);
  nlohmann::json remove(const nlohmann::json& arguments);

  void count_recordings();
  void publish();

  ClassRoom& room_;
  const std::string address_;
  std::map<host::SeatNumber, unsigned> recordings_;
  Clock::time_point count_at_;
  nlohmann::json published_;
};

}  // namespace proleg::tools
