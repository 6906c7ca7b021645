#pragma once

// What operations on modules become: programs of ours, with words that were checked. All functions throw InputError for
// an argument that is missing or wrong.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host/server/robot_session.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/module_files.hpp"
#include "tools/proleg/ui/module_job.hpp"

namespace proleg::tools {

/// A word for a program that cannot be taken for an option.
[[nodiscard]] std::string word_in(const nlohmann::json& arguments, const char* name, const char* expected);

/// A job of a kind, for the viewer of the request.
[[nodiscard]] ModuleJobPlan plan_of(std::string kind, std::vector<std::string> words,
                                    const host::OperationRequest& request,
                                    ModuleJobPlan::Output output = ModuleJobPlan::Output::object);
/// A look which modules there are, that nobody has asked for.
[[nodiscard]] ModuleJobPlan plan_of_look();
/// The settings of a module go into its flash. node: as `modules.set` has it.
[[nodiscard]] std::vector<std::string> store_words(const nlohmann::json& arguments);

class ModulePlans {
 public:
  using Request = host::OperationRequest;

  /// files: must outlive this.
  explicit ModulePlans(const ModuleFiles& files) : files_(files) {}

  // Each is the operation of this name.
  [[nodiscard]] ModuleJobPlan scan(const Request& request) const;
  [[nodiscard]] ModuleJobPlan examine(const Request& request) const;
  [[nodiscard]] ModuleJobPlan read(const Request& request) const;
  [[nodiscard]] ModuleJobPlan set(const Request& request) const;
  [[nodiscard]] ModuleJobPlan save(const Request& request) const;
  [[nodiscard]] ModuleJobPlan compare(const Request& request) const;
  [[nodiscard]] ModuleJobPlan load(const Request& request) const;
  [[nodiscard]] ModuleJobPlan assign(const Request& request, const sim::Scenario& robot) const;
  [[nodiscard]] ModuleJobPlan calibrate(const Request& request) const;
  [[nodiscard]] ModuleJobPlan flash(const Request& request) const;
  [[nodiscard]] ModuleJobPlan recover(const Request& request) const;

 private:
  const ModuleFiles& files_;
};

}  // namespace proleg::tools
