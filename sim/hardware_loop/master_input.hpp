#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/computer/master/master.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// A scenario in the form that the master takes. Simulated and real robots are set up with it.
class MasterInput {
 public:
  /// scenario: must outlive this, and its settings and limits must not change. Throws InputError if an algorithm reads
  /// a sensor that modules do not have.
  explicit MasterInput(const Scenario& scenario);
  MasterInput(const MasterInput&) = delete;
  MasterInput& operator=(const MasterInput&) = delete;

  canopen::RobotSetup setup;
  std::vector<Change> changes;         ///< those of the scenario; the master decides and drops them
  std::vector<std::uint32_t> serials;  ///< from the robot's file; 0: any

 private:
  std::vector<std::uint8_t> nodes_;
};

/// "node 3 (J3)", or "node 3" if the scenario does not have it: for messages.
[[nodiscard]] std::string name_of_node(const Scenario& scenario, std::uint8_t node);

}  // namespace proleg::sim
