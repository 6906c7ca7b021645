#include "host/flash/module_fault.hpp"

#include <algorithm>

#include "host/flash/image_file.hpp"

namespace proleg::host {
namespace {

namespace flag = broadcast::module_flag;

constexpr std::string_view flash_bare = "flash it with a probe: 'proleg flash --bare'";

class Diagnosis {
 public:
  Diagnosis(const FlashCandidate& module, std::span<const FlashCandidate> all, const RecoveryMeans& means)
      : module_(module), program_(module.program), all_(all), means_(means) {}

  std::vector<ModuleFault> run() {
    if (!program_.has_answered) {
      add(ModuleFaultKind::no_update_protocol,
          "was found on the bus, but no answer to the requests for its program was received: frames are lost, or its "
          "program is older than updates over the bus",
          {Remedy::by_hand, "try again, and look with 'proleg doctor' whether frames are lost; if none are, " +
                                std::string(flash_bare)});
    } else {
      examine_program();
    }
    examine_node_id();
    if (program_.is(flag::has_newer_settings)) {
      add(ModuleFaultKind::newer_settings,
          "its settings are those of a later program, of which it uses only the node id", remedy_for_settings());
    }
    return std::move(faults_);
  }

 private:
  struct Action {
    Remedy remedy;
    std::string text;
  };

  void add(ModuleFaultKind kind, std::string text, Action action) {
    faults_.push_back({kind, std::move(text), action.remedy, std::move(action.text)});
  }
  [[nodiscard]] std::string program_name() const {
    return program_.image ? "its program " + version_text(*program_.image) : "its program";
  }

  void examine_program() {
    const bool runs = program_.is(flag::runs_program);
    if (!program_.is(flag::has_bootloader)) {
      add(ModuleFaultKind::no_bootloader, "has no bootloader", {Remedy::by_hand, std::string(flash_bare)});
    } else if (!program_.is(flag::has_image)) {
      add(ModuleFaultKind::no_program, "has no program", another_program());
    } else if (!runs && program_.is(flag::starts_badly)) {
      add(ModuleFaultKind::starts_badly, program_name() + " stops just after its start, again and again",
          another_program());
    } else if (!program_.is(flag::is_confirmed)) {
      add(ModuleFaultKind::never_confirmed,
          program_name() + (runs ? " runs on trial, and has not confirmed itself" : " has never started well"),
          start_or_another_program());
    } else if (!runs && means_.was_silent) {
      add(ModuleFaultKind::silent_program,
          program_name() + " has answered nothing until the supply was switched off and on", another_program());
    } else if (!runs) {
      add(ModuleFaultKind::in_bootloader, "is in its bootloader, and does not run " + program_name(),
          start_or_another_program());
    }
  }

  [[nodiscard]] Action start_or_another_program() const {
    if (means_.has_tried_start) {
      return another_program();
    }
    return {Remedy::start, program_.is(flag::runs_program) ? "waits for it" : "starts it"};
  }

  [[nodiscard]] Action another_program() const {
    if (means_.image == nullptr) {
      return {Remedy::by_hand, "'proleg recover IMAGE.pimg' flashes a program for " + board_text(module_.board_id)};
    }
    const bool is_same = program_.image && is_same_image(*program_.image, *means_.image);
    if (is_same && program_.is(flag::is_confirmed)) {
      return {Remedy::by_hand, "the image is the program that it has: run 'proleg recover' with another one"};
    }
    // Any program that runs is better than one that does not.
    return flash({.older_version = true});
  }

  [[nodiscard]] Action flash(const FlashPermissions& permissions) const {
    const FlashVerdict verdict = judge(*means_.image, module_, permissions);
    return verdict.action == FlashAction::install
               ? Action{Remedy::flash, "gets the program " + version_text(*means_.image)}
               : Action{Remedy::by_hand, "not flashed, because it " + verdict.text + ", with 'proleg flash'"};
  }

  void examine_node_id() {
    if (module_.node == 0) {
      add(ModuleFaultKind::no_node_id, "has no node id", {Remedy::number, "gets a free one"});
      return;
    }
    const auto others = std::ranges::count_if(all_, [this](const FlashCandidate& other) {
      return other.node == module_.node && other.program.serial != module_.program.serial;
    });
    if (others != 0) {
      const std::string text = "has the same node id as " +
                               (others == 1 ? "another module" : std::to_string(others) + " other modules") +
                               "; they stop when they notice it";
      add(ModuleFaultKind::duplicate_node_id, text,
          keeps_node_id() ? Action{Remedy::keep_number, "keeps it, and restarts"}
                          : Action{Remedy::renumber, "gets a free one"});
    } else if (!module_.serves_objects && program_.is(flag::runs_program)) {
      add(ModuleFaultKind::stopped, "is Stopped", {Remedy::restart, "restarts it"});
    }
  }

  /// Whether this module keeps the shared node id: modules that run a program come first, then the lowest serial
  /// number counts.
  [[nodiscard]] bool keeps_node_id() const {
    const auto rank = [](const FlashCandidate& one) {
      return std::pair(!one.program.is(flag::runs_program), one.program.serial);
    };
    return std::ranges::all_of(
        all_, [&](const FlashCandidate& other) { return other.node != module_.node || rank(module_) <= rank(other); });
  }

  /// The remedy for settings of a higher schema than that of the program. The module does not report the schema
  /// itself.
  [[nodiscard]] Action remedy_for_settings() const {
    std::string why_not = "a later image may know them";
    if (means_.image != nullptr && program_.image) {
      const unsigned schema = means_.image->settings_schema;
      const Action action = flash({});
      if (schema <= program_.image->settings_schema) {
        why_not = "the image does not know them either, with schema " + std::to_string(schema) + ": a later one may";
      } else if (action.remedy == Remedy::flash) {
        return action;
      } else {
        why_not = action.text;
      }
    }
    if (means_.resets_settings) {
      return {Remedy::reset_settings, "saves the default values, and keeps the node id"};
    }
    return {Remedy::by_hand, why_not + "; else --reset-settings loses all of them but the node id"};
  }

  const FlashCandidate& module_;
  const ModuleProgram& program_;
  std::span<const FlashCandidate> all_;
  const RecoveryMeans& means_;
  std::vector<ModuleFault> faults_;
};

}  // namespace

std::vector<ModuleFault> find_module_faults(const FlashCandidate& module, std::span<const FlashCandidate> all,
                                            const RecoveryMeans& means) {
  return Diagnosis(module, all, means).run();
}

std::string_view code_of(ModuleFaultKind kind) {
  switch (kind) {
    case ModuleFaultKind::no_update_protocol:
      return "no_update_protocol";
    case ModuleFaultKind::no_bootloader:
      return "no_bootloader";
    case ModuleFaultKind::no_program:
      return "no_program";
    case ModuleFaultKind::starts_badly:
      return "starts_badly";
    case ModuleFaultKind::silent_program:
      return "silent_program";
    case ModuleFaultKind::never_confirmed:
      return "never_confirmed";
    case ModuleFaultKind::in_bootloader:
      return "in_bootloader";
    case ModuleFaultKind::no_node_id:
      return "no_node_id";
    case ModuleFaultKind::duplicate_node_id:
      return "duplicate_node_id";
    case ModuleFaultKind::stopped:
      return "stopped";
    case ModuleFaultKind::newer_settings:
      return "newer_settings";
  }
  return "unknown";
}

}  // namespace proleg::host
