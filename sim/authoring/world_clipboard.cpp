#include "sim/authoring/world_clipboard.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/authoring/world_change.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

constexpr const char* clipboard = "clipboard";
constexpr std::string_view outer_tag = "objects";
/// Tags of a <Geom> that can name a file.
constexpr std::array<std::string_view, 3> file_tags{"data", "collision", "render"};

[[noreturn]] void refuse_clipboard(const std::string& found) {
  throw InputError(clipboard, 0, found, "objects of a world, as Copy makes them");
}

std::string without_comments(std::string text) {
  for (std::size_t begin = text.find("<!--"); begin != std::string::npos; begin = text.find("<!--", begin)) {
    const std::size_t end = text.find("-->", begin);
    text.erase(begin, end == std::string::npos ? end : end + 3 - begin);
  }
  return text;
}

/// The name of a file in a text such as "stone.stl 0.001".
std::string_view without_factors(std::string_view text) {
  for (text = trimmed(text);; text = trimmed(text)) {
    const std::size_t blank = text.find_last_of(" \t\r\n");
    if (blank == std::string_view::npos || !parse_number(text.substr(blank + 1))) {
      return text;
    }
    text = text.substr(0, blank);
  }
}

/// Whether the draft has a file, which the environment names so. The disk is not asked.
bool has_file(const DraftChange& change, const std::string& environment, std::string_view file) {
  return change.text(name_of(std::filesystem::path(environment).parent_path() / file)) != nullptr;
}

/// Of all elements, as the reader's parser has them: a text that looks different to another parser hides nothing.
void require_known_files(const XmlElement& element, const DraftChange& change, const std::string& environment) {
  if (const auto file = element.attribute("file")) {
    refuse_clipboard(element.label() + " that names the file " + in_quotes(one_line(shortened(*file))));
  }
  for (const std::string_view tag : file_tags) {
    if (element.is(tag) && !has_file(change, environment, without_factors(element.text()))) {
      throw InputError(clipboard, 0, element.label() + " with " + in_quotes(one_line(shortened(element.text()))),
                       "a mesh that this scenario has already; add it here by itself");
    }
  }
  for (const XmlElement& child : element.children()) {
    require_known_files(child, change, environment);
  }
}

/// The poses of all bodies of a text, as far as their tags and those around them give them.
std::vector<Eigen::Vector3d> places_of_bodies(const XmlText& xml) {
  std::vector<Eigen::Vector3d> positions;
  for (ElementNumber i = 1; i < xml.size(); ++i) {
    if (!xml.is(i, "Body")) {
      continue;
    }
    Pose pose;
    for (ElementNumber at = i; at != 0; at = xml.at(at).parent.value_or(0)) {
      pose = pose_of(xml, at) * pose;
    }
    positions.push_back(pose.position);
  }
  return positions;
}

/// How far the objects go so that none stands where one of the world does.
Eigen::Vector3d free_shift(const WorldContents& world, const std::vector<Eigen::Vector3d>& positions,
                           const Eigen::Vector3d& step) {
  constexpr double same_place = 1e-4;  // m
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  const auto is_taken = [&](const Eigen::Vector3d& place) {
    return std::ranges::any_of(world.objects, [&](const WorldObject& object) {
      return (object.pose.position - place - shift).norm() < same_place;
    });
  };
  // Each object of the world is passed once at most.
  for (std::size_t i = 0; i <= world.objects.size() && std::ranges::any_of(positions, is_taken); ++i) {
    shift += step;
  }
  return shift;
}

}  // namespace

std::string copied_objects(const Draft& draft, const std::vector<std::size_t>& objects) {
  const WorldContents world = read_world_contents(draft);
  const XmlText xml(world.file, draft.text(world.file));
  std::string text;
  for (const ElementNumber element : elements_of(world, objects, true)) {
    text += without_comments(unindented(xml, element)) + "\n";
    if (text.size() > max_copied_bytes) {
      throw InputError("objects", 0, "more than " + std::to_string(max_copied_bytes >> 10U) + " KiB of text",
                       "fewer or smaller objects at once");
    }
  }
  return text;
}

void paste_objects(const WorldContents& world, DraftChange& change, std::string_view text,
                   const Eigen::Vector3d& step) {
  if (text.size() > max_copied_bytes) {
    throw InputError(clipboard, 0, "more than " + std::to_string(max_copied_bytes >> 10U) + " KiB of text",
                     "fewer or smaller objects");
  }
  if (!trimmed(text).starts_with('<')) {
    refuse_clipboard(trimmed(text).empty() ? "no text" : in_quotes(one_line(shortened(std::string(trimmed(text))))));
  }
  for (const std::string_view markup : {"<!", "<?"}) {
    if (text.find(markup) != std::string_view::npos) {
      refuse_clipboard("a text with " + in_quotes(markup));
    }
  }
  if (!step.allFinite() || step.norm() < 1e-3 || step.norm() > 1e3) {
    throw InputError("step", 0, "a step of " + number_text(step.norm()) + " m", "0.001 to 1000 m");
  }
  const std::string wrapped =
      "<" + std::string(outer_tag) + ">\n" + std::string(text) + "\n</" + std::string(outer_tag) + ">";
  const XmlText xml(clipboard, wrapped);
  const XmlDocument document(clipboard, wrapped, nullptr);
  const XmlElement root = document.root(outer_tag);
  root.allow({}, {"KinBody"});
  require_known_files(root, change, world.file);
  const std::vector<ElementNumber> elements = xml.children(0);
  if (elements.empty() || elements.size() != root.children().size() || xml.at(0).end != wrapped.size()) {
    refuse_clipboard("a text without whole elements");
  }
  const Eigen::Vector3d shift = free_shift(world, places_of_bodies(xml), step);
  for (const ElementNumber element : elements) {
    Pose pose = pose_of(xml, element);
    pose.position += shift;
    const ElementNumber added = add_object(change, world.file, unindented(xml, element));
    set_pose(change, world.file, added, pose);
  }
}

}  // namespace proleg::sim
