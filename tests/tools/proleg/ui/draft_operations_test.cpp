#include "tools/proleg/ui/draft_operations.hpp"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "sim/authoring/library_items.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "sim/authoring/sensor_change.hpp"
#include "sim/authoring/world_clipboard.hpp"
#include "sim/authoring/world_contents.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

/// Random operations of all parts of a draft. Most of them fit it.
class RandomOperations {
 public:
  RandomOperations(unsigned seed, const sim::Draft& draft) : random_(seed), draft_(draft) {}

  std::size_t below(std::size_t bound) { return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random_); }
  double number() { return std::uniform_real_distribution<double>(-2.0, 2.0)(random_); }

  DraftOperation next() {
    const std::size_t joints = draft_.scenario().robot.joints.size();
    const std::size_t sensors = read_robot_contents(draft_).sensors.size();
    const std::size_t modules = sim::used_slots(draft_.scenario()).size();
    const std::size_t objects = read_world_contents(draft_).objects.size();
    const json some_joints = json::array({below(joints), below(joints)});
    switch (below(27)) {
      case 0:
        return robot("axis", {{"joints", some_joints}, {"value", {below(2), 0, 1}}});
      case 1:
        return robot("limits", {{"joints", some_joints}, {"lower", -90.0 * std::abs(number())}, {"upper", 60}});
      case 2:
        return robot("torque", {{"joints", some_joints}, {"value", number()}});
      case 3:
        return robot(joints > 8 ? "remove" : "duplicate", {{"joint", below(joints)}});
      case 4:
        return robot("remove", {{"joint", below(joints)}});
      case 5:
        return robot("count", {{"value", 1 + below(7)}});
      case 6: {
        std::vector<std::size_t> order(joints);
        for (std::size_t i = 0; i < joints; ++i) {
          order[i] = i;
        }
        std::ranges::shuffle(order, random_);
        return robot("order", {{"order", order}});
      }
      case 7:
        return robot("kind", {{"kind", sim::robot_kinds()[below(3)].name},
                              {"link", below(2) == 0 ? json() : json(below(joints + 1))}});
      case 8:
        return robot("add_sensor", {{"kind", below(2) == 0 ? "TactileSensor" : "Inclinometer"},
                                    {"part", below(joints)},
                                    {"place", sim::sensor_places()[below(6)]}});
      case 9:
        return robot("remove_sensor", {{"sensor", below(sensors + 1)}});
      case 10:
        return robot("rename_joint", {{"joint", below(joints)}, {"name", "knee " + std::to_string(below(4))}});
      case 11:
        return robot("servo", {{"name", "gain"}, {"value", 10.0 + number()}});
      case 12:
        return robot("mass", {{"link", below(joints + 1)}, {"value", number()}});
      case 13:
        return behaviour("add", {{"algorithm", "PatternGenerator_sinusoidal"}, {"joints", some_joints}});
      case 14:
        return behaviour("remove", {{"module", below(modules)}});
      case 15:
        return behaviour("joints", {{"module", below(modules)}, {"joints", some_joints}});
      case 16:
        return behaviour("algorithm", {{"module", below(modules)},
                                       {"algorithm", below(2) == 0 ? "DirectJointAccess" : "PatternGenerator_hopf"}});
      case 17:
        return behaviour("set", {{"module", below(modules)},
                                 {"parameter", "amplitude"},
                                 {"joints", some_joints},
                                 {"value", std::to_string(10 + below(30))}});
      case 18:
        return run_operation("draft.run", {{"name", "duration"}, {"value", 5.0 + number()}}, draft_);
      case 19:
        return run_operation("draft.run", {{"name", "engine"}, {"value", below(2) == 0 ? "ode" : "reduced"}}, draft_);
      case 20:
        return world("add", {{"item", sim::library()[below(sim::library().size())].name},
                             {"position", {number(), number(), 0}}});
      case 21:
        return world("remove", {{"objects", {below(objects)}}, {"group", below(2) == 0}});
      case 22:
        return robot("table", {{"joints",
                                {{{"joint", below(joints)}, {"name", "knee " + std::to_string(below(4))}},
                                 {{"joint", below(joints)}, {"torque", number()}, {"limits", {-60, 60}}}}},
                               {"count", below(3) == 0 ? json(1 + below(7)) : json()}});
      case 23:
        return world("paste",
                     {{"text", sim::copied_objects(draft_, {below(objects)})}, {"step", {0.25 + number() / 8, 0, 0}}});
      case 24:
        return robot("move", {{"joint", below(joints)}, {"to", below(joints)}});
      case 25:
        return world("friction", {{"object", below(objects)}, {"value", std::abs(number())}});
      default:
        return world("start", {{"position", {number(), number(), 0.1}}, {"degrees", {0, 0, 90.0 * number()}}});
    }
  }

 private:
  DraftOperation robot(const std::string& name, const json& words) {
    return robot_operation("robot." + name, words, draft_);
  }
  DraftOperation behaviour(const std::string& name, const json& words) {
    return behaviour_operation("behaviour." + name, words, draft_);
  }
  DraftOperation world(const std::string& name, const json& words) {
    return world_operation("world." + name, words, draft_);
  }

  std::mt19937 random_;
  const sim::Draft& draft_;
};

std::map<std::string, std::string> files_of(const sim::Draft& draft) {
  std::map<std::string, std::string> files;
  for (const sim::SourceFile& source : draft.scenario().sources) {
    files.emplace(source.path, draft.text(source.path));
  }
  return files;
}

// At each state all files are remembered; undo and redo must come back to them, whatever part a change was of.
TEST(DraftOperations, UndoAndRedoReturnToEveryEarlierStateOfAllParts) {
  constexpr unsigned seed = 4804;
  SCOPED_TRACE("seed " + std::to_string(seed));
  sim::SourceTexts texts;
  for (const sim::SourceFile& file : sim::new_scenario_files(sim::robot_kinds().front(), "pypy")) {
    texts.add(file.path, file.text);
  }
  sim::Draft draft(sim::read_scenario("robot.simulation.xml", texts), texts);
  RandomOperations random(seed, draft);
  std::vector<std::map<std::string, std::string>> states{files_of(draft)};
  std::size_t at = 0;
  std::size_t refused = 0;
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE("operation " + std::to_string(i));
    const std::size_t choice = random.below(8);
    if (choice == 0) {
      EXPECT_EQ(draft.undo(), at > 0);
      at -= at > 0 ? 1 : 0;
    } else if (choice == 1) {
      EXPECT_EQ(draft.redo(), at + 1 < states.size());
      at += at + 1 < states.size() ? 1 : 0;
    } else {
      const std::uint64_t revision = draft.revision();
      try {
        const DraftOperation operation = random.next();
        draft.change(operation.label, {}, operation.change);
      } catch (const InputError&) {
        ++refused;
        ASSERT_EQ(files_of(draft), states[at]) << "what is refused changes nothing";
        continue;
      }
      if (draft.revision() != revision) {
        states.resize(at + 1);
        states.push_back(files_of(draft));
        ++at;
      }
    }
    ASSERT_EQ(files_of(draft), states[at]);
  }
  EXPECT_GT(states.size(), 100U);
  EXPECT_LT(refused, 250U);
  while (draft.undo()) {
    ASSERT_EQ(files_of(draft), states[--at]);
  }
  EXPECT_EQ(at, 0U);
}

// Whatever a message has in its arguments, the answer is a change or one line.
TEST(DraftOperations, ArgumentsOfAnyKindAreTakenOrRefused) {
  constexpr unsigned seed = 11;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  const std::vector<json> values{json(),
                                 true,
                                 -1,
                                 0,
                                 1,
                                 2,
                                 1e99,
                                 -0.5,
                                 "p",
                                 "",

                                 json::array({0}),
                                 json({1, 2, 3}),
                                 json::array(),
                                 json::object(),
                                 json::array({"a"}),
                                 std::string(5000, 'x'),
                                 json({1e9, -1e9, 1e300}),
                                 "front",
                                 "TactileSensor",
                                 json::array({json{{"joint", 0}, {"torque", 0.5}}}),
                                 "<KinBody/>"};
  const std::vector<const char*> words{
      "joint", "joints",    "value",  "lower", "upper",     "name",    "link", "kind", "sensor", "part",   "place",
      "order", "algorithm", "module", "pose",  "parameter", "objects", "text", "step", "count",  "torque", "to"};
  const std::vector<const char*> names{
      "robot.axis",          "robot.limits",        "robot.torque",       "robot.speed",         "robot.rename_joint",
      "robot.rename",        "robot.servo",         "robot.mass",         "robot.friction",      "robot.duplicate",
      "robot.remove",        "robot.count",         "robot.order",        "robot.kind",          "robot.add_sensor",
      "robot.remove_sensor", "robot.rename_sensor", "robot.place_sensor", "robot.sensor_part",   "robot.set_sensor",
      "behaviour.add",       "behaviour.duplicate", "behaviour.remove",   "behaviour.algorithm", "behaviour.joints",
      "behaviour.set",       "robot.table",         "robot.move",         "world.paste",         "world.remove",
      "world.duplicate"};
  sim::SourceTexts texts;
  for (const sim::SourceFile& file : sim::new_scenario_files(sim::robot_kinds().front(), "pyp")) {
    texts.add(file.path, file.text);
  }
  sim::Draft draft(sim::read_scenario("robot.simulation.xml", texts), texts);
  std::size_t taken = 0;
  for (int i = 0; i < 2000; ++i) {
    json arguments = json::object();
    for (const char* const word : words) {
      if (below(2) == 0) {
        arguments[word] = values[below(values.size())];
      }
    }
    const std::string name = names[below(names.size())];
    const auto before = files_of(draft);
    try {
      const DraftOperation operation = reader_of(name)(name, arguments, draft);
      draft.change(operation.label, {}, operation.change);
      ++taken;
      draft.undo();
    } catch (const InputError&) {
    }
    ASSERT_EQ(files_of(draft), before) << name << ' ' << arguments.dump(-1, ' ', true, json::error_handler_t::replace);
  }
  EXPECT_GT(taken, 20U);
}

}  // namespace
}  // namespace proleg::tools
