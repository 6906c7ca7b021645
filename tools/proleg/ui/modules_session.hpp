#pragma once

// What viewers do with modules on a table: jobs of our programs on a bus (docs/page-interface.md, Modules on the
// table). It runs in a thread of its own, beside the robot.

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/bus_sharing.hpp"
#include "tools/proleg/ui/module_files.hpp"
#include "tools/proleg/ui/module_job.hpp"
#include "tools/proleg/ui/module_plans.hpp"
#include "tools/proleg/ui/present_draft.hpp"
#include "tools/proleg/ui/session_base.hpp"
#include "tools/proleg/ui/table_bus.hpp"

namespace proleg::tools {

/// A bus that another session has open, with a robot.
struct RobotBus {
  std::string address;
  std::string description;
  const sim::Scenario& robot;
};

struct ModulesSessionOptions {
  std::filesystem::path folder;   ///< of the project
  std::optional<RobotBus> bus;    ///< nothing: viewers open one
  bool opens_any_address = true;  ///< else viewers open only adapters of this computer
  std::string refusal{};          ///< why viewers may do nothing here; empty: they may
};

class ModulesSession final : private SessionThread {
 public:
  /// draft, sharing, requests, output: must outlive the session.
  ModulesSession(ModulesSessionOptions options, const PresentDraft& draft, BusSharing& sharing,
                 SessionRequests& requests, host::SessionOutput& output);
  ~ModulesSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() {
    return {"modules.look", "modules.scan", "modules.examine", "modules.read", "modules.compare"};
  }

 private:
  /// A job whose end answers an operation, or nothing, and that no document shows.
  struct QuietJob {
    std::unique_ptr<ModuleJob> job;
    std::optional<host::RequestId> request;
    std::vector<std::string> then;  ///< words of a job that follows if this one succeeds
  };

  // SessionThread
  void serve() override;
  void fail(const std::string& why) override;
  void close() override;
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  using Handler = nlohmann::json (ModulesSession::*)(const host::OperationRequest&);
  nlohmann::json look(const host::OperationRequest& request);
  nlohmann::json open(const host::OperationRequest& request);
  nlohmann::json close_bus(const host::OperationRequest& request);
  nlohmann::json begin_planned(const host::OperationRequest& request);
  nlohmann::json examine(const host::OperationRequest& request);
  nlohmann::json read(const host::OperationRequest& request);
  nlohmann::json set(const host::OperationRequest& request);
  nlohmann::json assign(const host::OperationRequest& request);
  nlohmann::json answer(const host::OperationRequest& request);
  nlohmann::json cancel(const host::OperationRequest& request);

  [[nodiscard]] std::string address() const;
  /// The robot whose places can be given; null: there is none.
  [[nodiscard]] std::shared_ptr<const sim::Scenario> robot() const;
  /// Throws InputError for the address of a bus that viewers may not open.
  void require_openable(const std::string& bus) const;
  [[nodiscard]] nlohmann::json begin(ModuleJobPlan plan);
  [[nodiscard]] nlohmann::json begin(ModuleJobPlan plan, const std::string& bus);
  [[nodiscard]] std::unique_ptr<ModuleJob> make_job(ModuleJobPlan plan, const std::string& bus);
  nlohmann::json begin_quietly(const host::OperationRequest& request, ModuleJobPlan plan,
                               std::vector<std::string> then = {});
  /// Until the bus is free again of a quiet job, or of one that has just ended.
  void wait_for_quiet_job();
  void look_at_job();
  void look_at_quiet_job();
  void begin_unasked(ModuleJobPlan plan);
  void go_on_quietly(const QuietJob& before);
  void take_found(const nlohmann::json& result);
  void stop_at_once();
  void look_at_holder();
  void end_job(const std::string& by);
  void publish();
  void publish_job();
  [[nodiscard]] nlohmann::json robot_json() const;

  ModulesSessionOptions options_;
  const PresentDraft& draft_;
  BusSharing& sharing_;
  ModuleFiles files_;
  ModulePlans plans_;
  std::vector<std::string> offers_;
  std::unique_ptr<TableBus> table_;
  std::unique_ptr<ModuleJob> job_;  ///< that viewers see, also when it has ended
  std::optional<QuietJob> quiet_;
  unsigned last_job_ = 0;
  nlohmann::json found_;     ///< by the last scan
  bool is_watched_ = false;  ///< a viewer has looked
  std::uint64_t draft_revision_ = 0;
  DriverWatch driver_;
};

}  // namespace proleg::tools
