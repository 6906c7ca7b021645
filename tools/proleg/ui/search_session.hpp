#pragma once

// Searches for a gait as viewers make them: what can be searched for, starts and stops of `proleg optimise`, and what
// searches have found. It runs in a thread of its own, beside the robot.

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/ui/begun_programs.hpp"
#include "tools/proleg/ui/json_program.hpp"
#include "tools/proleg/ui/present_draft.hpp"
#include "tools/proleg/ui/project_files.hpp"
#include "tools/proleg/ui/search_folder.hpp"
#include "tools/proleg/ui/search_results.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

struct SearchSessionOptions {
  std::filesystem::path folder;  ///< of the project
  /// The folder of proleg-optimise and proleg-confirm; empty: that of this program.
  std::filesystem::path programs = {};
  /// A search that does not begin in this time is not waited for any more.
  std::chrono::seconds longest_start = std::chrono::minutes(1);
  std::chrono::seconds longest_job = std::chrono::minutes(10);  ///< of an estimate or a confirmation
};

class SearchSession final : private SessionThread {
 public:
  /// share, files, draft, requests, output: must outlive the session.
  SearchSession(SearchSessionOptions options, ProgramShare& share, const ProjectFiles& files, const PresentDraft& draft,
                SessionRequests& requests, host::SessionOutput& output);
  ~SearchSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() {
    return {"search.refresh", "search.open",  "search.rows", "search.candidate",
            "search.motion",  "search.check", "search.read", "search.adaptations"};
  }

 private:
  /// An estimate or a confirmation that goes on.
  struct Job {
    host::RequestId request = 0;
    std::unique_ptr<JsonProgram> program;
    std::vector<const char*> members;  ///< of the object that it prints: those of the answer
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
  nlohmann::json adaptations(const host::OperationRequest& request);
  nlohmann::json motion(const host::OperationRequest& request);
  nlohmann::json check(const host::OperationRequest& request);
  nlohmann::json read(const host::OperationRequest& request);
  nlohmann::json estimate(const host::OperationRequest& request);
  nlohmann::json confirm(const host::OperationRequest& request);
  nlohmann::json start(const host::OperationRequest& request);
  nlohmann::json stop(const host::OperationRequest& request);
  nlohmann::json resume(const host::OperationRequest& request);

  void publish(const std::string& name, nlohmann::json document);
  /// The options of `proleg optimise` that a start and an estimate have.
  [[nodiscard]] std::vector<std::string> options_in(const nlohmann::json& arguments) const;
  void read_searches();
  void publish_searches();
  [[nodiscard]] std::shared_ptr<const sim::Scenario> draft() const;
  /// One of our programs with these words, and with the algorithms of users that this program has.
  [[nodiscard]] std::vector<std::string> command(const std::string& program,
                                                 const std::vector<std::string>& words) const;
  nlohmann::json begin_job(const host::OperationRequest& request, std::unique_ptr<JsonProgram> program,
                           const std::vector<std::string>& words, std::vector<const char*> members);
  void look_at_job();
  void end_job(const std::string& refusal);

  SearchSessionOptions options_;
  const ProjectFiles& files_;
  const PresentDraft& draft_;
  SearchFolder folder_;
  SearchResults results_;
  BegunPrograms begun_;
  std::optional<Job> job_;
  std::map<std::string, nlohmann::json> published_;
  bool are_read_ = false;       ///< all searches that there were at the start
  bool is_list_shown_ = false;  ///< a page has asked for the list
};

}  // namespace proleg::tools
