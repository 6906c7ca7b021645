#include "sim/record/recorded_scenario.hpp"

#include <filesystem>
#include <map>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::sim {
namespace {

class RecordedFiles final : public FileSource {
 public:
  explicit RecordedFiles(const Recording& recording) {
    for (const auto& [path, text] : recording.sources()) {
      texts_.emplace(std::filesystem::path(path).lexically_normal().string(), text);
    }
  }
  [[nodiscard]] std::optional<std::string> read(const std::filesystem::path& path) override {
    const auto found = texts_.find(path.lexically_normal().string());
    return found == texts_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::map<std::string, std::string> texts_;
};

}  // namespace

std::optional<Scenario> recorded_scenario(const Recording& recording) {
  RecordedFiles files(recording);
  try {
    Scenario scenario = read_scenario(recording.run_value("scenario"), files);
    const bool fits = scenario.robot.links.size() == recording.links().size() &&
                      scenario.robot.joints.size() == recording.joints().size();
    return fits ? std::optional(std::move(scenario)) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace proleg::sim
