#include "sim/authoring/robot_elements.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

constexpr int max_depth = 32;  // as the reader has it

class Walk {
 public:
  Walk(const XmlText& robot, const std::string& top, const TextOf& text_of)
      : robot_(robot), top_(top), text_of_(text_of) {}

  RobotElements run() {
    visit(robot_, 0, {});
    // What places several links places none of them alone.
    std::map<ElementNumber, unsigned> counts;
    for (const auto& entry : found_.links) {
      if (entry.second.place) {
        ++counts[*entry.second.place];
      }
    }
    for (auto& entry : found_.links) {
      if (std::optional<ElementNumber>& place = entry.second.place; place && counts[*place] > 1) {
        place.reset();
      }
    }
    return std::move(found_);
  }

 private:
  struct Scope {
    std::string outer;  ///< prefixes of the elements around the place
    std::string inner;  ///< prefixes of the place and of those in it
    std::optional<ElementNumber> place;
    int depth = 0;
  };

  [[nodiscard]] static bool has_one_body(const XmlText& xml, ElementNumber element) {
    return xml.children(element, "Body").size() == 1 && xml.children(element, "KinBody").empty() &&
           xml.children(element, "Joint").empty();
  }

  void visit(const XmlText& xml, ElementNumber element, Scope scope) {
    if (++scope.depth > max_depth) {
      return;
    }
    const std::string prefix = xml.attribute(element, "prefix").value_or("");
    const std::optional<std::string> file = xml.attribute(element, "file");
    const bool is_robot = &xml == &robot_;
    if (is_robot && (file || has_one_body(xml, element))) {
      scope.place = element;
    }
    (scope.place ? scope.inner : scope.outer) += prefix;
    if (file) {
      if (const XmlText* const named = open(xml, *file)) {
        visit(*named, 0, scope);
      }
      return;
    }
    for (const ElementNumber child : xml.children(element)) {
      if (xml.is(child, "KinBody")) {
        visit(xml, child, scope);
      } else if (xml.is(child, "Body")) {
        const std::string body = scope.inner + xml.attribute(child, "name").value_or("");
        const bool is_placed_alone = is_robot && !scope.place;
        const std::string place_prefix =
            scope.place ? robot_.attribute(*scope.place, "prefix").value_or("") : std::string();
        found_.links.insert_or_assign(
            scope.outer + body, LinkElements{xml.name(), child, body.substr(std::min(body.size(), place_prefix.size())),
                                             is_placed_alone ? child : scope.place, scope.outer});
      } else if (xml.is(child, "Joint") && is_robot) {
        const std::string prefixes = scope.outer + scope.inner;
        found_.joints.insert_or_assign(prefixes + xml.attribute(child, "name").value_or(""),
                                       JointElements{child, prefixes});
      }
    }
  }

  /// A file that an element names: beside the file with the element, or beside the top-level file.
  const XmlText* open(const XmlText& xml, const std::string& reference) {
    for (const std::string& beside : {xml.name(), top_}) {
      const std::string name = name_of(std::filesystem::path(beside).parent_path() / reference);
      const auto known = files_.find(name);
      if (known != files_.end()) {
        return known->second.get();
      }
      if (const std::string* const text = text_of_(name)) {
        return files_.emplace(name, std::make_unique<XmlText>(name, *text)).first->second.get();
      }
    }
    return nullptr;
  }

  const XmlText& robot_;
  const std::string& top_;
  const TextOf& text_of_;
  std::map<std::string, std::unique_ptr<XmlText>> files_;
  RobotElements found_;
};

}  // namespace

RobotElements find_robot_elements(const XmlText& robot, const std::string& top, const TextOf& text_of) {
  return Walk(robot, top, text_of).run();
}

RobotElements find_robot_elements(DraftChange& change, const Scenario& scenario) {
  return find_robot_elements(change.xml(scenario.robot_file), scenario.path,
                             [&change](const std::string& name) { return change.text(name); });
}

}  // namespace proleg::sim
