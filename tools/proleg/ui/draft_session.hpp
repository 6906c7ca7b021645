#pragma once

// The scenario that viewers make: a draft of its files, changed by operations, saved on demand. It runs in a thread of
// its own, beside the robot.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/world_change.hpp"
#include "tools/proleg/ui/draft_journal.hpp"
#include "tools/proleg/ui/foresight.hpp"
#include "tools/proleg/ui/present_draft.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

struct DraftSessionOptions {
  std::filesystem::path folder;  ///< where `draft.save_as` makes folders
  bool has_file = false;         ///< the scenario is on disk
};

class DraftSession final : private SessionThread {
 public:
  /// scenario: nothing: there is no draft. disk: where its files are. present: gets each state of the draft. They, the
  /// requests and the output must outlive the session.
  DraftSession(std::optional<sim::Scenario> scenario, sim::FileSource& disk, DraftSessionOptions options,
               SessionRequests& requests, PresentDraft& present, host::SessionOutput& output);
  ~DraftSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() { return {"draft.diff", "draft.refresh"}; }

 private:
  // SessionThread
  void serve() override;
  /// The draft stays as it was.
  void fail(const std::string& /*why*/) override {}
  void close() override;
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  /// Finds the unsaved changes of an earlier program.
  void open_journal();
  void write_journal();
  void publish();
  void note_layout(const sim::WorldContents& world);
  [[nodiscard]] sim::Draft& draft();
  /// The draft as the reader has it, with the newest versions of algorithms.
  [[nodiscard]] const sim::Scenario& scenario() const;
  /// Reads the files of the draft again if an algorithm was loaded again since they were read.
  void read_algorithms_again();
  void change_world(const host::OperationRequest& operation);
  void require_unchanged_on_disk(const sim::Draft::ChangedFile& file);

  using Handler = nlohmann::json (DraftSession::*)(const nlohmann::json&);
  nlohmann::json change_run(const nlohmann::json& arguments);
  nlohmann::json undo(const nlohmann::json& arguments);
  nlohmann::json redo(const nlohmann::json& arguments);
  nlohmann::json refresh(const nlohmann::json& arguments);
  nlohmann::json diff(const nlohmann::json& arguments);
  nlohmann::json restore(const nlohmann::json& arguments);
  nlohmann::json discard(const nlohmann::json& arguments);
  nlohmann::json save(const nlohmann::json& arguments);
  nlohmann::json save_as(const nlohmann::json& arguments);

  DraftSessionOptions options_;
  PresentDraft& present_;
  sim::FileSource& disk_;
  std::optional<sim::Draft> draft_;
  std::optional<Foresight> foresight_;
  std::optional<DraftJournal> journal_;
  std::optional<KeptChanges> kept_;  ///< of an earlier program, until somebody decides about them
  /// The draft read again because of an algorithm that was loaded again, and its revision.
  std::optional<std::pair<std::uint64_t, sim::Scenario>> read_again_;
  std::optional<std::uint64_t> published_;  ///< revision of the draft
  std::string published_meshes_;
  std::vector<std::size_t> layout_;  ///< of the lists of the world: what their positions depend on
  std::uint64_t layout_since_ = 0;   ///< revision since which it is the same
  bool is_new_ = true;               ///< something beside the revision has changed
};

}  // namespace proleg::tools
