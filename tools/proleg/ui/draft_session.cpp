#include "tools/proleg/ui/draft_session.hpp"

#include <malloc.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/part_change.hpp"
#include "sim/authoring/world_clipboard.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/scenario/actuation_reader.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/ui/algorithm_folders.hpp"
#include "tools/proleg/ui/draft_arguments.hpp"
#include "tools/proleg/ui/draft_document.hpp"
#include "tools/proleg/ui/draft_operations.hpp"
#include "tools/proleg/ui/new_draft.hpp"
#include "tools/proleg/ui/newest_algorithms.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json lines_json(const std::vector<std::string>& texts) {
  json lines = json::array();
  for (const std::string& text : texts) {
    lines.push_back(one_line(text));
  }
  return lines;
}

/// Whether a file is kept in another form than its bytes.
bool is_binary(const sim::Draft::ChangedFile& file) {
  return sim::size_of_source(file.text) != file.text.size() ||
         (file.saved && sim::size_of_source(*file.saved) != file.saved->size());
}

/// Folders for new files, such as meshes. They are removed again if nothing is written.
class NewFolders {
 public:
  NewFolders() = default;
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders() {
    std::error_code ignored;
    for (auto folder = created_.rbegin(); folder != created_.rend(); ++folder) {
      fs::remove(*folder, ignored);
    }
  }

  void create_for(const fs::path& file) {
    std::error_code error;
    std::vector<fs::path> missing;
    for (fs::path folder = file.parent_path(); !folder.empty() && !fs::exists(folder, error);
         folder = folder.parent_path()) {
      missing.push_back(folder);
    }
    for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) {
      if (!fs::create_directory(*folder, error)) {
        throw FileError(*folder, "cannot be created: " + error.message());
      }
      created_.push_back(*folder);
    }
  }
  void keep() { created_.clear(); }

 private:
  std::vector<fs::path> created_;
};

json unsaved_json(const KeptChanges& kept) {
  json files = json::array();
  for (const auto& [name, text] : kept.texts) {
    files.push_back(one_line(name));
  }
  return {{"time_ms", kept.time_ms}, {"files", std::move(files)}};
}

/// folder: of the project. An algorithm has a folder, and the path of its library, if its source is in the project.
json missing_json(const MissingAlgorithms& missing, const std::filesystem::path& folder) {
  json algorithms = json::array();
  for (const std::string& name : missing.names) {
    json entry{{"name", one_line(name)}, {"folder", json()}, {"library", json()}};
    if (const std::optional<AlgorithmFolder> found = AlgorithmFolders(folder).with_name(name)) {
      entry["folder"] = found->folder;
      entry["library"] = found->library().string();
    }
    algorithms.push_back(std::move(entry));
  }
  return {{"file", one_line(missing.file)},
          {"action", missing.action},
          {"error", one_line(missing.error)},
          {"algorithms", std::move(algorithms)}};
}

}  // namespace

DraftSession::DraftSession(std::optional<sim::Scenario> scenario, DraftSessionOptions options,
                           SessionRequests& requests, PresentDraft& present, host::SessionOutput& output)
    : SessionThread(requests, output), options_(std::move(options)), present_(present) {
  output_.publish("library", library_json());
  output_.publish("parts", parts_json());
  if (scenario) {
    begin(std::move(*scenario), options_.has_file);
  }
  publish_missing(options_.missing);
  publish();
  begin_thread();
}

DraftSession::~DraftSession() { end_thread(); }

void DraftSession::serve() {
  take_operations();
  publish();
  const auto due = journal_ ? journal_->due() : std::nullopt;
  if (!due) {
    requests_.wait();
  } else if (Clock::now() >= *due) {
    write_journal();
  } else {
    requests_.wait_until(*due);
  }
}

void DraftSession::close() {
  if (journal_ && journal_->due()) {
    write_journal();
  }
}

void DraftSession::begin(sim::Scenario scenario, bool has_file) {
  close();
  const std::uint64_t revision = draft_ ? draft_->revision() + 1 : 0;
  options_.has_file = has_file;
  draft_.emplace(std::move(scenario), has_file ? static_cast<sim::FileSource&>(disk_) : nothing_, revision);
  if (!foresight_) {
    foresight_.emplace(output_);
  }
  kept_.reset();
  published_.reset();
  is_layout_new_ = true;
  is_new_ = true;
  open_journal();
}

void DraftSession::open_journal() {
  const std::string& path = draft_->scenario().path;
  journal_.emplace(journal_path(path, options_.has_file && !is_shipped(path), options_.folder));
  try {
    kept_ = journal_->read(*draft_);
  } catch (const InputError& error) {
    output_.notice(host::NoticeLevel::warning,
                   "unsaved changes of an earlier program cannot be restored: " + one_line(error.what()));
  }
}

void DraftSession::write_journal() {
  malloc_trim(0);  // the reader and the documents of large meshes have many parts
  try {
    journal_->write(*draft_);
  } catch (const std::exception& error) {
    output_.notice(host::NoticeLevel::warning,
                   "unsaved changes are lost if this program ends: " + one_line(error.what()));
  }
}

void DraftSession::publish_missing(const std::optional<MissingAlgorithms>& missing) {
  if (missing || has_missing_) {
    output_.publish("missing_algorithms", missing ? missing_json(*missing, options_.folder) : json());
  }
  has_missing_ = missing.has_value();
}

void DraftSession::read_or_name_missing(const std::string& file, const char* action,
                                        const std::function<void()>& read) {
  try {
    read();
  } catch (const sim::UnknownAlgorithms& error) {
    publish_missing(MissingAlgorithms{file, action, error.what(), error.names()});
    throw;
  }
  publish_missing(std::nullopt);
}

sim::Draft& DraftSession::draft() {
  if (!draft_) {
    throw std::runtime_error("there is no scenario to change; make a new one, or open one");
  }
  return *draft_;
}

void DraftSession::read_algorithms_again() {
  if (!draft_ || !has_newer_algorithms(draft_->scenario())) {
    return;
  }
  try {
    draft_->read_again();
  } catch (const InputError& error) {
    output_.notice(host::NoticeLevel::warning,
                   "the draft keeps an earlier version of its algorithm: " + one_line(error.what()));
  }
}

void DraftSession::publish() {
  if (!draft_) {
    if (std::exchange(is_new_, false)) {
      output_.publish("draft", json());
    }
    return;
  }
  const sim::Draft& draft = *draft_;
  const bool is_changed = published_ != draft.revision();
  if (is_watched_ && foreseen_ != draft.revision()) {
    foresight_->look_at(std::make_shared<const sim::Scenario>(draft.scenario()), draft.revision());
    foreseen_ = draft.revision();
  }
  if (!is_changed && !is_new_) {
    return;
  }
  const sim::Scenario& scenario = draft.scenario();
  if (published_) {  // what is opened has not changed
    journal_->note_change(Clock::now());
  }
  if (is_changed) {
    // Meshes are large: they are sent only if they differ.
    RobotMeshes meshes = robot_meshes(scenario);
    if (!has_published_meshes_ || !are_same(meshes, published_meshes_)) {
      output_.publish("draft_meshes", meshes_json(meshes));
      published_meshes_ = std::move(meshes);
      has_published_meshes_ = true;
    }
    output_.publish("draft_robot", robot_document(scenario, "draft", MeshesInDocument::no));
  }
  const sim::WorldContents world = read_world_contents(draft);
  const sim::RobotContents contents = read_robot_contents(draft);
  note_layout(world, contents);
  std::vector<std::string> changed;
  for (const sim::Draft::ChangedFile& file : draft.changed_files()) {
    changed.push_back(file.name);
  }
  present_.set(
      {std::make_shared<const sim::Scenario>(scenario), draft.revision(), options_.has_file && changed.empty()});
  output_.publish("draft", {{"file", one_line(scenario.path)},
                            {"revision", draft.revision()},
                            {"undo", draft.undo_label() ? json(*draft.undo_label()) : json()},
                            {"redo", draft.redo_label() ? json(*draft.redo_label()) : json()},
                            {"changed", lines_json(changed)},
                            {"has_file", options_.has_file},
                            {"is_shipped", is_shipped(scenario.path)},
                            {"unsaved", kept_ ? unsaved_json(*kept_) : json()},
                            {"warnings", lines_json(scenario.warnings)},
                            {"head", pose_json(scenario.environment.robot_pose * scenario.robot.links.front().pose)},
                            {"robot", robot_json(contents, scenario)},
                            {"behaviour", behaviour_json(scenario)},
                            {"run", run_json(scenario)},
                            {"world", world_json(world)},
                            {"layout", layout_since_}});
  published_ = draft.revision();
  is_new_ = false;
}

void DraftSession::note_layout(const sim::WorldContents& world, const sim::RobotContents& robot) {
  std::vector<std::size_t> layout{world.rulers.size(), robot.joints.size(), robot.sensors.size(),
                                  sim::used_slots(draft_->scenario()).size()};
  for (const sim::WorldObject& object : world.objects) {
    layout.push_back(object.shapes.size());
  }
  if (std::exchange(is_layout_new_, false) || layout != layout_) {
    layout_ = std::move(layout);
    layout_since_ = draft_->revision();
  }
}

json DraftSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{
      {"draft.new", &DraftSession::make_new},    {"draft.open", &DraftSession::open},
      {"draft.take", &DraftSession::take},       {"draft.undo", &DraftSession::undo},
      {"draft.redo", &DraftSession::redo},       {"draft.restore", &DraftSession::restore},
      {"draft.discard", &DraftSession::discard}, {"draft.refresh", &DraftSession::refresh},
      {"draft.diff", &DraftSession::diff},       {"draft.copy", &DraftSession::copy},
      {"draft.save", &DraftSession::save},       {"draft.save_as", &DraftSession::save_as}};
  const std::string& name = operation.name;
  const json& arguments = operation.arguments;
  const DraftOperationReader reader = reader_of(name);
  json value;
  if (options_.meshes != nullptr && names_sent_mesh(name)) {
    value = change_draft(arguments, [&] { return mesh_operation(name, arguments, draft(), *options_.meshes); });
  } else if (reader != nullptr) {
    value = change_draft(arguments, [&] { return reader(name, arguments, draft()); });
  } else {
    value = (this->*handler_of(handlers, name))(arguments);
  }
  is_watched_ = true;
  // The answer comes behind what it is about, and the next operation that waits is compared with this layout.
  publish();
  return value;
}

json DraftSession::change_draft(const json& arguments, const std::function<DraftOperation()>& read) {
  if (draft().refresh()) {
    publish();
  }
  const DraftOperation change = read();
  const auto gesture = argument<std::uint64_t>(arguments, "gesture", "a whole number");
  if (change.names_positions) {
    require_layout(arguments);
  }
  draft().change(change.label, gesture, change.change);
  is_layout_new_ = is_layout_new_ || change.moves_positions;
  return {{"revision", draft().revision()}};
}

/// Positions in lists that another change has altered would name other parts.
void DraftSession::require_layout(const json& arguments) const {
  if (argument<std::uint64_t>(arguments, "layout", "the layout of the draft") != layout_since_) {
    throw std::runtime_error("the parts of the draft have changed meanwhile; look at them again");
  }
}

json DraftSession::copy(const json& arguments) {
  static_cast<void>(draft());
  require_layout(arguments);
  return {{"text", sim::copied_objects(draft(), positions(arguments, "objects"))}};
}

/// Changes of a scenario with files are kept beside them, and offered when it is opened again.
void DraftSession::require_kept_changes(const json& arguments) const {
  const bool discards = argument<bool>(arguments, "discard", "true or false").value_or(false);
  if (draft_ && !options_.has_file && !discards && !draft_->changed_files().empty()) {
    throw std::runtime_error(
        "the changes of this new scenario are not saved; save them into a folder, or discard them");
  }
}

json DraftSession::make_new(const json& arguments) {
  require_kept_changes(arguments);
  begin(new_scenario(arguments), false);
  publish_missing(std::nullopt);
  return {{"revision", draft().revision()}};
}

std::string DraftSession::file_to_open(const json& arguments) const {
  std::string file = text(arguments, "file");
  if (!options_.may_open || !options_.may_open(file)) {
    throw InputError("file", 0, in_quotes(one_line(shortened(file))),
                     "a scenario of the project, or one that ships with Proleg: the list of gallery.look has them");
  }
  return file;
}

json DraftSession::open(const json& arguments) {
  const std::string file = file_to_open(arguments);
  require_kept_changes(arguments);
  read_or_name_missing(file, "open", [&] { begin(sim::read_scenario(file, disk_), true); });
  note_opened(file);
  return {{"revision", draft().revision()}};
}

/// Joints may have changed places: their positions mean something else.
void DraftSession::note_robot(const std::string& before) {
  is_layout_new_ = is_layout_new_ || before != draft().text(draft().scenario().robot_file);
}

json DraftSession::take(const json& arguments) {
  const std::string file = file_to_open(arguments);
  const auto names = argument<std::vector<std::string>>(arguments, "parts", "'robot', 'actuation' or 'environment'");
  std::vector<sim::ScenarioPart> parts;
  for (const std::string& name : names.value_or(std::vector<std::string>{})) {
    const std::optional<sim::ScenarioPart> part = sim::part_named(name);
    if (!part) {
      throw InputError("parts", 0, in_quotes(one_line(shortened(name))), "'robot', 'actuation' or 'environment'");
    }
    parts.push_back(*part);
  }
  if (parts.empty()) {
    throw InputError("parts", 0, "none", "'robot', 'actuation' or 'environment'");
  }
  const sim::Scenario other = sim::read_scenario(file, disk_);
  const std::string label =
      std::string(sim::tag_of(parts.front())) + " of " + std::filesystem::path(file).filename().string();
  draft().change(label, std::nullopt, [&](sim::DraftChange& change) {
    for (const sim::ScenarioPart part : parts) {
      take_part(change, draft().scenario(), other, part);
    }
  });
  is_layout_new_ = true;
  return {{"revision", draft().revision()}};
}

void DraftSession::note_opened(const std::string& file) const {
  if (options_.note_opened) {
    options_.note_opened(file);
  }
}

json DraftSession::undo(const json& /*arguments*/) {
  const std::string robot = draft().text(draft().scenario().robot_file);
  if (!draft().undo()) {
    throw std::runtime_error("there is nothing to undo");
  }
  note_robot(robot);
  return {{"revision", draft().revision()}};
}

json DraftSession::redo(const json& /*arguments*/) {
  const std::string robot = draft().text(draft().scenario().robot_file);
  if (!draft().redo()) {
    throw std::runtime_error("there is nothing to redo");
  }
  note_robot(robot);
  return {{"revision", draft().revision()}};
}

json DraftSession::restore(const json& /*arguments*/) {
  if (!kept_) {
    throw std::runtime_error("there are no unsaved changes of an earlier program");
  }
  for (const auto& [name, text] : kept_->texts) {
    if (!draft().has(name)) {
      draft().adopt(name);
    }
  }
  const auto restore_texts = [this](sim::DraftChange& change) {
    for (const auto& [name, text] : kept_->texts) {
      if (draft_->has(name)) {
        change.apply(name, {0, draft_->text(name), text});
      } else {
        change.add_file(name, text);
      }
    }
  };
  read_or_name_missing(draft().scenario().path, "restore",
                       [&] { draft().change("restore unsaved changes", std::nullopt, restore_texts); });
  kept_.reset();
  journal_->forget_kept();
  return {{"revision", draft().revision()}};
}

json DraftSession::discard(const json& /*arguments*/) {
  if (!kept_) {
    throw std::runtime_error("there are no unsaved changes of an earlier program");
  }
  kept_.reset();
  journal_->discard();
  publish_missing(std::nullopt);
  is_new_ = true;
  return json::object();
}

json DraftSession::refresh(const json& /*arguments*/) {
  const bool is_changed = draft().refresh();
  read_algorithms_again();
  return {{"changed", is_changed}};
}

json DraftSession::diff(const json& /*arguments*/) {
  constexpr std::size_t most_text = 256 * 1024;  // a person reads no more, and an answer has a limit
  json files = json::array();
  for (const sim::Draft::ChangedFile& file : draft().changed_files()) {
    const bool is_shown = !is_binary(file) && !sim::is_mesh_file_name(file.name) &&
                          file.text.size() + (file.saved ? file.saved->size() : 0) <= most_text;
    files.push_back({{"name", one_line(file.name)},
                     {"is_shipped", is_shipped(file.name)},
                     {"bytes", sim::size_of_source(file.text)},
                     {"old", is_shown && file.saved ? json(file.saved->str()) : json()},
                     {"new", is_shown ? json(file.text.str()) : json()}});
  }
  return {{"files", std::move(files)}};
}

void DraftSession::require_unchanged_on_disk(const sim::Draft::ChangedFile& file) {
  if (is_shipped(file.name)) {
    throw InputError(file.name, 0, "a file that ships with Proleg, which stays as it is",
                     "a copy of your own: Save as");
  }
  std::optional<std::string> on_disk = disk_.read(file.name);
  if (on_disk && is_binary(file)) {
    on_disk = sim::source_text(std::move(*on_disk));
  }
  // A Save that failed in the middle may have written it.
  if (on_disk != file.saved && on_disk != file.text) {
    throw InputError(file.name, 0,
                     file.saved ? "a file that has changed since this program read it" : "a file that exists",
                     file.saved ? "the same file; Save as keeps both" : "a new name");
  }
}

json DraftSession::save(const json& /*arguments*/) {
  if (!options_.has_file) {
    throw std::runtime_error("this scenario has no files yet; Save as writes them into a new folder");
  }
  const std::vector<sim::Draft::ChangedFile> changed = draft().changed_files();
  std::vector<PlannedOutput> outputs;
  for (const sim::Draft::ChangedFile& file : changed) {
    require_unchanged_on_disk(file);
    outputs.push_back({"draft.save", file.name, "file", [](const std::filesystem::path&) { return true; }, true});
  }
  NewFolders folders;
  for (const sim::Draft::ChangedFile& file : changed) {
    folders.create_for(file.name);
  }
  // None is written if one of them may not be written; a disk can be full in the middle.
  check_outputs(outputs);
  folders.keep();
  for (const sim::Draft::ChangedFile& file : changed) {
    write_file(file.name, sim::bytes_of_source(file.text));
  }
  draft().mark_saved();
  is_new_ = true;
  output_.notice(host::NoticeLevel::info, "saved " + std::to_string(changed.size()) +
                                              (changed.size() == 1 ? " file of " : " files of ") +
                                              one_line(draft().scenario().path));
  return {{"written", changed.size()}};
}

json DraftSession::save_as(const json& arguments) {
  const auto name = argument<std::string>(arguments, "folder", "the name of a new folder");
  const sim::Scenario& scenario = draft().scenario();
  const std::map<std::string, std::string> names =
      copy_sources(scenario.sources, new_folder_in(options_.folder, name.value_or(""), "folder"));
  const std::string& file = names.at(scenario.sources.front().path);
  draft().rename_files(names, file, disk_);
  options_.has_file = true;
  journal_->discard();
  journal_.emplace(journal_path(file, true, options_.folder));
  is_new_ = true;
  note_opened(file);
  output_.notice(host::NoticeLevel::info, "saved as " + one_line(file) + "; Save writes there from now on");
  return {{"file", one_line(file)}};
}

}  // namespace proleg::tools
