#include "tools/proleg/hil/broken_modules.hpp"

#include <array>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/hardware_loop/native_module.hpp"
#include "tools/proleg/common/scenario_run.hpp"

namespace proleg::tools {

BrokenModules::BrokenModules(const std::vector<std::string>& arguments, const sim::Scenario& scenario)
    : scenario_(scenario), faults_(scenario.modules.size()) {
  for (const std::string& argument : arguments) {
    parse(argument);
  }
}

std::string BrokenModules::syntax() {
  return "NODE=hangs, faults (the program, at once), silent (until the supply was switched off and on), no-program, "
         "newer-settings (than the program knows), or "
         "duplicate:OTHER (has the node id OTHER)";
}

void BrokenModules::parse(const std::string& argument) {
  const auto joint_of = [&](std::string_view node) {
    return joint_of_node(scenario_, parse_whole<std::uint32_t>(node), "--broken", in_quotes(argument));
  };
  struct Name {
    std::string_view name;
    Kind kind;
  };
  static constexpr std::array names{Name{"hangs", Kind::hangs}, Name{"faults", Kind::faults},
                                    Name{"silent", Kind::silent}, Name{"no-program", Kind::no_program},
                                    Name{"newer-settings", Kind::newer_settings}};
  constexpr std::string_view duplicate = "duplicate:";
  const std::size_t equal = argument.find('=');
  const std::string_view kind = equal == std::string::npos ? "" : std::string_view(argument).substr(equal + 1);
  Fault fault;
  for (const Name& one : names) {
    fault.kind = one.name == kind ? one.kind : fault.kind;
  }
  if (kind.starts_with(duplicate)) {
    fault = {Kind::duplicate, joint_of(kind.substr(duplicate.size()))};
  }
  if (fault.kind == Kind::none) {
    throw InputError("--broken", 0, in_quotes(argument), syntax());
  }
  const unsigned joint = joint_of(std::string_view(argument).substr(0, equal));
  if (faults_[joint].kind != Kind::none) {
    throw InputError("--broken", 0, "node " + argument.substr(0, equal) + " twice", "each node at most once");
  }
  if (fault.kind == Kind::duplicate && fault.other == joint) {
    throw InputError("--broken", 0, in_quotes(argument), "the node id of another module");
  }
  faults_[joint] = fault;
}

void BrokenModules::share_node_ids(std::vector<std::uint8_t>& nodes) const {
  for (unsigned joint = 0; joint < faults_.size(); ++joint) {
    if (faults_[joint].kind == Kind::duplicate) {
      nodes[joint] = nodes[faults_[joint].other];
    }
  }
}

std::unique_ptr<sim::JointModule> BrokenModules::make(const sim::ModuleParts& parts) const {
  const Kind kind = faults_[parts.joint].kind;
  if (!makes(parts.joint)) {
    return nullptr;
  }
  auto module = std::make_unique<sim::NativeModule>(parts.bus, parts.identity, parts.crystal, parts.sensors,
                                                    parts.take_readings, parts.is_gateway);
  if (kind == Kind::no_program) {
    module->program().write_image({}, false);
  } else if (kind == Kind::newer_settings) {
    constexpr std::uint8_t known = firmware::BoardRecord::schema;
    module->write_settings(known + 1);
    // All native modules have this program. It knows the data of its own schema.
    module->program().set_health([written = module.get()](const image::Header& header) {
      if (header.settings_schema > known) {
        written->write_settings(known);
      }
      return sim::ProgramHealth::good;
    });
  } else {
    const auto health = kind == Kind::hangs    ? sim::ProgramHealth::hangs
                        : kind == Kind::faults ? sim::ProgramHealth::faults
                                               : sim::ProgramHealth::deaf;
    if (kind == Kind::silent) {
      module->set_start_time(sim::NativeProgram::start_time_us);  // its bootloader listens after power on
    }
    const image::Header first = image::decode(module->program().image()).header;
    module->program().set_health([health, first](const image::Header& header) {
      return header == first ? health : sim::ProgramHealth::good;  // another program starts well
    });
  }
  return module;
}

}  // namespace proleg::tools
