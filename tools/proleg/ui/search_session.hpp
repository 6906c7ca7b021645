#pragma once

// Searches for a gait as viewers make them: what can be searched for, starts and stops of `proleg optimise`, and what
// searches have found. It runs in a thread of its own, beside the robot.

#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/common/detached_program.hpp"
#include "tools/proleg/ui/command_sequence.hpp"
#include "tools/proleg/ui/present_draft.hpp"
#include "tools/proleg/ui/project_files.hpp"
#include "tools/proleg/ui/search_folder.hpp"
#include "tools/proleg/ui/search_results.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

struct SearchSessionOptions {
  std::filesystem::path folder;  ///< of the project
  /// `proleg optimise`; empty: the one beside this program.
  std::filesystem::path program = {};
  /// A search that does not begin in this time is not waited for any more.
  std::chrono::seconds longest_start = std::chrono::minutes(1);
  std::chrono::seconds longest_estimate = std::chrono::minutes(2);
};

class SearchSession final : private SessionThread {
 public:
  /// files, draft, requests, output: must outlive the session.
  SearchSession(SearchSessionOptions options, const ProjectFiles& files, const PresentDraft& draft,
                SessionRequests& requests, host::SessionOutput& output);
  ~SearchSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() {
    return {"search.refresh", "search.open",  "search.rows", "search.candidate",
            "search.motion",  "search.check", "search.read"};
  }

 private:
  /// A search that was started and has not begun.
  struct Beginning {
    host::RequestId request;
    std::string name;
    std::filesystem::path folder;
    DetachedProgram program;
    Clock::time_point until;
    bool is_new;  ///< its folder is removed if it does not begin
  };
  /// An estimate that goes on.
  struct Estimate {
    host::RequestId request = 0;
    std::filesystem::path folder;  ///< for its files, removed at the end
    std::unique_ptr<CommandSequence> program;
  };
  // SessionThread
  void serve() override;
  void fail(const std::string& why) override;
  void close() override;
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  using Handler = nlohmann::json (SearchSession::*)(const host::OperationRequest&);
  nlohmann::json refresh(const host::OperationRequest& request);
  nlohmann::json open(const host::OperationRequest& request);
  nlohmann::json rows(const host::OperationRequest& request);
  nlohmann::json candidate(const host::OperationRequest& request);
  nlohmann::json motion(const host::OperationRequest& request);
  nlohmann::json check(const host::OperationRequest& request);
  nlohmann::json read(const host::OperationRequest& request);
  nlohmann::json estimate(const host::OperationRequest& request);
  nlohmann::json start(const host::OperationRequest& request);
  nlohmann::json stop(const host::OperationRequest& request);
  nlohmann::json resume(const host::OperationRequest& request);

  void publish(const std::string& name, nlohmann::json document);
  void publish_searches();
  [[nodiscard]] std::shared_ptr<const sim::Scenario> draft() const;
  /// `proleg optimise` with these words, and with the algorithms of users that this program has.
  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& words) const;
  void begin(const host::OperationRequest& request, const std::string& name, const std::filesystem::path& folder,
             const std::vector<std::string>& words, bool is_new);
  /// Whether a search has begun, or has failed to.
  bool look_at(Beginning& beginning);
  void look_at_estimate();
  void end_estimate(const std::string& refusal);

  SearchSessionOptions options_;
  const ProjectFiles& files_;
  const PresentDraft& draft_;
  SearchFolder folder_;
  SearchResults results_;
  std::list<Beginning> beginnings_;
  std::list<DetachedProgram> running_;  ///< whose end must be taken note of
  std::optional<Estimate> estimate_;
  std::map<std::string, nlohmann::json> published_;
};

}  // namespace proleg::tools
