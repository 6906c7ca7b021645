#include "sim/authoring/draft.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::sim {
namespace {

// What undo keeps at most; older entries are forgotten.
constexpr std::size_t max_history_entries = 10'000;
constexpr std::size_t max_history_bytes = std::size_t{16} << 20U;
// Of all files of a draft, and of its meshes: large ones, added again and again, would fill the memory. The
// readers, the engine, the page and the path of the next half minute have forms of each triangle: with this limit, a
// client cannot make proleg ui take more than 64 MiB (client_memory_test.py).
constexpr std::size_t max_draft_bytes = std::size_t{24} << 20U;
constexpr std::size_t max_draft_triangles = 80'000;

std::size_t bytes_of(const TextPatch& patch) { return patch.removed.size() + patch.inserted.size(); }

std::size_t bytes_of(const DraftTexts& texts) {
  std::size_t bytes = 0;
  for (const auto& [name, text] : texts.all()) {
    bytes += text.size();
  }
  return bytes;
}

/// Triangles of the meshes of a scenario, which bodies may share: for each body of those that collide or of those that
/// are drawn, whichever are more.
std::size_t triangles_of(const Scenario& scenario) {
  std::set<std::shared_ptr<const TriangleMesh>> counted;
  const auto new_triangles = [&counted](const auto& shapes) {
    std::size_t triangles = 0;
    for (const auto& shape : shapes) {
      triangles += shape.mesh && counted.insert(shape.mesh).second ? shape.mesh->triangles.size() : 0;
    }
    return triangles;
  };
  std::size_t triangles = 0;
  const auto add = [&](const auto& bodies) {
    for (const auto& body : bodies) {
      const std::size_t colliding = new_triangles(body.geometries);
      triangles += std::max(colliding, new_triangles(body.looks));
    }
  };
  add(scenario.robot.links);
  add(scenario.environment.objects);
  add(scenario.environment.moving_objects);
  return triangles;
}

/// A scenario that is larger from the beginning can still be changed.
void require_room(const Scenario& before, const Scenario& after) {
  const std::size_t triangles = triangles_of(after);
  if (triangles > max_draft_triangles && triangles > triangles_of(before)) {
    throw InputError("the draft", 0, "meshes of " + std::to_string(triangles) + " triangles in all",
                     "at most " + std::to_string(max_draft_triangles) + "; smaller meshes, or fewer of them");
  }
}

void require_room(std::size_t before, std::size_t after) {
  if (after > max_draft_bytes && after > before) {
    throw InputError("the draft", 0, "files of " + std::to_string(after >> 20U) + " MiB",
                     "at most " + std::to_string(max_draft_bytes >> 20U) + " MiB; smaller meshes, or fewer of them");
  }
}

}  // namespace

std::optional<SharedText> DraftTexts::read(const std::filesystem::path& path) {
  const auto found = texts_.find(name_of(path));
  return found != texts_.end() ? std::optional(found->second) : disk_->read(path);
}

std::optional<std::string> DraftTexts::found_instead(const std::filesystem::path& path) {
  return disk_->found_instead(path);
}

const std::string* DraftTexts::find(const std::string& name) const {
  const auto found = texts_.find(name);
  return found == texts_.end() ? nullptr : &found->second.str();
}

const std::string& DraftTexts::at(const std::string& name) const {
  const std::string* const text = find(name);
  if (text == nullptr) {
    throw InputError(name, 0, "no such file in the draft", "one of its files");
  }
  return *text;
}

DraftChange::DraftChange(Draft& draft) : draft_(draft), texts_(draft.texts_) {}

Scenario DraftChange::scenario() const { return draft_.read(); }

const XmlText& DraftChange::xml(const std::string& name) {
  std::unique_ptr<XmlText>& parsed = parsed_[name];
  if (parsed == nullptr) {
    parsed = std::make_unique<XmlText>(name, texts_.at(name));
  }
  return *parsed;
}

void DraftChange::apply(const std::string& name, const TextPatch& patch) {
  if (patch.removed == patch.inserted) {
    return;  // a value that is as it was; what could be done again still can
  }
  steps_.push_back({name, patch});
  parsed_.erase(name);
  apply_step(steps_.back(), texts_);
}

void DraftChange::apply_all(const std::string& name, std::vector<TextPatch> patches) {
  std::ranges::sort(patches, std::ranges::greater{}, &TextPatch::position);
  for (const TextPatch& patch : patches) {
    apply(name, patch);
  }
}

void DraftChange::add_file(const std::string& name, SharedText text) {
  if (texts_.read(name)) {
    throw InputError(name, 0, "a file that exists", "a new name");
  }
  steps_.push_back({name, {}, true, false, std::move(text)});
  apply_step(steps_.back(), texts_);
}

void DraftChange::remove_file(const std::string& name) {
  steps_.push_back({name, {}, false, true, *texts_.read(name)});
  apply_step(steps_.back(), texts_);
}

bool DraftChange::Step::absorbs(const Step& next) {
  if (file != next.file || next.is_new_file || next.is_removed_file || is_removed_file) {
    return false;
  }
  if (is_new_file) {
    std::string changed = text;
    sim::apply(next.patch, changed);
    text = std::move(changed);
    return true;
  }
  const std::size_t begin = patch.position;
  const std::size_t at = next.patch.position;
  if (at < begin || at + next.patch.removed.size() > begin + patch.inserted.size()) {
    return false;
  }
  patch.inserted.replace(at - begin, next.patch.removed.size(), next.patch.inserted);
  return true;
}

void DraftChange::apply_step(const Step& step, DraftTexts& texts) {
  if (step.is_removed_file) {
    texts.erase(step.file);
    return;
  }
  if (step.is_new_file) {
    texts.set(step.file, step.text);
    return;
  }
  std::string text = texts.at(step.file);
  sim::apply(step.patch, text);
  texts.set(step.file, std::move(text));
}

void DraftChange::take_back(const Step& step, DraftTexts& texts) {
  if (step.is_new_file) {
    texts.erase(step.file);
    return;
  }
  if (step.is_removed_file) {
    texts.set(step.file, step.text);
    return;
  }
  std::string text = *texts.find(step.file);
  sim::apply(inverse(step.patch), text);
  texts.set(step.file, std::move(text));
}

Draft::Draft(Scenario scenario, FileSource& disk, std::uint64_t revision)
    : disk_(&disk), texts_(disk), scenario_(std::move(scenario)), revision_(revision) {
  for (const SourceFile& source : scenario_.sources) {
    texts_.set(source.path, source.text);
    saved_.emplace(source.path, source.text);
  }
}

Scenario Draft::read() {
  Scenario scenario = read_scenario(scenario_.path, texts_, scenario_.overrides);
  scenario.moves = scenario_.moves;  // of the command line, as the overrides
  texts_.known_meshes()->forget_unused();
  // What the change names for the first time, such as a mesh, belongs to the draft from now on: it must not change
  // behind it.
  for (const SourceFile& source : scenario.sources) {
    if (texts_.find(source.path) == nullptr) {
      texts_.set(source.path, source.text);
      saved_.insert_or_assign(source.path, source.text);
    }
  }
  return scenario;
}

void Draft::change(const std::string& label, std::optional<std::uint64_t> gesture,
                   const std::function<void(DraftChange&)>& change) {
  const std::size_t bytes_before = bytes_of(texts_);
  DraftChange collected(*this);
  try {
    change(collected);
    if (collected.steps_.empty()) {
      return;
    }
    require_room(bytes_before, bytes_of(texts_));
    Scenario changed = read();
    require_room(scenario_, changed);
    scenario_ = std::move(changed);
  } catch (...) {
    take_back(collected.steps_);
    throw;
  }
  remove_unused_files(collected);
  keep(label, gesture, std::move(collected.steps_));
  ++revision_;
}

// They would be written by Save, and large meshes would fill the memory.
void Draft::remove_unused_files(DraftChange& change) {
  std::set<std::string> used;
  for (const SourceFile& source : scenario_.sources) {
    used.insert(source.path);
  }
  std::vector<std::string> unused;
  for (const auto& [name, text] : texts_.all()) {
    if (!saved_.contains(name) && !used.contains(name)) {
      unused.push_back(name);
    }
  }
  for (const std::string& name : unused) {
    change.remove_file(name);
  }
}

void Draft::keep(const std::string& label, std::optional<std::uint64_t> gesture, std::vector<DraftChange::Step> steps) {
  const bool goes_on = done_ > 0 && done_ == history_.size() && gesture && history_.back().gesture == gesture;
  history_.erase(history_.begin() + static_cast<std::ptrdiff_t>(done_), history_.end());
  if (!goes_on) {
    history_.push_back({label, gesture, {}});
  }
  std::vector<DraftChange::Step>& kept = history_.back().steps;
  for (DraftChange::Step& step : steps) {
    // The steps of a drag replace each other's text.
    if (kept.empty() || !kept.back().absorbs(step)) {
      kept.push_back(std::move(step));
    }
  }
  done_ = history_.size();
  limit_history();
}

void Draft::limit_history() {
  std::size_t bytes = 0;
  std::size_t kept = 0;
  for (auto entry = history_.rbegin(); entry != history_.rend(); ++entry) {
    for (const DraftChange::Step& step : entry->steps) {
      bytes += bytes_of(step.patch) + step.text.str().size();
    }
    if (kept > 0 && (bytes > max_history_bytes || kept == max_history_entries)) {
      break;
    }
    ++kept;
  }
  history_.erase(history_.begin(), history_.end() - static_cast<std::ptrdiff_t>(kept));
  done_ = history_.size();
}

void Draft::take_back(const std::vector<DraftChange::Step>& steps) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    DraftChange::take_back(*step, texts_);
  }
}

void Draft::do_again(const std::vector<DraftChange::Step>& steps) {
  for (const DraftChange::Step& step : steps) {
    DraftChange::apply_step(step, texts_);
  }
}

bool Draft::undo() {
  if (done_ == 0) {
    return false;
  }
  Entry& entry = history_[done_ - 1];
  take_back(entry.steps);
  try {
    scenario_ = read();
  } catch (...) {  // a file that only the disk has is not as it was
    do_again(entry.steps);
    throw;
  }
  entry.gesture.reset();  // what follows a redo is another gesture
  --done_;
  ++revision_;
  return true;
}

bool Draft::redo() {
  if (done_ == history_.size()) {
    return false;
  }
  const std::vector<DraftChange::Step>& steps = history_[done_].steps;
  do_again(steps);
  try {
    scenario_ = read();
  } catch (...) {
    take_back(steps);
    throw;
  }
  ++done_;
  ++revision_;
  return true;
}

std::optional<std::string> Draft::undo_label() const {
  return done_ == 0 ? std::nullopt : std::optional(history_[done_ - 1].label);
}

std::optional<std::string> Draft::redo_label() const {
  return done_ == history_.size() ? std::nullopt : std::optional(history_[done_].label);
}

std::vector<Draft::ChangedFile> Draft::changed_files() const {
  std::vector<ChangedFile> changed;
  for (const auto& [name, text] : texts_.all()) {
    const auto saved = saved_.find(name);
    if (saved == saved_.end() || saved->second != text) {
      changed.push_back({name, saved == saved_.end() ? std::nullopt : std::optional(saved->second), text});
    }
  }
  return changed;
}

bool Draft::refresh() {
  constexpr std::size_t large = std::size_t{1} << 20U;  // a mesh
  std::set<std::string> in_history;
  for (const Entry& entry : history_) {
    for (const DraftChange::Step& step : entry.steps) {
      in_history.insert(step.file);
    }
  }
  std::map<std::string, SharedText> before;
  for (const auto& [name, saved] : saved_) {
    const std::string* const text = texts_.find(name);
    if (in_history.contains(name) || saved.str().size() > large || text == nullptr || *text != saved.str()) {
      continue;
    }
    if (std::optional<SharedText> now = disk_->read(name);
        now && *now != saved && now->str() != bytes_of_source(saved)) {
      before.emplace(name, saved);
      texts_.set(name, std::move(*now));
    }
  }
  if (before.empty()) {
    return false;
  }
  try {
    scenario_ = read();
  } catch (const InputError&) {
    for (auto& [name, text] : before) {
      texts_.set(name, std::move(text));
    }
    return false;
  }
  for (const auto& [name, text] : before) {
    saved_[name] = *texts_.read(name);
  }
  ++revision_;
  return true;
}

void Draft::read_again() {
  scenario_ = read();
  ++revision_;
}

void Draft::adopt(const std::string& name) {
  if (std::optional<SharedText> bytes = disk_->read(name)) {
    SharedText text = source_text(std::move(*bytes));
    saved_.insert_or_assign(name, text);
    texts_.set(name, std::move(text));
  }
}

void Draft::mark_saved() {
  // A file that a change has added, and that undo has taken out of the draft, stays on the disk as it was saved.
  for (const auto& [name, text] : texts_.all()) {
    saved_[name] = text;
  }
}

void Draft::rename_files(const std::map<std::string, std::string>& renamed, const std::filesystem::path& path,
                         FileSource& disk) {
  disk_ = &disk;
  texts_.set_disk(disk);
  const auto new_name = [&renamed](const std::string& name) {
    const auto found = renamed.find(name);
    return found == renamed.end() ? name : found->second;
  };
  const std::map<std::string, SharedText> texts = texts_.all();
  for (const auto& [name, text] : texts) {
    texts_.erase(name);
  }
  saved_.clear();
  for (const auto& [name, text] : texts) {
    texts_.set(new_name(name), text);
  }
  mark_saved();
  for (Entry& entry : history_) {
    for (DraftChange::Step& step : entry.steps) {
      step.file = new_name(step.file);
    }
  }
  scenario_.path = path.string();
  scenario_ = read();
}

}  // namespace proleg::sim
