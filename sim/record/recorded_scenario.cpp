#include "sim/record/recorded_scenario.hpp"

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/file_source.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::sim {

std::optional<Scenario> recorded_scenario(const Recording& recording, const Overrides& overrides) {
  SourceTexts files;
  for (const auto& [path, text] : recording.sources()) {
    files.add(path, text);
  }
  try {
    Scenario scenario = read_scenario(recording.run_value("scenario"), files, overrides);
    const bool fits = scenario.robot.links.size() == recording.links().size() &&
                      scenario.robot.joints.size() == recording.joints().size();
    return fits ? std::optional(std::move(scenario)) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace proleg::sim
