#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/world_change.hpp"
#include "sim/authoring/world_clipboard.hpp"
#include "tools/proleg/ui/draft_arguments.hpp"
#include "tools/proleg/ui/draft_operations.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
using sim::WorldChange;

struct WorldOperation {
  std::string label;
  std::function<void(WorldChange&)> change;
};

std::string name_of(const json& arguments, const sim::WorldContents& world) {
  const std::size_t object = position_of(arguments, "object");
  return object < world.objects.size() ? world.objects[object].name : std::string("an object");
}

WorldOperation place(const json& arguments, const sim::WorldContents& world) {
  return {"move " + name_of(arguments, world),
          [object = position_of(arguments, "object"), pose = pose(arguments),
           group = is_set(arguments, "group")](WorldChange& change) { change.place(object, pose, group); }};
}

WorldOperation resize(const json& arguments, const sim::WorldContents& world) {
  return {"resize " + name_of(arguments, world),
          [object = position_of(arguments, "object"), shape = position_of(arguments, "shape"),
           size = numbers(arguments, "size")](WorldChange& change) { change.set_size(object, shape, size); }};
}

WorldOperation friction(const json& arguments, const sim::WorldContents& world) {
  return {
      "friction of " + name_of(arguments, world),
      [object = position_of(arguments, "object"), value = argument<double>(arguments, "value", "a number, or null")](
          WorldChange& change) { change.set_friction(object, value); }};
}

WorldOperation colour(const json& arguments, const sim::WorldContents& world) {
  return {"colour of " + name_of(arguments, world),
          [object = position_of(arguments, "object"), value = vector(arguments, "value")](WorldChange& change) {
            change.set_colour(object, value);
          }};
}

WorldOperation moves(const json& arguments, const sim::WorldContents& world) {
  const bool value = is_set(arguments, "value");
  return {(value ? "let move " : "fix ") + name_of(arguments, world),
          [object = position_of(arguments, "object"), value](WorldChange& change) { change.set_moves(object, value); }};
}

WorldOperation mass(const json& arguments, const sim::WorldContents& world) {
  return {"mass of " + name_of(arguments, world),
          [object = position_of(arguments, "object"), value = number(arguments, "value")](WorldChange& change) {
            change.set_mass(object, value);
          }};
}

WorldOperation rename(const json& arguments, const sim::WorldContents& world) {
  return {"rename " + name_of(arguments, world),
          [object = position_of(arguments, "object"),
           name = argument<std::string>(arguments, "name", "a text").value_or("")](WorldChange& change) {
            change.rename(object, name);
          }};
}

/// "box", or "3 objects"; the parts of a group count as one.
std::string name_of_all(const json& arguments, const sim::WorldContents& world) {
  const std::vector<std::size_t> all = positions(arguments, "objects");
  return all.size() == 1 && all.front() < world.objects.size() ? world.objects[all.front()].name
                                                               : std::to_string(all.size()) + " objects";
}

WorldOperation remove(const json& arguments, const sim::WorldContents& world) {
  return {"delete " + name_of_all(arguments, world),
          [objects = positions(arguments, "objects"), group = is_set(arguments, "group")](WorldChange& change) {
            change.remove(objects, group);
          }};
}

WorldOperation duplicate(const json& arguments, const sim::WorldContents& world) {
  return {
      "duplicate " + name_of_all(arguments, world),
      [objects = positions(arguments, "objects"), group = is_set(arguments, "group"), step = vector(arguments, "step"),
       count = argument<std::uint32_t>(arguments, "count", "a whole number").value_or(1)](WorldChange& change) {
        change.duplicate(objects, group, step, count);
      }};
}

WorldOperation add(const json& arguments, const sim::WorldContents& /*world*/) {
  const std::string name = text(arguments, "item");
  const sim::LibraryDeclaration* const declaration = sim::find_library_item(name);
  if (declaration == nullptr) {
    throw InputError("item", 0, in_quotes(name), "an item of the library");
  }
  return {"add " + name,
          [item = declaration->item,
           values = argument<std::map<std::string, double>>(arguments, "values", "numbers by their names")
                        .value_or(std::map<std::string, double>{}),
           position = vector(arguments, "position"),
           turn = argument<double>(arguments, "turn", "degrees").value_or(0.0)](WorldChange& change) {
            change.add(item, values, position, turn);
          }};
}

WorldOperation start(const json& arguments, const sim::WorldContents& /*world*/) {
  return {"move the start", [position = vector(arguments, "position"), degrees = vector(arguments, "degrees")](
                                WorldChange& change) { change.set_start(position, degrees); }};
}

WorldOperation ruler(const json& arguments, const sim::WorldContents& /*world*/) {
  const auto number = argument<std::uint32_t>(arguments, "ruler", "a position in the list, or null for a new one");
  return {number ? "move ruler" : "add ruler",
          [number, from = vector(arguments, "from"), to = vector(arguments, "to")](WorldChange& change) {
            if (number) {
              change.set_ruler(*number, from, to);
            } else {
              change.add_ruler(from, to);
            }
          }};
}

WorldOperation remove_ruler(const json& arguments, const sim::WorldContents& /*world*/) {
  return {"delete ruler",
          [number = position_of(arguments, "ruler")](WorldChange& change) { change.remove_ruler(number); }};
}

}  // namespace

DraftOperation world_operation(const std::string& name, const json& arguments, const sim::Draft& draft) {
  auto world = std::make_shared<const sim::WorldContents>(read_world_contents(draft));
  if (name == "world.paste") {
    return {"paste objects",
            [world, pasted = text(arguments, "text"), step = vector(arguments, "step")](sim::DraftChange& edit) {
              paste_objects(*world, edit, pasted, step);
            },
            false, false};
  }
  using Reader = WorldOperation (*)(const json&, const sim::WorldContents&);
  static const std::map<std::string_view, Reader> readers{{"world.place", place},
                                                          {"world.resize", resize},
                                                          {"world.friction", friction},
                                                          {"world.colour", colour},
                                                          {"world.moves", moves},
                                                          {"world.mass", mass},
                                                          {"world.rename", rename},
                                                          {"world.remove", remove},
                                                          {"world.duplicate", duplicate},
                                                          {"world.add", add},
                                                          {"world.start", start},
                                                          {"world.ruler", ruler},
                                                          {"world.remove_ruler", remove_ruler}};
  WorldOperation operation = handler_of(readers, name)(arguments, *world);
  return {std::move(operation.label), [world, change = std::move(operation.change)](sim::DraftChange& edit) {
            WorldChange world_change(*world, edit);
            change(world_change);
          }};
}

}  // namespace proleg::tools
