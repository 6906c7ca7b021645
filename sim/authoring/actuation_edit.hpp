#pragma once

// Writes start values of parameters into the actuation file that they come from. What a person wrote stays: an edit
// replaces the value of a tag, or adds a tag behind a similar one.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/gait/joint_mask.hpp"
#include "sim/authoring/xml_text.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// A change of one line. Edits do not depend on each other.
struct ActuationEdit {
  unsigned slot = 0;
  unsigned number = 0;  ///< of the parameter in the declaration
  JointMask joints;     ///< whose start value it changes; kernel order
  TextPatch patch;
  int line = 0;                              ///< line that the edit changes, or after which it adds one
  std::optional<std::string> old_line = {};  ///< nothing: the line is new
  std::string new_line = {};                 ///< with this edit alone
};

/// The text of the scenario's actuation file.
[[nodiscard]] const SourceFile& actuation_source(const Scenario& scenario);

/// The edits of the actuation file of `file` that give it the start values of `wanted`, in the order of slot, parameter
/// and place. `wanted` is `file` with other start values. A value for all joints of a module changes if they all want
/// one other value; else each joint that wants another value gets a tag of its own.
[[nodiscard]] std::vector<ActuationEdit> actuation_edits(const Scenario& file, const Scenario& wanted);

/// The edits in the order in which their patches can be applied one after the other: the last place first.
[[nodiscard]] std::vector<const ActuationEdit*> from_the_end(std::span<const ActuationEdit> edits);

/// The text with the edits.
[[nodiscard]] std::string edited(std::string text, std::span<const ActuationEdit> edits);

/// The scenario as it is read again from its sources, with another text of the actuation file. Throws InputError.
[[nodiscard]] Scenario with_actuation_text(const Scenario& scenario, const std::string& text);

}  // namespace proleg::sim
