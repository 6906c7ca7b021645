#include "tools/proleg/ui/actuation_file.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json entries_json(const sim::Scenario& file, std::span<const sim::ActuationEdit> edits) {
  json entries = json::array();
  for (const sim::ActuationEdit& edit : edits) {
    json joints = json::array();
    for (const unsigned joint : edit.joints) {
      joints.push_back(joint);
    }
    const Declaration& declaration = file.kernel.slots[edit.slot].algorithm->declaration();
    entries.push_back({{"file", one_line(file.actuation_file)},
                       {"line", edit.line},
                       {"old", edit.old_line ? json(*edit.old_line) : json()},
                       {"new", edit.new_line},
                       {"slot", edit.slot + 1},
                       {"name", declaration.parameters[edit.number].name},
                       {"joints", std::move(joints)}});
  }
  return entries;
}

}  // namespace

json file_diff_json(const sim::Scenario& file, std::span<const sim::ActuationEdit> edits) {
  json entries = entries_json(file, edits);
  std::string hash = sha256_hex(entries.dump());
  return {{"diff", std::move(hash)}, {"entries", std::move(entries)}, {"is_shipped", is_shipped(file.actuation_file)}};
}

std::vector<sim::ActuationEdit> chosen_edits(const sim::Scenario& file, std::span<const sim::ActuationEdit> edits,
                                             const json& arguments) {
  const auto diff = argument<std::string>(arguments, "diff", "the name of a list of differences");
  const auto numbers = argument<std::vector<std::int64_t>>(arguments, "entries", "positions in the list");
  if (diff != file_diff_json(file, edits)["diff"].get<std::string>()) {
    throw InputError("file.apply", 0, "an older list of differences", "the present one; ask for file.diff again");
  }
  std::vector<bool> is_chosen(edits.size());
  for (const std::int64_t number : numbers.value_or(std::vector<std::int64_t>{})) {
    const auto position = static_cast<std::size_t>(number);
    if (number < 0 || position >= edits.size() || is_chosen[position]) {
      throw InputError("entries", 0, std::to_string(number),
                       "numbers from 0 on, below " + std::to_string(edits.size()) + ", each once");
    }
    is_chosen[position] = true;
  }
  std::vector<sim::ActuationEdit> chosen;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    if (is_chosen[i]) {
      chosen.push_back(edits[i]);
    }
  }
  if (chosen.empty()) {
    throw InputError("entries", 0, "none", "at least one");
  }
  return chosen;
}

sim::Scenario write_actuation(const sim::Scenario& file, std::span<const sim::ActuationEdit> edits) {
  const sim::SourceFile& source = sim::actuation_source(file);
  if (is_shipped(source.path)) {
    throw InputError(source.path, 0, "a file that ships with Proleg, which stays as it is",
                     "a copy of your own: Save as");
  }
  sim::DiskFiles disk;
  if (disk.read(source.path) != source.text) {
    throw InputError(source.path, 0, "a file that has changed since this program read it",
                     "the same file; start `proleg ui` again");
  }
  const std::string text = sim::edited(source.text, edits);
  sim::Scenario again = sim::with_actuation_text(file, text);
  const PlannedOutput output{"file.apply", source.path, "actuation file",
                             [](const std::filesystem::path&) { return true; }, true};
  check_outputs(std::span(&output, 1));
  write_file(source.path, text);
  return again;
}

sim::Scenario write_copy(const sim::Scenario& file, std::span<const sim::ActuationEdit> edits, const fs::path& folder) {
  std::vector<sim::SourceFile> sources = file.sources;
  for (sim::SourceFile& source : sources) {
    if (source.path == file.actuation_file) {
      source.text = sim::edited(source.text, edits);
    }
  }
  const std::map<std::string, std::string> names = copy_sources(sources, folder);
  sim::DiskFiles disk;
  sim::Scenario copy = sim::read_scenario(names.at(sim::name_of(file.path)), disk, file.overrides);
  copy.moves = file.moves;  // of the command line, as the overrides
  return copy;
}

}  // namespace proleg::tools
