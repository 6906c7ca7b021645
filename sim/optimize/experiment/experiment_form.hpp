#pragma once

// An experiment as a person fills it in: its numbers are texts, as they were typed. It becomes the text of an
// experiment file, which read_experiment() judges; and an experiment file becomes a form again. Everything that
// docs/optimisation-files.md has can be in a form.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shared/gait/joint_mask.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::optimize {

/// A parameter that a search chooses. An empty text stands for the default, or for what the reader refuses.
struct ParameterForm {
  unsigned slot = 0;                ///< of the actuation module
  std::string parameter;            ///< its name
  std::optional<JointMask> joints;  ///< kernel order; nothing: all that the module moves
  bool is_same = false;             ///< one value for all of them; else each has its own
  /// The range: numbers in the parameter's unit; one, or one for each joint in the order of the robot's file.
  std::string lower;
  std::string upper;
  std::string step;
  bool with_lower = true;  ///< whether the limit is one of the values
  bool with_upper = true;
  std::optional<std::string> set;  ///< the values, separated by blanks, in place of the range
};

struct TermForm {
  std::string measure;
  std::string weight;
};

struct ObjectiveForm {
  std::string name;
  std::string goal;  ///< "maximise", "minimise" or nothing
  std::string failed;
  std::vector<TermForm> terms;
};

struct AxisForm {
  std::string measure;
  std::string lowest;
  std::string highest;
  std::string cells;  ///< empty in a map with centroids
};

struct TrialsForm {
  std::string count;
  std::string aggregate;
  std::string random_numbers;
  std::string friction;
  std::string mass;
  std::string servo_gain;
  std::string latency;  ///< ms
  std::string contact_noise;
};

struct ConfirmationForm {
  std::string candidates;
  std::string runs;
};

struct RacingForm {
  std::string after;
  std::string keep;
};

struct ExperimentForm {
  std::string method;                           ///< a tag of method_tags
  std::string algorithm;                        ///< of "pagmo"
  std::map<std::string, std::string> settings;  ///< by the tags of MethodSetting
  std::vector<ParameterForm> parameters;
  std::string heading;
  std::vector<ObjectiveForm> objectives;  ///< none: the distance
  std::vector<AxisForm> axes;             ///< of a method with a map
  std::string evaluations;
  std::string seed;
  bool reuse = true;
  std::optional<TrialsForm> trials;
  std::optional<ConfirmationForm> confirmation;
  std::optional<RacingForm> racing;
};

/// The text of an experiment file, and what each line of it is made of.
struct ExperimentText {
  std::string text;
  std::vector<std::string> fields;  ///< of line i + 1: "parameters.0.upper", "settings.popsize"; empty: of none
};

/// simulation: the path of the scenario as the file names it. Throws InputError for a method without a section, and for
/// a slot that is not used; the reader judges all else.
[[nodiscard]] ExperimentText experiment_text(const ExperimentForm& form, const sim::Scenario& scenario,
                                             const std::string& simulation);

/// Reads an experiment file for a scenario, which takes the place of the one that the file names. Throws InputError if
/// it is no experiment file, or if its modules or joints are not those of the scenario.
[[nodiscard]] ExperimentForm read_experiment_form(const std::filesystem::path& path, sim::FileSource& files,
                                                  const sim::Scenario& scenario);

}  // namespace proleg::optimize
