// `proleg scenarios`: the scenarios that other commands know by name.

#include "tools/proleg/common/shipped_scenarios.hpp"

#include <algorithm>
#include <iostream>
#include <string>
#include <string_view>

#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg {
namespace {

using tools::Json;
using tools::ShippedScenario;

int print_json() {
  Json list = Json::empty_array();
  for (const ShippedScenario& scenario : tools::shipped_scenarios()) {
    list.append(Json{{"name", scenario.name},
                     {"group", scenario.group},
                     {"title", scenario.title},
                     {"file", tools::scenario_file(std::string(scenario.name))}});
  }
  std::cout << Json{{"scenarios", list}}.text() << '\n';
  return tools::exit_success;
}

int print_text() {
  std::size_t width = 0;
  for (const ShippedScenario& scenario : tools::shipped_scenarios()) {
    width = std::max(width, scenario.name.size());
  }
  std::string_view group;
  for (const ShippedScenario& scenario : tools::shipped_scenarios()) {
    if (scenario.group != group) {
      std::cout << (group.empty() ? "" : "\n") << scenario.group << '\n';
      group = scenario.group;
    }
    std::cout << "  " << scenario.name << std::string(width + 2 - scenario.name.size(), ' ') << scenario.title << '\n';
  }
  std::cout << "\nThe files are in " << tools::shipped_folder()->string() << '\n';
  return tools::exit_success;
}

}  // namespace
}  // namespace proleg

int main(int argc, char** argv) {
  proleg::tools::CommandLine command_line("proleg scenarios",
                                          "Lists the robots and gaits that ship with Proleg. Where a command takes a "
                                          "scenario, it takes one of these names: proleg simulate caterpillar");
  bool json = false;
  command_line.add_flag("--json", json, "print one JSON object");
  return command_line.run(argc, argv, [&] {
    if (!proleg::tools::shipped_folder()) {
      throw proleg::tools::BadInput(
          "found no scenarios beside this program, expected those of a checkout or of an "
          "installation; install Proleg again");
    }
    return json ? proleg::print_json() : proleg::print_text();
  });
}
