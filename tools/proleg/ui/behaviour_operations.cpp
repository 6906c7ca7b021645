#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/behaviour_change.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/ui/draft_arguments.hpp"
#include "tools/proleg/ui/draft_operations.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
using sim::BehaviourChange;

DraftOperation behaviour(std::string label, const sim::Draft& draft, bool moves_positions,
                         std::function<void(BehaviourChange&)> change) {
  return {std::move(label),
          [&draft, change = std::move(change)](sim::DraftChange& edit) {
            BehaviourChange changed(draft.scenario(), edit);
            change(changed);
          },
          moves_positions};
}

unsigned module_of(const json& words) { return static_cast<unsigned>(position_of(words, "module")); }

DraftOperation add_module(const json& words, const sim::Draft& draft) {
  return behaviour("add " + text(words, "algorithm"), draft, true,
                   [algorithm = text(words, "algorithm"), joints = joints(words)](BehaviourChange& changed) {
                     changed.add(algorithm, joints);
                   });
}

DraftOperation copy_module(const json& words, const sim::Draft& draft) {
  return behaviour("copy module " + std::to_string(module_of(words) + 1), draft, true,
                   [module = module_of(words), joints = joints(words)](BehaviourChange& changed) {
                     changed.duplicate(module, joints);
                   });
}

DraftOperation remove_module(const json& words, const sim::Draft& draft) {
  return behaviour("delete module " + std::to_string(module_of(words) + 1), draft, true,
                   [module = module_of(words)](BehaviourChange& changed) { changed.remove(module); });
}

DraftOperation algorithm(const json& words, const sim::Draft& draft) {
  return behaviour("algorithm of module " + std::to_string(module_of(words) + 1), draft, true,
                   [module = module_of(words), name = text(words, "algorithm")](BehaviourChange& changed) {
                     changed.set_algorithm(module, name);
                   });
}

DraftOperation set_joints(const json& words, const sim::Draft& draft) {
  return behaviour("joints of module " + std::to_string(module_of(words) + 1), draft, false,
                   [module = module_of(words), joints = joints(words)](BehaviourChange& changed) {
                     changed.set_joints(module, joints);
                   });
}

DraftOperation set(const json& words, const sim::Draft& draft) {
  const std::string name = text(words, "parameter");
  return behaviour(name, draft, false,
                   [module = module_of(words), name, joints = joints(words), value = text(words, "value")](
                       BehaviourChange& changed) { changed.set_parameter(module, name, joints, value); });
}

/// Words as for `set`: "amplitude:J5=35".
DraftOperation set_values(const json& words, const sim::Draft& draft) {
  constexpr std::size_t most_label = 60;
  const auto all = argument<std::vector<std::string>>(words, "words", "words such as \"amplitude:J5=35\"");
  if (!all || all->empty()) {
    throw InputError("words", 0, "none", "words such as \"amplitude:J5=35\"");
  }
  std::vector<BehaviourChange::Value> values;
  for (const std::string& word : *all) {
    const sim::SettingTarget target = sim::find_target(draft.scenario(), word);
    if (target.internal || target.in_flight) {
      throw InputError(word, 0, target.internal ? "an internal value" : "a tick", "a parameter and its start value");
    }
    const Declaration& declaration = draft.scenario().kernel.slots[target.slot].algorithm->declaration();
    values.push_back({target.slot, std::string(declaration.parameters[target.number].name), target.joints,
                      word.substr(word.find('=') + 1)});
  }
  const std::string label = text(words, "label");
  return behaviour(label.empty() ? "values of parameters" : one_line(shortened(label, most_label)), draft, false,
                   [values = std::move(values)](BehaviourChange& changed) { changed.set_values(values); });
}

}  // namespace

DraftOperation behaviour_operation(const std::string& name, const json& arguments, const sim::Draft& draft) {
  using Reader = DraftOperation (*)(const json&, const sim::Draft&);
  static const std::map<std::string_view, Reader> readers{
      {"behaviour.add", add_module},      {"behaviour.duplicate", copy_module}, {"behaviour.remove", remove_module},
      {"behaviour.algorithm", algorithm}, {"behaviour.joints", set_joints},     {"behaviour.set", set},
      {"behaviour.values", set_values}};
  return handler_of(readers, name)(arguments, draft);
}

}  // namespace proleg::tools
