#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/behaviour_change.hpp"
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

}  // namespace

DraftOperation behaviour_operation(const std::string& name, const json& arguments, const sim::Draft& draft) {
  using Reader = DraftOperation (*)(const json&, const sim::Draft&);
  static const std::map<std::string_view, Reader> readers{
      {"behaviour.add", add_module},      {"behaviour.duplicate", copy_module}, {"behaviour.remove", remove_module},
      {"behaviour.algorithm", algorithm}, {"behaviour.joints", set_joints},     {"behaviour.set", set}};
  return handler_of(readers, name)(arguments, draft);
}

}  // namespace proleg::tools
