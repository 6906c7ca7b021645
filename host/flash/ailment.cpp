#include "host/flash/ailment.hpp"

#include <algorithm>

namespace proleg::host {
namespace {

namespace flag = broadcast::module_flag;

constexpr std::string_view flash_bare = "flash it with a probe: 'proleg flash --bare'";

class Diagnosis {
 public:
  Diagnosis(const FlashCandidate& module, std::span<const FlashCandidate> all, const RecoveryMeans& means)
      : module_(module), program_(module.program), all_(all), means_(means) {}

  std::vector<Ailment> run() {
    if (!program_.has_answered) {
      add(AilmentKind::no_update_protocol,
          "answers no request for an update: its program is older than that, or it has no bootloader",
          {Remedy::by_hand, std::string(flash_bare)});
    } else {
      examine_program();
    }
    examine_node_id();
    if (program_.is(flag::has_newer_settings)) {
      add(AilmentKind::newer_settings, "its settings are those of a later program, of which it uses only the node id",
          remedy_for_settings());
    }
    return std::move(ailments_);
  }

 private:
  struct Action {
    Remedy remedy;
    std::string text;
  };

  void add(AilmentKind kind, std::string text, Action action) {
    ailments_.push_back({kind, std::move(text), action.remedy, std::move(action.text)});
  }
  [[nodiscard]] std::string program_name() const {
    return program_.image ? "its program " + version_text(*program_.image) : "its program";
  }

  void examine_program() {
    const bool runs = program_.is(flag::runs_program);
    if (!program_.is(flag::has_bootloader)) {
      add(AilmentKind::no_bootloader, "has no bootloader", {Remedy::by_hand, std::string(flash_bare)});
    } else if (!program_.is(flag::has_image)) {
      add(AilmentKind::no_program, "has no program", another_program());
    } else if (!runs && program_.is(flag::starts_badly)) {
      add(AilmentKind::starts_badly, program_name() + " stops just after its start, again and again",
          another_program());
    } else if (!program_.is(flag::is_confirmed)) {
      add(AilmentKind::never_confirmed,
          program_name() + (runs ? " runs on trial, and has not confirmed itself" : " has never started well"),
          start_or_another_program());
    } else if (!runs) {
      add(AilmentKind::in_bootloader, "is in its bootloader, and does not run " + program_name(),
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
      return {Remedy::by_hand,
              "'proleg recover IMAGE.pimg' flashes a program for board " + std::to_string(module_.board_id)};
    }
    const bool is_same = program_.image && is_same_image(*program_.image, *means_.image);
    if (is_same && program_.is(flag::is_confirmed)) {
      return {Remedy::by_hand, "the image is the program that it has: run 'proleg recover' with another one"};
    }
    // Whatever runs is better than what does not.
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
      add(AilmentKind::no_node_id, "has no node id", {Remedy::number, "gets a free one"});
      return;
    }
    const auto others = std::ranges::count_if(all_, [this](const FlashCandidate& other) {
      return other.node == module_.node && other.program.serial != module_.program.serial;
    });
    if (others != 0) {
      const std::string text = "has the same node id as " +
                               (others == 1 ? "another module" : std::to_string(others) + " other modules") +
                               "; they stop when they notice it";
      add(AilmentKind::duplicate_node_id, text,
          keeps_node_id() ? Action{Remedy::keep_number, "keeps it, and restarts"}
                          : Action{Remedy::renumber, "gets a free one"});
    } else if (!module_.serves_objects && program_.is(flag::runs_program)) {
      add(AilmentKind::stopped, "is Stopped", {Remedy::restart, "restarts it"});
    }
  }

  /// A module that runs, if there is one; of several the one with the lowest serial number.
  [[nodiscard]] bool keeps_node_id() const {
    const auto rank = [](const FlashCandidate& one) {
      return std::pair(!one.program.is(flag::runs_program), one.program.serial);
    };
    return std::ranges::all_of(
        all_, [&](const FlashCandidate& other) { return other.node != module_.node || rank(module_) <= rank(other); });
  }

  /// The module does not report the schema of its settings, only that it is higher than that of its program.
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
  std::vector<Ailment> ailments_;
};

}  // namespace

std::vector<Ailment> find_ailments(const FlashCandidate& module, std::span<const FlashCandidate> all,
                                   const RecoveryMeans& means) {
  return Diagnosis(module, all, means).run();
}

std::string_view code_of(AilmentKind kind) {
  switch (kind) {
    case AilmentKind::no_update_protocol:
      return "no_update_protocol";
    case AilmentKind::no_bootloader:
      return "no_bootloader";
    case AilmentKind::no_program:
      return "no_program";
    case AilmentKind::starts_badly:
      return "starts_badly";
    case AilmentKind::never_confirmed:
      return "never_confirmed";
    case AilmentKind::in_bootloader:
      return "in_bootloader";
    case AilmentKind::no_node_id:
      return "no_node_id";
    case AilmentKind::duplicate_node_id:
      return "duplicate_node_id";
    case AilmentKind::stopped:
      return "stopped";
    case AilmentKind::newer_settings:
      return "newer_settings";
  }
  return "unknown";
}

}  // namespace proleg::host
