#include "sim/record/recorded_scenario.hpp"

#include <sys/utsname.h>

#include <fstream>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/sources.hpp"

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

std::string user_algorithms_text(const KernelConfiguration& kernel) {
  std::string text;
  for (const Slot& slot : kernel.slots) {
    if (slot.algorithm != nullptr && is_user_algorithm(slot.algorithm->declaration().id)) {
      const Declaration& declaration = slot.algorithm->declaration();
      text += (text.empty() ? "" : ", ") + std::string(declaration.name) + ' ' + hexadecimal(declaration.sources, 8);
    }
  }
  return text;
}

std::string processor_text() {
  utsname system{};
  std::string text = uname(&system) == 0 ? static_cast<const char*>(system.machine) : "unknown";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (const std::size_t colon = line.find(':'); line.starts_with("model name") && colon != std::string::npos) {
      text += ", " + one_line(trimmed(std::string_view(line).substr(colon + 1)));
      break;
    }
  }
  return text;
}

OverrideWords recorded_overrides(const Recording& recording) {
  OverrideWords words;
  for (const OverrideDeclaration& declaration : override_declarations()) {
    if (const std::string word = recording.run_value("override_" + std::string(declaration.name)); !word.empty()) {
      words.*declaration.word = word;
    }
  }
  return words;
}

std::vector<std::string> other_program(const Recording& recording, const std::string& build_id) {
  std::vector<std::string> sentences;
  if (const std::string recorded = recording.run_value("build_id"); recorded != build_id) {
    sentences.push_back("the recording was made by " + recorded + ", this program is " + build_id);
  }
  const std::string recorded = recording.run_value("processor");
  if (recording.run_value("engine") == name_of(PhysicsEngine::reduced)) {
    return sentences;
  }
  if (recorded.empty()) {
    sentences.emplace_back("the recording does not name its processor");
  } else if (const std::string present = processor_text(); recorded != present) {
    sentences.push_back("the recording was made on " + recorded + ", this computer is " + present);
  }
  return sentences;
}

std::vector<std::string> other_algorithms(const Recording& recording) {
  std::vector<std::string> sentences;
  const std::string core = recording.run_value("core_fingerprint");
  if (core != hexadecimal(core_fingerprint, 8)) {
    sentences.push_back("the recording was made with core " + core + ", this program has core " +
                        hexadecimal(core_fingerprint, 8));
  }
  const std::string recorded = recording.run_value("user_algorithms");
  std::string_view rest = recorded;
  while (!rest.empty()) {
    const std::string_view item = trimmed(rest.substr(0, rest.find(',')));
    rest.remove_prefix(rest.find(',') == std::string_view::npos ? rest.size() : rest.find(',') + 1);
    const std::string_view name = item.substr(0, item.find(' '));
    const ActuationModule* const algorithm = find_algorithm(name);
    if (algorithm == nullptr || !is_user_algorithm(algorithm->declaration().id)) {
      continue;
    }
    const std::string present = std::string(name) + ' ' + hexadecimal(algorithm->declaration().sources, 8);
    if (item != present) {
      sentences.push_back("the recording was made with the user's algorithm " + std::string(item) +
                          ", this program has loaded " + present);
    }
  }
  return sentences;
}

}  // namespace proleg::sim
