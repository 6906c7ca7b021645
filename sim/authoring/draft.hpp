#pragma once

// The files of a scenario while a person changes them. A change is an edit of the files' texts; the scenario reader
// judges the result, so that a draft can be run at any time and what it accepts is what every program accepts. Nothing
// on disk changes.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/authoring/xml_text.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::sim {

/// The texts of a draft, by the names of the files (name_of()), and the files on disk that it does not have.
class DraftTexts final : public FileSource {
 public:
  /// disk: must outlive this.
  explicit DraftTexts(FileSource& disk) : disk_(&disk) {}

  [[nodiscard]] std::optional<SharedText> read(const std::filesystem::path& path) override;
  [[nodiscard]] std::optional<std::string> found_instead(const std::filesystem::path& path) override;
  [[nodiscard]] KnownMeshes* known_meshes() override { return &meshes_; }

  /// The text of a file of the draft; null if it has no such file.
  [[nodiscard]] const std::string* find(const std::string& name) const;
  /// The same. Throws InputError if there is no such file.
  [[nodiscard]] const std::string& at(const std::string& name) const;
  void set(const std::string& name, SharedText text) { texts_.insert_or_assign(name, std::move(text)); }
  void erase(const std::string& name) { texts_.erase(name); }
  void set_disk(FileSource& disk) { disk_ = &disk; }
  [[nodiscard]] const std::map<std::string, SharedText>& all() const { return texts_; }

 private:
  FileSource* disk_;
  std::map<std::string, SharedText> texts_;
  KnownMeshes meshes_;
};

class Draft;

/// What one change does to the files. Each call takes effect at once, so that the next one sees it.
class DraftChange {
 public:
  /// The scenario after the calls before. Throws InputError if the reader refuses it.
  [[nodiscard]] Scenario scenario() const;
  /// The text of a file after the calls before; null if the draft has no such file. Valid until the next apply().
  [[nodiscard]] const std::string* text(const std::string& name) const { return texts_.find(name); }
  /// The same, also of a file that only the disk has.
  [[nodiscard]] std::optional<SharedText> read(const std::string& name) const { return texts_.read(name); }
  /// A file after the calls before. Throws InputError for a file that the draft does not have, or that is no XML. Valid
  /// until the next apply() to this file.
  [[nodiscard]] const XmlText& xml(const std::string& name);
  void apply(const std::string& name, const TextPatch& patch);
  /// Patches of the same xml(name), of places that do not overlap. Faster than one after the other.
  void apply_all(const std::string& name, std::vector<TextPatch> patches);
  /// Adds a file. Throws InputError if the draft, or the disk, has one of this name.
  void add_file(const std::string& name, SharedText text);

 private:
  friend class Draft;
  explicit DraftChange(Draft& draft);

  struct Step {
    std::string file;
    TextPatch patch;  ///< of a file that was there and stays
    bool is_new_file = false;
    bool is_removed_file = false;
    SharedText text = {};  ///< of a file that comes or goes

    /// Adds a later step to this one if that changes only what this one has inserted, as the steps of a drag do.
    /// Returns false if it does not.
    bool absorbs(const Step& next);
  };

  /// Removes a file that only the draft has.
  void remove_file(const std::string& name);

  static void apply_step(const Step& step, DraftTexts& texts);
  static void take_back(const Step& step, DraftTexts& texts);

  Draft& draft_;
  DraftTexts& texts_;
  std::vector<Step> steps_;
  std::map<std::string, std::unique_ptr<XmlText>> parsed_;
};

class Draft {
 public:
  /// A file that is not as it is on disk.
  struct ChangedFile {
    std::string name;
    std::optional<SharedText> saved;  ///< its text when it was read or saved; nothing: it is new
    SharedText text;
  };

  /// scenario: as it was read, with its sources. disk: where files are that a change names; must outlive the draft.
  /// revision: where the count of changes begins.
  Draft(Scenario scenario, FileSource& disk, std::uint64_t revision = 0);

  /// The scenario as the reader has it from the present texts.
  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  /// Counts the changes, undo and redo included.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// A file as it is now. Throws InputError for one that the draft does not have.
  [[nodiscard]] const std::string& text(const std::string& name) const { return texts_.at(name); }
  [[nodiscard]] bool has(const std::string& name) const { return texts_.find(name) != nullptr; }

  /// Changes the files by calls of `change`. If the reader refuses the result, or `change` throws, nothing changes and
  /// the InputError says why. label: for undo, "move box". gesture: changes in a row with the same number are one entry
  /// of undo, such as the steps of a drag.
  void change(const std::string& label, std::optional<std::uint64_t> gesture,
              const std::function<void(DraftChange&)>& change);

  /// Takes the last change back, or does it again. Returns false if there is none. Throws InputError, and then does
  /// nothing, if the reader refuses the state because of a file that only the disk has.
  bool undo();
  bool redo();
  /// What undo() and redo() would do: the label of the change. Nothing if there is none.
  [[nodiscard]] std::optional<std::string> undo_label() const;
  [[nodiscard]] std::optional<std::string> redo_label() const;

  /// The files that differ from the disk, by name.
  [[nodiscard]] std::vector<ChangedFile> changed_files() const;
  /// Takes over what other programs, or other parts of this one, have written into files that the draft has not changed
  /// and that undo would not change. Files that the reader would refuse, and large ones, stay as they are. Returns
  /// whether anything has changed.
  bool refresh();
  /// Reads the present texts again, for example because an algorithm has other parameters now. Throws InputError, and
  /// then does nothing, if the reader refuses them.
  void read_again();
  /// A file that only the disk has, such as one that was saved and then taken back, becomes a file of the draft, as it
  /// is there. Does nothing if the disk does not have it.
  void adopt(const std::string& name);
  /// The present texts are on disk.
  void mark_saved();
  /// The files have been saved under other names, in `renamed` by their names until now, and the draft goes on there.
  /// path: of the top-level file from now on. disk: where they are. Undo stays.
  void rename_files(const std::map<std::string, std::string>& renamed, const std::filesystem::path& path,
                    FileSource& disk);

 private:
  friend class DraftChange;

  struct Entry {
    std::string label;
    std::optional<std::uint64_t> gesture;
    std::vector<DraftChange::Step> steps;
  };

  /// Removes the files that earlier calls of a change have added and that the scenario does not name.
  void remove_unused_files(DraftChange& change);
  void take_back(const std::vector<DraftChange::Step>& steps);
  void do_again(const std::vector<DraftChange::Step>& steps);
  [[nodiscard]] Scenario read();
  void keep(const std::string& label, std::optional<std::uint64_t> gesture, std::vector<DraftChange::Step> steps);
  void limit_history();

  FileSource* disk_;
  DraftTexts texts_;
  std::map<std::string, SharedText> saved_;  ///< texts as they are on disk
  Scenario scenario_;
  std::uint64_t revision_ = 0;
  std::deque<Entry> history_;
  std::size_t done_ = 0;  ///< entries of the history that have effect; those behind can be done again
};

}  // namespace proleg::sim
