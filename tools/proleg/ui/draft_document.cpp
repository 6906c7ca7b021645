#include "tools/proleg/ui/draft_document.hpp"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
using sim::WorldChange;

json shape_json(const sim::WorldShape& shape) {
  return {{"type", shape.type},
          {"size", shape.size},
          {"friction", shape.friction ? json(*shape.friction) : json()},
          {"colour", shape.colour ? vector_json(*shape.colour) : json()}};
}

json object_json(const sim::WorldObject& object) {
  json shapes = json::array();
  for (const sim::WorldShape& shape : object.shapes) {
    shapes.push_back(shape_json(shape));
  }
  return {{"name", object.name},
          {"file", object.file},
          {"line", object.line},
          {"editable", object.body.has_value()},
          {"group", object.group ? json(*object.group) : json()},
          {"group_size", object.group_size},
          {"moves", object.moves},
          {"index", object.index},
          {"mass", object.moves ? json(object.mass) : json()},
          {"pose", pose_json(object.pose)},
          {"shapes", std::move(shapes)}};
}

// The arguments of operations.

double number(const json& arguments, const char* name) {
  const auto value = argument<double>(arguments, name, "a number");
  if (!value) {
    throw InputError(name, 0, "none", "a number");
  }
  return *value;
}

std::vector<double> numbers(const json& arguments, const char* name) {
  return argument<std::vector<double>>(arguments, name, "numbers").value_or(std::vector<double>{});
}

Eigen::Vector3d vector(const json& arguments, const char* name) {
  const std::vector<double> values = numbers(arguments, name);
  if (values.size() != 3) {
    throw InputError(name, 0, std::to_string(values.size()) + " numbers", "three numbers");
  }
  return {values[0], values[1], values[2]};
}

/// The pose in the argument `pose`: [x, y, z, qw, qx, qy, qz].
sim::Pose pose(const json& arguments) {
  const std::vector<double> values = numbers(arguments, "pose");
  if (values.size() != 7) {
    throw InputError("pose", 0, std::to_string(values.size()) + " numbers", "x, y, z, and a quaternion w, x, y, z");
  }
  const Eigen::Quaterniond turn(values[3], values[4], values[5], values[6]);
  constexpr double least_norm = 1e-3;
  constexpr double greatest_norm = 1e3;
  if (!(turn.norm() >= least_norm && turn.norm() <= greatest_norm)) {
    throw InputError("pose", 0, "a quaternion of the length " + number_text(turn.norm()), "one of the length 1");
  }
  return {{values[0], values[1], values[2]}, turn.normalized()};
}

std::size_t position_of(const json& arguments, const char* name) {
  const auto position = argument<std::uint32_t>(arguments, name, "a position in the list");
  if (!position) {
    throw InputError(name, 0, "none", "a position in the list");
  }
  return *position;
}

bool is_set(const json& arguments, const char* name) {
  return argument<bool>(arguments, name, "true or false").value_or(false);
}

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

WorldOperation remove(const json& arguments, const sim::WorldContents& world) {
  return {"delete " + name_of(arguments, world),
          [object = position_of(arguments, "object"), group = is_set(arguments, "group")](WorldChange& change) {
            change.remove(object, group);
          }};
}

WorldOperation duplicate(const json& arguments, const sim::WorldContents& world) {
  return {
      "duplicate " + name_of(arguments, world),
      [object = position_of(arguments, "object"), group = is_set(arguments, "group"), step = vector(arguments, "step"),
       count = argument<std::uint32_t>(arguments, "count", "a whole number").value_or(1)](WorldChange& change) {
        change.duplicate(object, group, step, count);
      }};
}

WorldOperation add(const json& arguments, const sim::WorldContents& /*world*/) {
  const auto name = argument<std::string>(arguments, "item", "the name of an item of the library").value_or("");
  for (const sim::LibraryDeclaration& declaration : sim::library()) {
    if (declaration.name == name) {
      return {"add " + name,
              [item = declaration.item,
               values = argument<std::map<std::string, double>>(arguments, "values", "numbers by their names")
                            .value_or(std::map<std::string, double>{}),
               position = vector(arguments, "position"),
               turn = argument<double>(arguments, "turn", "degrees").value_or(0.0)](WorldChange& change) {
                change.add(item, values, position, turn);
              }};
    }
  }
  throw InputError("item", 0, in_quotes(name), "an item of the library");
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

/// The argument `value` of draft.run.
std::string word(const json& arguments) { return argument<std::string>(arguments, "value", "a word").value_or(""); }

sim::PhysicsEngine engine(const json& arguments) {
  const std::string text = word(arguments);
  const std::optional<sim::PhysicsEngine> found = sim::engine_named(text);
  if (!found) {
    throw InputError("value", 0, in_quotes(text), sim::engine_words());
  }
  return *found;
}

sim::Solver solver(const json& arguments) {
  const std::string text = word(arguments);
  const std::optional<sim::Solver> found = sim::solver_named(text);
  if (!found) {
    throw InputError("value", 0, in_quotes(text), "'automatic', 'direct' or 'iterative'");
  }
  return *found;
}

/// Numbers of JSON do not have all seeds.
std::uint64_t seed(const json& arguments) {
  const std::string text = word(arguments);
  const std::optional<std::uint64_t> number = parse_whole<std::uint64_t>(text);
  if (!number) {
    throw InputError("value", 0, in_quotes(text), "a whole number from 0 to 18446744073709551615, as a text");
  }
  return *number;
}

}  // namespace

json run_json(const sim::Scenario& scenario) {
  const sim::EnvironmentModel& environment = scenario.environment;
  return {{"duration", scenario.duration_s},
          {"seed", std::to_string(scenario.kernel.seed)},
          {"tick", scenario.kernel.tick_period_us / 1e3},
          {"step", scenario.step_s * 1e3},
          {"solver", sim::word_of(scenario.solver)},
          {"contact_noise", scenario.contact_noise},
          {"engine", sim::name_of(environment.engine)},
          {"gravity", vector_json(environment.gravity)},
          {"self_collision", environment.self_collision}};
}

RunOperation run_operation(const json& arguments) {
  using Change = std::function<void(sim::RunChange&)>;
  using Reader = Change (*)(const json&);
  static const std::map<std::string_view, Reader> readers{
      {"duration",
       [](const json& words) -> Change {
         return [value = number(words, "value")](sim::RunChange& run) { run.set_duration(value); };
       }},
      {"seed",
       [](const json& words) -> Change { return [value = seed(words)](sim::RunChange& run) { run.set_seed(value); }; }},
      {"tick",
       [](const json& words) -> Change {
         return [value = number(words, "value")](sim::RunChange& run) { run.set_tick(value); };
       }},
      {"step",
       [](const json& words) -> Change {
         return [value = number(words, "value")](sim::RunChange& run) { run.set_step(value); };
       }},
      {"solver",
       [](const json& words) -> Change {
         return [value = solver(words)](sim::RunChange& run) { run.set_solver(value); };
       }},
      {"contact_noise",
       [](const json& words) -> Change {
         return [value = number(words, "value")](sim::RunChange& run) { run.set_contact_noise(value); };
       }},
      {"engine",
       [](const json& words) -> Change {
         return [value = engine(words)](sim::RunChange& run) { run.set_engine(value); };
       }},
      {"gravity",
       [](const json& words) -> Change {
         return [value = vector(words, "value")](sim::RunChange& run) { run.set_gravity(value); };
       }},
      {"self_collision", [](const json& words) -> Change {
         return [value = is_set(words, "value")](sim::RunChange& run) { run.set_self_collision(value); };
       }}};
  const std::string name = argument<std::string>(arguments, "name", "the name of a value").value_or("");
  return {name, handler_of(readers, name)(arguments)};
}

json world_json(const sim::WorldContents& world) {
  json objects = json::array();
  for (const sim::WorldObject& object : world.objects) {
    objects.push_back(object_json(object));
  }
  json rulers = json::array();
  for (const sim::WorldRuler& ruler : world.rulers) {
    rulers.push_back({{"from", vector_json(ruler.from)}, {"to", vector_json(ruler.to)}});
  }
  return {{"file", world.file},
          {"objects", std::move(objects)},
          {"rulers", std::move(rulers)},
          {"start", {{"position", vector_json(world.start)}, {"degrees", vector_json(world.start_degrees)}}}};
}

json library_json() {
  json items = json::array();
  for (const sim::LibraryDeclaration& declaration : sim::library()) {
    json parameters = json::array();
    for (const sim::LibraryParameter& parameter : declaration.parameters) {
      parameters.push_back({{"name", parameter.name},
                            {"help", parameter.help},
                            {"unit", parameter.unit},
                            {"lowest", parameter.lowest},
                            {"highest", parameter.highest},
                            {"usual", parameter.usual},
                            {"whole", parameter.is_whole}});
    }
    items.push_back({{"name", declaration.name}, {"help", declaration.help}, {"parameters", std::move(parameters)}});
  }
  return items;
}

WorldOperation world_operation(const std::string& name, const json& arguments, const sim::WorldContents& world) {
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
  return handler_of(readers, name)(arguments, world);
}

}  // namespace proleg::tools
