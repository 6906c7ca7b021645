#include "tools/proleg/ui/gallery.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <string_view>
#include <utility>

#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/actuation_reader.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"
#include "tools/proleg/ui/gait_preview.hpp"
#include "tools/proleg/ui/scenario_picture.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr std::size_t most_text = 240;  // characters

/// How the comment of a file begins that says nothing about the scenario: `proleg new robot` writes it.
constexpr std::string_view general_comment = "The top-level file:";

/// The comment before the first element of a file, in one line; empty if there is none.
std::string first_comment(std::string_view text) {
  constexpr std::string_view begin = "<!--";
  constexpr std::string_view end = "-->";
  const std::size_t first = text.find(begin);
  const std::size_t last = first == std::string_view::npos ? first : text.find(end, first);
  if (last == std::string_view::npos) {
    return {};
  }
  std::string_view before = trimmed(without_byte_order_mark(text.substr(0, first)));
  const bool is_first = before.empty() || (before.starts_with("<?xml") && before.find('>') == before.size() - 1);
  std::string comment;
  for (const std::string_view word : words(text.substr(first + begin.size(), last - first - begin.size()))) {
    comment.append(comment.empty() ? "" : " ").append(word);
  }
  return is_first ? one_line(comment) : std::string();
}

/// "The travelling wave." for "Forward: the travelling wave.", where the title says the rest.
std::string without_title(std::string text, const std::string& title) {
  if (text.starts_with(title + ": ")) {
    text.erase(0, title.size() + 2);
    if (!text.empty() && text.front() >= 'a' && text.front() <= 'z') {
      text.front() = static_cast<char>(text.front() - 'a' + 'A');
    }
  }
  return text;
}

/// What a file says about its scenario, or else the file with its gait.
std::string text_of(const sim::Scenario& scenario, const std::string& title) {
  std::string text = first_comment(scenario.sources.front().text);
  if (text.empty() || text.starts_with(general_comment)) {
    const auto gait = std::ranges::find(scenario.sources, scenario.actuation_file, &sim::SourceFile::path);
    text = gait == scenario.sources.end() ? std::string() : first_comment(gait->text);
  }
  return shortened(without_title(std::move(text), title), most_text);
}

std::vector<std::string> algorithms_of(const sim::Scenario& scenario) {
  std::vector<std::string> names;
  for (const unsigned slot : sim::used_slots(scenario)) {
    std::string name(scenario.kernel.slots[slot].algorithm->declaration().name);
    if (std::ranges::find(names, name) == names.end()) {
      names.push_back(std::move(name));
    }
  }
  return names;
}

std::string hash_of(const sim::Scenario& scenario) {
  std::string all;
  for (const sim::SourceFile& source : scenario.sources) {
    all.append(sha256_hex(source.path)).append(sha256_hex(source.text));
  }
  return sha256_hex(all);
}

json entry_of(const ProjectFile& file) {
  return {{"file", file.file}, {"folder", file.group},          {"title", file.title},     {"text", file.text},
          {"joints", json()},  {"algorithms", json::array()},   {"distance", json()},      {"failure", json()},
          {"picture", json()}, {"is_shipped", file.is_shipped}, {"missing", json::array()}};
}

}  // namespace

Gallery::Gallery(const ProjectFiles& files, SessionRequests& requests, host::SessionOutput& output,
                 GalleryOptions options)
    : SessionThread(requests, output), files_(files), options_(options) {
  begin_thread();
}

Gallery::~Gallery() { end_thread(); }

void Gallery::serve() {
  if (!std::exchange(has_low_priority_, true)) {
    lower_thread_priority();
  }
  take_operations();
  if (std::exchange(is_wanted_, false)) {
    list();
  } else if (next_ < shown_.size()) {
    describe(shown_[next_]);
    ++next_;
    if (next_ == shown_.size() || Clock::now() >= publish_at_) {
      publish();
    }
  } else {
    requests_.wait();
  }
}

/// What cannot be described is left out until the next look.
void Gallery::fail(const std::string& /*why*/) { ++next_; }

json Gallery::carry_out(const host::OperationRequest& operation) {
  using Handler = json (*)(Gallery&);
  static const std::map<std::string_view, Handler> handlers{{"gallery.look", [](Gallery& gallery) {
                                                               gallery.is_wanted_ = true;
                                                               return json::object();
                                                             }}};
  return handler_of(handlers, operation.name)(*this);
}

void Gallery::list() {
  shown_ = files_.list();
  next_ = 0;
  std::map<std::string, Known> before = std::exchange(known_, {});
  for (const ProjectFile& file : shown_) {
    Known& known = known_[file.file];
    if (const auto found = before.find(file.file); found != before.end()) {
      known = std::move(found->second);
      known.entry["folder"] = file.group;
      known.entry["title"] = file.title;
    } else {
      known.entry = entry_of(file);
    }
  }
  publish();
}

void Gallery::describe(const ProjectFile& file) {
  Known& known = known_.at(file.file);
  json entry = entry_of(file);
  std::string hash;
  try {
    sim::DiskFiles disk;
    const sim::Scenario scenario = sim::read_scenario(file.file, disk);
    hash = hash_of(scenario);
    if (hash == known.hash) {
      return;
    }
    if (file.text.empty()) {
      entry["text"] = text_of(scenario, file.title);
    }
    entry["joints"] = scenario.robot.joints.size();
    entry["algorithms"] = algorithms_of(scenario);
    const auto ends = [this] {
      take_operations();  // another look is answered meanwhile
      return requests_.ends();
    };
    const GaitPreview preview = preview_of(scenario, options_.longest_run, ends);
    if (preview.distance) {
      entry["distance"] = std::round(*preview.distance * 100.0) / 100.0;
    }
    entry["picture"] = picture_json(scenario, preview);
  } catch (const sim::UnknownAlgorithms& error) {
    entry["failure"] = one_line(error.what());
    for (const std::string& name : error.names()) {
      entry["missing"].push_back(one_line(name));
    }
  } catch (const std::exception& error) {
    entry["failure"] = one_line(error.what());
  }
  known = {std::move(hash), std::move(entry)};
}

void Gallery::publish() {
  json entries = json::array();
  for (const ProjectFile& file : shown_) {
    entries.push_back(known_.at(file.file).entry);
  }
  output_.publish("gallery", {{"entries", std::move(entries)}});
  publish_at_ = Clock::now() + options_.publish_period;
}

}  // namespace proleg::tools
