#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/run_change.hpp"
#include "tools/proleg/ui/draft_arguments.hpp"
#include "tools/proleg/ui/draft_operations.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

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

DraftOperation run_operation(const std::string& /*name*/, const json& arguments, const sim::Draft& draft) {
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
  const std::string value = argument<std::string>(arguments, "name", "the name of a value").value_or("");
  return {value,
          [change = handler_of(readers, value)(arguments), &draft](sim::DraftChange& edit) {
            sim::RunChange run(draft.scenario(), edit);
            change(run);
          },
          false, false};
}

DraftOperationReader reader_of(std::string_view operation) {
  if (operation == "draft.run") {
    return run_operation;
  }
  for (const auto& [begin, reader] : std::initializer_list<std::pair<std::string_view, DraftOperationReader>>{
           {world_operations, world_operation},
           {draft_robot_operations, robot_operation},
           {behaviour_operations, behaviour_operation}}) {
    if (operation.starts_with(begin)) {
      return reader;
    }
  }
  return nullptr;
}

}  // namespace proleg::tools
