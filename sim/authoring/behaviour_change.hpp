#pragma once

// Changes of the behaviour of a draft: which actuation module moves which joints, with which parameters.

#include <string>
#include <vector>

#include "shared/gait/joint_mask.hpp"
#include "sim/authoring/draft.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Each call writes into the actuation file; the reader judges the result, such as the number of modules. slot: a used
/// slot of the scenario, which is the position of the module in the file. joints: kernel order. Throws InputError for a
/// slot, an algorithm, a parameter or a joint that does not exist.
class BehaviourChange {
 public:
  /// scenario: of the draft, before the change.
  BehaviourChange(const Scenario& scenario, DraftChange& change) : scenario_(scenario), change_(change) {}

  /// Adds a module behind the last one, with the default parameters of its algorithm.
  void add(const std::string& algorithm, JointMask joints);
  /// Adds a copy of a module behind it, which moves other joints: values of single joints stay behind.
  void duplicate(unsigned slot, JointMask joints);
  void remove(unsigned slot);
  /// The module gets another algorithm. It keeps the values of parameters that both have, in the range of the new one.
  void set_algorithm(unsigned slot, const std::string& algorithm);
  /// Values of single joints that the module no longer moves are removed.
  void set_joints(unsigned slot, JointMask joints);
  /// The start value of a parameter for joints of a module.
  struct Value {
    unsigned slot = 0;
    std::string parameter;
    JointMask joints;
    std::string text;  ///< a decimal number in the declared unit
  };
  /// Sets all of them. Of two for the same joint the later one holds.
  void set_values(const std::vector<Value>& values);
  void set_parameter(unsigned slot, const std::string& parameter, JointMask joints, const std::string& text) {
    set_values({{slot, parameter, joints, text}});
  }

 private:
  [[nodiscard]] const XmlText& xml() { return change_.xml(scenario_.actuation_file); }
  void apply(const TextPatch& patch) { change_.apply(scenario_.actuation_file, patch); }
  [[nodiscard]] ElementNumber module_of(unsigned slot);
  void set_start_values(Scenario& wanted, const Value& value);
  void check_joints(JointMask joints) const;
  void write_joints(ElementNumber module, JointMask joints);

  const Scenario& scenario_;
  DraftChange& change_;
};

/// The characters of <jointConfiguration>: one for each joint in the order of the robot's file.
[[nodiscard]] std::string joints_text(const RobotModel& robot, JointMask joints);

/// The kernel joint that a <parameter> of the actuation file is for; -1: for all joints of its module.
[[nodiscard]] int joint_of_parameter(const XmlText& xml, ElementNumber parameter, const RobotModel& robot);

}  // namespace proleg::sim
