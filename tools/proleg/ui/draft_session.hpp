#pragma once

// The scenario that viewers make: a draft of its files, changed by operations, saved on demand. It runs in a thread of
// its own, beside the robot.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "sim/authoring/world_contents.hpp"
#include "tools/proleg/ui/draft_journal.hpp"
#include "tools/proleg/ui/draft_operations.hpp"
#include "tools/proleg/ui/foresight.hpp"
#include "tools/proleg/ui/mesh_session.hpp"
#include "tools/proleg/ui/present_draft.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

/// A scenario that this program could not read, because it lacks algorithms.
struct MissingAlgorithms {
  std::string file;
  std::string action;  ///< what was to be done: "start", "open" or "restore"
  std::string error;   ///< the line of the reader
  std::vector<std::string> names;
};

struct DraftSessionOptions {
  std::filesystem::path folder;  ///< of the project: where `draft.save_as` makes folders, and where algorithms are
  bool has_file = false;         ///< the scenario is on disk
  /// Whether `draft.open` may open a file; without it, none.
  std::function<bool(const std::string& file)> may_open = {};
  /// A scenario was opened, or saved under this name. May be empty.
  std::function<void(const std::string& file)> note_opened = {};
  /// Meshes that viewers have sent; null: none. Must outlive the session.
  const SentMeshes* meshes = nullptr;
  /// The scenario that was to be shown at the start.
  std::optional<MissingAlgorithms> missing = {};
};

class DraftSession final : private SessionThread {
 public:
  /// scenario: nothing: there is no draft until somebody opens one. present: gets each state of the draft. It, the
  /// requests and the output must outlive the session.
  DraftSession(std::optional<sim::Scenario> scenario, DraftSessionOptions options, SessionRequests& requests,
               PresentDraft& present, host::SessionOutput& output);
  ~DraftSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() {
    return {"draft.diff", "draft.copy", "draft.refresh"};
  }

 private:
  // SessionThread
  void serve() override;
  /// The draft stays as it was.
  void fail(const std::string& /*why*/) override {}
  void close() override;
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  /// The draft is this scenario from now on. Unsaved changes of the one before stay in its journal.
  void begin(sim::Scenario scenario, bool has_file);
  /// Finds the unsaved changes of an earlier program, or of this one before it opened another scenario.
  void open_journal();
  void write_journal();
  void publish();
  void note_layout(const sim::WorldContents& world, const sim::RobotContents& robot);
  [[nodiscard]] sim::Draft& draft();
  nlohmann::json change_draft(const nlohmann::json& arguments, const std::function<DraftOperation()>& read);
  void note_robot(const std::string& before);
  void note_opened(const std::string& file) const;
  void require_kept_changes(const nlohmann::json& arguments) const;
  /// Publishes what a scenario lacks, and what the project has of it; nothing: nothing is missing.
  void publish_missing(const std::optional<MissingAlgorithms>& missing);
  /// Does what reads a scenario. If that lacks algorithms, it publishes them and throws.
  void read_or_name_missing(const std::string& file, const char* action, const std::function<void()>& read);
  void require_layout(const nlohmann::json& arguments) const;
  /// Reads the draft again if an algorithm was loaded again since it was read.
  void read_algorithms_again();
  void require_unchanged_on_disk(const sim::Draft::ChangedFile& file);

  using Handler = nlohmann::json (DraftSession::*)(const nlohmann::json&);
  nlohmann::json make_new(const nlohmann::json& arguments);
  nlohmann::json open(const nlohmann::json& arguments);
  nlohmann::json take(const nlohmann::json& arguments);
  [[nodiscard]] std::string file_to_open(const nlohmann::json& arguments) const;
  nlohmann::json undo(const nlohmann::json& arguments);
  nlohmann::json redo(const nlohmann::json& arguments);
  nlohmann::json refresh(const nlohmann::json& arguments);
  nlohmann::json diff(const nlohmann::json& arguments);
  nlohmann::json copy(const nlohmann::json& arguments);
  nlohmann::json restore(const nlohmann::json& arguments);
  nlohmann::json discard(const nlohmann::json& arguments);
  nlohmann::json save(const nlohmann::json& arguments);
  nlohmann::json save_as(const nlohmann::json& arguments);

  DraftSessionOptions options_;
  PresentDraft& present_;
  sim::DiskFiles disk_;
  sim::SourceTexts nothing_;  ///< in the place of the disk for a draft that has no files yet
  std::optional<sim::Draft> draft_;
  std::optional<Foresight> foresight_;
  std::optional<DraftJournal> journal_;
  std::optional<KeptChanges> kept_;         ///< of an earlier program, until somebody decides about them
  std::optional<std::uint64_t> published_;  ///< revision of the draft
  std::optional<std::uint64_t> foreseen_;   ///< revision whose path is computed, or was
  bool is_watched_ = false;                 ///< somebody has asked about the draft: without, no path is computed
  std::vector<std::shared_ptr<const sim::TriangleMesh>> published_meshes_;
  bool has_published_meshes_ = false;
  std::vector<std::size_t> layout_;  ///< of the lists of the draft: what their positions depend on
  bool is_layout_new_ = false;       ///< a change has moved positions
  std::uint64_t layout_since_ = 0;   ///< revision since which it is the same
  bool has_missing_ = false;         ///< the document `missing_algorithms` names some
  bool is_new_ = true;               ///< something beside the revision has changed
};

}  // namespace proleg::tools
