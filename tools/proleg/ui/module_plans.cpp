#include "tools/proleg/ui/module_plans.hpp"

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "host/robot/object_word.hpp"
#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Output = ModuleJobPlan::Output;

/// The restart of a gateway with its trials, as `proleg flash` waits for it.
constexpr std::chrono::seconds longest_loss_of_update{60};
constexpr const char* store_object = "0x1010:1";
constexpr const char* save_word = "0x65766173";

bool flag_in(const json& arguments, const char* name) {
  return argument<bool>(arguments, name, "true or false").value_or(false);
}

std::string node_in(const json& arguments) {
  const auto node = required_argument<std::uint32_t>(arguments, "node", "a node id");
  constexpr std::uint32_t highest = 126;
  if (node < 1 || node > highest) {
    throw InputError("node", 0, std::to_string(node), "1 to 126");
  }
  return std::to_string(node);
}

/// A number that a program takes.
std::optional<std::string> number_in(const json& arguments, const char* name, const char* unit, double lowest,
                                     double highest) {
  const auto number = argument<double>(arguments, name, unit);
  if (number && !(*number >= lowest && *number <= highest)) {
    throw InputError(name, 0, number_text(*number), number_text(lowest) + " to " + number_text(highest) + " " + unit);
  }
  return number ? std::optional(number_text(*number)) : std::nullopt;
}

/// Node ids such as 1,3 or all.
std::string nodes_in(const json& arguments, const char* expected) {
  std::string word = word_in(arguments, "nodes", expected);
  static_cast<void>(host::parse_nodes(word, "nodes"));
  return word;
}

/// The libraries with algorithms of users that this program has.
void add_algorithms(std::vector<std::string>& words) {
  for (const std::string& library : loaded_libraries()) {
    words.insert(words.end(), {"--algorithms", library});
  }
}

}  // namespace

std::string word_in(const json& arguments, const char* name, const char* expected) {
  const auto word = required_argument<std::string>(arguments, name, expected);
  constexpr std::size_t longest = 200;
  if (word.empty() || word.size() > longest || word.starts_with("-") || !is_visible_line(word)) {
    throw InputError(name, 0, in_quotes(one_line(word)), expected);
  }
  return word;
}

ModuleJobPlan plan_of(std::string kind, std::vector<std::string> words, const host::OperationRequest& request,
                      Output output) {
  ModuleJobPlan plan;
  plan.kind = std::move(kind);
  plan.words = std::move(words);
  plan.by = request.client_name;
  plan.output = output;
  return plan;
}

ModuleJobPlan plan_of_look() {
  ModuleJobPlan plan = plan_of("scan", {"scan", "--json"}, {});
  plan.gives_way = true;
  return plan;
}

std::vector<std::string> store_words(const json& arguments) {
  return {"set", node_in(arguments), store_object, save_word};
}

ModuleJobPlan ModulePlans::scan(const Request& request) const { return plan_of("scan", {"scan", "--json"}, request); }

ModuleJobPlan ModulePlans::examine(const Request& request) const {
  std::vector<std::string> words{"doctor", "--json"};
  add_algorithms(words);
  return plan_of("examine", std::move(words), request);
}

ModuleJobPlan ModulePlans::read(const Request& request) const {
  std::vector<std::string> words{"info", node_in(request.arguments), "--json"};
  if (flag_in(request.arguments, "all")) {
    words.emplace_back("--all");
  }
  add_algorithms(words);
  return plan_of("read", std::move(words), request);
}

ModuleJobPlan ModulePlans::set(const Request& request) const {
  const json& arguments = request.arguments;
  const std::string node = node_in(arguments);
  const std::string object = word_in(arguments, "object", "an object, such as 0x6080");
  const auto value = required_argument<std::string>(arguments, "value", "a value as a text");
  constexpr std::size_t longest = 100;
  if (!is_visible_line(value) || value.size() > longest) {
    throw InputError("value", 0, in_quotes(one_line(value)), "a value in the unit of the object");
  }
  return plan_of("set", {"set", node, object, "--", value}, request, Output::text);
}

ModuleJobPlan ModulePlans::save(const Request& request) const {
  const fs::path file =
      files_.new_settings(required_argument<std::string>(request.arguments, "file", "a name that ends in .params"));
  const auto nodes =
      request.arguments.contains("nodes") ? nodes_in(request.arguments, "all, or 1,3") : std::string("all");
  std::vector<std::string> words{"params", "save", file.string(), "--nodes", nodes, "--json"};
  return plan_of("save", std::move(words), request);
}

ModuleJobPlan ModulePlans::compare(const Request& request) const {
  const fs::path file =
      files_.settings(required_argument<std::string>(request.arguments, "file", "a file of the list"));
  return plan_of("compare", {"params", "diff", file.string(), "--json"}, request);
}

ModuleJobPlan ModulePlans::load(const Request& request) const {
  const fs::path file =
      files_.settings(required_argument<std::string>(request.arguments, "file", "a file of the list"));
  std::vector<std::string> words{"params", "load", file.string(), "--json"};
  if (flag_in(request.arguments, "store")) {
    words.emplace_back("--store");
  }
  if (flag_in(request.arguments, "any_module")) {
    words.emplace_back("--any-module");
  }
  return plan_of("load", std::move(words), request);
}

ModuleJobPlan ModulePlans::assign(const Request& request, const sim::Scenario& robot) const {
  constexpr double smallest = 1;  // of proleg assign
  constexpr double largest = 30;
  const std::string amplitude = number_in(request.arguments, "amplitude", "degrees", smallest, largest).value_or("5");
  auto files = std::make_unique<ScratchFolder>();
  const std::string top = robot.sources.front().path;
  const std::string file = copy_sources(robot.sources, files->path() / "scenario").at(top);
  std::vector<std::string> words{"assign", file, "--json-lines", "--amplitude", amplitude};
  add_algorithms(words);
  ModuleJobPlan plan = plan_of("assign", std::move(words), request, Output::events);
  plan.shown_words = {"assign", fs::path(top).filename().string()};
  plan.files = std::move(files);
  return plan;
}

ModuleJobPlan ModulePlans::calibrate(const Request& request) const {
  return plan_of("calibrate", {"calibrate", node_in(request.arguments), "--json-lines"}, request, Output::events);
}

ModuleJobPlan ModulePlans::flash(const Request& request) const {
  const json& arguments = request.arguments;
  const fs::path image = files_.image(required_argument<std::string>(arguments, "image", "an image of the list"));
  std::vector<std::string> words{"flash", image.string(), "--json-lines"};
  if (const auto nodes = argument<std::string>(arguments, "nodes", "such as 1,3, or null")) {
    words.insert(words.end(), {"--node", nodes_in(arguments, "such as 1,3, or null")});
  }
  for (const auto& [name, option] :
       {std::pair{"canary", "--canary"}, std::pair{"dry_run", "--dry-run"}, std::pair{"force_board", "--force-board"},
        std::pair{"allow_downgrade", "--allow-downgrade"}}) {
    if (flag_in(arguments, name)) {
      words.emplace_back(option);
    }
  }
  ModuleJobPlan plan = plan_of("flash", std::move(words), request, Output::events);
  plan.longest_loss = longest_loss_of_update;
  return plan;
}

ModuleJobPlan ModulePlans::recover(const Request& request) const {
  const json& arguments = request.arguments;
  std::vector<std::string> words{"recover"};
  if (const auto image = argument<std::string>(arguments, "image", "an image of the list, or null")) {
    words.push_back(files_.image(*image).string());
  }
  words.emplace_back("--json-lines");
  constexpr double longest_wait = 600;  // of proleg recover
  if (const auto wait = number_in(arguments, "wait", "seconds", 0, longest_wait)) {
    words.insert(words.end(), {"--wait", *wait});
  }
  for (const std::uint32_t serial : argument<std::vector<std::uint32_t>>(arguments, "serials", "serial numbers")
                                        .value_or(std::vector<std::uint32_t>())) {
    words.insert(words.end(), {"--serial", hexadecimal(serial, 8)});
  }
  if (flag_in(arguments, "reset_settings")) {
    words.emplace_back("--reset-settings");
  }
  if (flag_in(arguments, "dry_run")) {
    words.emplace_back("--dry-run");
  }
  ModuleJobPlan plan = plan_of("recover", std::move(words), request, Output::events);
  plan.longest_loss = longest_loss_of_update;
  return plan;
}

}  // namespace proleg::tools
