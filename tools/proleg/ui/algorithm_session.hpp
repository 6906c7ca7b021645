#pragma once

// The algorithms that viewers write: their sources in the folder of the project, their builds, and their proof. A build
// that passes is loaded into this program. It runs in a thread of its own, beside the robot.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/ui/algorithm_folders.hpp"
#include "tools/proleg/ui/command_sequence.hpp"
#include "tools/proleg/ui/image_build.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

struct AlgorithmSessionOptions {
  std::filesystem::path folder;  ///< of the project
  std::string refusal;           ///< why viewers may not write code; empty: they may
  /// Called in the session's thread when another algorithm, or another version of one, can be used.
  std::function<void()> on_loaded = [] {};
  std::chrono::seconds longest_build = std::chrono::minutes(10);
  std::chrono::seconds longest_check = std::chrono::hours(1);  ///< also of an image
  /// `proleg verify`; empty: the one beside this program.
  std::filesystem::path verifier = {};
};

class AlgorithmSession final : private SessionThread {
 public:
  /// The requests and the output must outlive the session.
  AlgorithmSession(AlgorithmSessionOptions options, SessionRequests& requests, host::SessionOutput& output);
  ~AlgorithmSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() { return {"algorithm.refresh", "algorithm.read"}; }

 private:
  enum class Work : std::uint8_t { build, proof, image };
  /// What goes on.
  struct Job {
    Work work;
    std::vector<AlgorithmFolder> algorithms;  ///< one, but for an image
    std::string version;                      ///< of the source of the first one
    std::unique_ptr<CommandSequence> programs;
  };
  struct Upload {
    host::ClientId client = 0;
    std::string folder;
    std::uint32_t parts = 0;
    std::string text;
  };

  // SessionThread
  void serve() override;
  void fail(const std::string& why) override;
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  void require_no_job() const;
  void begin(Work work, std::vector<AlgorithmFolder> algorithms, const std::vector<std::vector<std::string>>& commands);
  void look_at_job();
  /// error: why it did not pass; empty: it passed.
  void finish(const std::string& state, const std::string& error);
  /// Loads what was built. Returns why it cannot be loaded; empty: it is.
  [[nodiscard]] std::string load(const AlgorithmFolder& algorithm);
  void publish_job(const std::string& state, const std::string& error);
  void publish_image(const std::string& state, const std::string& error);
  void finish_image(int status);
  void publish_folders();
  void publish(const std::string& name, nlohmann::json document);
  [[nodiscard]] AlgorithmFolder folder_of(const nlohmann::json& arguments) const;

  using Handler = nlohmann::json (AlgorithmSession::*)(const host::OperationRequest&);
  nlohmann::json refresh(const host::OperationRequest& request);
  nlohmann::json read(const host::OperationRequest& request);
  nlohmann::json create(const host::OperationRequest& request);
  nlohmann::json save(const host::OperationRequest& request);
  nlohmann::json build(const host::OperationRequest& request);
  nlohmann::json check(const host::OperationRequest& request);
  nlohmann::json image(const host::OperationRequest& request);
  nlohmann::json cancel(const host::OperationRequest& request);

  AlgorithmSessionOptions options_;
  AlgorithmFolders folders_;
  ImageBuild image_build_;
  std::optional<Job> job_;
  std::optional<Upload> upload_;  ///< a source that comes in several messages
  nlohmann::json built_image_;    ///< the last one
  std::map<std::string, nlohmann::json> published_;
};

}  // namespace proleg::tools
