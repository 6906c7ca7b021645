#pragma once

// Modules of `proleg bus` that need `proleg recover`.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/hardware_loop/hardware_options.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

class BrokenModules {
 public:
  /// arguments: each NODE=KIND of --broken, with the node ids of the robot's file. Throws InputError. scenario must
  /// outlive this object.
  BrokenModules(const std::vector<std::string>& arguments, const sim::Scenario& scenario);

  /// The form NODE=KIND of --broken with its kinds, as --help shows it.
  [[nodiscard]] static std::string syntax();

  /// Gives modules the node ids of others. nodes: node ids by joint.
  void share_node_ids(std::vector<std::uint8_t>& nodes) const;
  /// Makes a native module that is broken; null if the module is not broken.
  [[nodiscard]] std::unique_ptr<sim::JointModule> make(const sim::ModuleParts& parts) const;
  /// Whether make() makes the module of a joint.
  [[nodiscard]] bool makes(unsigned joint) const {
    return faults_[joint].kind != Kind::none && faults_[joint].kind != Kind::duplicate;
  }

 private:
  enum class Kind : std::uint8_t { none, hangs, faults, silent, no_program, newer_settings, duplicate };
  struct Fault {
    Kind kind = Kind::none;
    unsigned other = 0;  ///< joint of the other module with the same node id
  };
  void parse(const std::string& argument);

  const sim::Scenario& scenario_;
  std::vector<Fault> faults_;  ///< faults by joint
};

}  // namespace proleg::tools
