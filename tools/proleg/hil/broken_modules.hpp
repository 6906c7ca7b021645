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
  /// words: of --broken, NODE=KIND each, with the node ids of the robot's file. Throws InputError. scenario: must
  /// outlive this object.
  BrokenModules(const std::vector<std::string>& words, const sim::Scenario& scenario);

  /// The words of --broken for NODE=KIND, as --help shows them.
  [[nodiscard]] static std::string syntax();

  /// Gives modules the node ids of others. nodes: by joint.
  void share_node_ids(std::vector<std::uint8_t>& nodes) const;
  /// A native module that is broken; null for one that is not.
  [[nodiscard]] std::unique_ptr<sim::JointModule> make(const sim::ModuleParts& parts) const;
  /// Whether make() makes it.
  [[nodiscard]] bool makes(unsigned joint) const {
    return faults_[joint].kind != Kind::none && faults_[joint].kind != Kind::duplicate;
  }

 private:
  enum class Kind : std::uint8_t { none, hangs, faults, no_program, newer_settings, duplicate };
  struct Fault {
    Kind kind = Kind::none;
    unsigned other = 0;  ///< of duplicate: the joint of the other module
  };
  void parse(const std::string& word);

  const sim::Scenario& scenario_;
  std::vector<Fault> faults_;  ///< by joint
};

}  // namespace proleg::tools
