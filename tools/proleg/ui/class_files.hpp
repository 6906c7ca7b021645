#pragma once

// The files of a class: what a teacher hands out, and the recordings that a teacher collects. It runs in a thread of
// its own, beside the robots.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/proleg/ui/class_room.hpp"
#include "tools/proleg/ui/project_files.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

/// What was done to collect recordings.
struct CollectedRecordings {
  unsigned copied = 0;
  unsigned known = 0;    ///< they had been copied before
  unsigned running = 0;  ///< they grow, or were interrupted
};

/// Copies the finished recordings of a folder, and of the folders in it, into another folder, where they keep their
/// names. A recording that is there with as many bytes is not copied again. Throws FileError.
[[nodiscard]] CollectedRecordings collect_recordings(const std::filesystem::path& from,
                                                     const std::filesystem::path& into);

class ClassFiles final : private SessionThread {
 public:
  /// room, projects (of the teacher), requests, output: must outlive the session.
  ClassFiles(ClassRoom& room, const ProjectFiles& projects, SessionRequests& requests, host::SessionOutput& output);
  ~ClassFiles() override;

  /// The names of its operations. Those of a class are free: who has the teacher's token is a teacher.
  [[nodiscard]] static std::vector<std::string> operations() {
    return {"class.projects", "class.hand_out", "class.collect"};
  }

 private:
  // SessionThread
  void serve() override;
  void fail(const std::string& /*why*/) override {}
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  nlohmann::json list_projects(const nlohmann::json& arguments);
  nlohmann::json hand_out(const nlohmann::json& arguments);
  nlohmann::json collect(const nlohmann::json& arguments);

  ClassRoom& room_;
  const ProjectFiles& projects_;
};

}  // namespace proleg::tools
