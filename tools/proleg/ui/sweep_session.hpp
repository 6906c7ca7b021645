#pragma once

// Sweeps as viewers make them: what can be swept, starts and stops of `proleg sweep`, and what sweeps have found. It
// runs in a thread of its own, beside the robot.

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/ui/begun_programs.hpp"
#include "tools/proleg/ui/json_program.hpp"
#include "tools/proleg/ui/present_draft.hpp"
#include "tools/proleg/ui/session_base.hpp"
#include "tools/proleg/ui/sweep_folder.hpp"
#include "tools/proleg/ui/sweep_results.hpp"

namespace proleg::tools {

struct SweepSessionOptions {
  std::filesystem::path folder;  ///< of the project
  /// The folder of proleg-sweep and proleg-simulate; empty: that of this program.
  std::filesystem::path programs = {};
  std::chrono::seconds longest_start = std::chrono::minutes(1);
  std::chrono::seconds longest_estimate = std::chrono::minutes(10);
};

class SweepSession final : private SessionThread {
 public:
  /// draft, requests, output: must outlive the session.
  SweepSession(SweepSessionOptions options, ProgramShare& share, const PresentDraft& draft, SessionRequests& requests,
               host::SessionOutput& output);
  ~SweepSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() {
    return {"sweep.refresh", "sweep.open", "sweep.cells", "sweep.cell", "sweep.motion", "sweep.check"};
  }

 private:
  /// An estimate that goes on.
  struct Estimate {
    host::RequestId request = 0;
    std::unique_ptr<JsonProgram> program;
    std::uint64_t runs = 0;
    std::uint32_t workers = 1;
  };

  // SessionThread
  void serve() override;
  void fail(const std::string& why) override;
  void close() override;
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  using Handler = nlohmann::json (SweepSession::*)(const host::OperationRequest&);
  nlohmann::json refresh(const host::OperationRequest& request);
  nlohmann::json open(const host::OperationRequest& request);
  nlohmann::json cells(const host::OperationRequest& request);
  nlohmann::json cell(const host::OperationRequest& request);
  nlohmann::json motion(const host::OperationRequest& request);
  nlohmann::json check(const host::OperationRequest& request);
  nlohmann::json estimate(const host::OperationRequest& request);
  nlohmann::json start(const host::OperationRequest& request);
  nlohmann::json stop(const host::OperationRequest& request);
  nlohmann::json resume(const host::OperationRequest& request);

  [[nodiscard]] std::shared_ptr<const sim::Scenario> draft() const;
  [[nodiscard]] std::vector<std::string> command(const std::string& program,
                                                 const std::vector<std::string>& words) const;
  void look_at_estimate();
  void end_estimate(const std::string& refusal);

  SweepSessionOptions options_;
  const PresentDraft& draft_;
  SweepFolder folder_;
  SweepResults results_;
  BegunPrograms begun_;
  std::optional<Estimate> estimate_;
  nlohmann::json published_;
};

}  // namespace proleg::tools
