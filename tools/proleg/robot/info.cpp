// proleg info: what a module says of itself.

#include <algorithm>
#include <array>
#include <iostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/robot/object_word.hpp"
#include "host/robot/state_text.hpp"
#include "shared/canopen/object_name.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
namespace object = canopen::object;

struct InfoOptions : BusOptions {
  std::string nodes;
  bool all = false;
  bool json = false;
};

struct Line {
  canopen::Object object;
  const char* group;
  host::SdoResult result;
};

struct Module {
  std::uint8_t node;
  std::array<std::uint8_t, max_slots> algorithms{};  ///< ids; 0: the slot is empty
  canopen::AbortCode failure = canopen::AbortCode::none;
  std::vector<Line> lines;
};

struct Group {
  const char* name;
  std::span<const canopen::Address> objects;
};

/// What a person wants to know first.
std::span<const Group> first_groups() {
  static constexpr std::array identity{object::device_name.address,      object::hardware_version.address,
                                       object::software_version.address, object::serial.address,
                                       object::version.address,          object::core_fingerprint.address,
                                       object::update_key.address};
  static constexpr std::array state{object::error_register.address,  object::statusword.address,
                                    object::position_demand.address, object::actual_position.address,
                                    object::actual_current.address,  object::temperature.address,
                                    object::current_tick.address,    object::lost_frames.address};
  static constexpr std::array joint{
      object::joint_index.address,     object::joint_count.address,        object::front_node.address,
      object::rear_node.address,       object::tick_period.address,        object::servo_period.address,
      object::lowest_position.address, object::highest_position.address,   object::command_speed.address,
      object::current_limit.address,   object::current_limit_time.address, object::gateway_role.address,
      object::has_feedback.address};
  static constexpr std::array groups{Group{"identity", identity}, Group{"state", state}, Group{"joint", joint}};
  return groups;
}

/// --all: every entry that can be read, except the numbers of entries of a record or an array, the mappings and the
/// communication parameters, what repeats for each joint, and the values of algorithms, which slots decide.
bool is_of_interest(const canopen::Object& object) {
  const unsigned index = object.address.index;
  const bool is_communication = index >= 0x1200 && index < 0x2000;
  const bool is_received = index >= 0x2100 && index < 0x2180;
  const bool is_of_algorithm = index >= 0x3000 && index < 0x6000;
  const auto info = canopen::find_index(object.address.index);
  const bool is_count =
      object.address.sub == 0 && info && info->max_sub > 0 && object.access == canopen::Access::constant;
  return !is_count && object.access != canopen::Access::write_only && !is_communication && !is_received &&
         !is_of_algorithm && index < 0x7000;
}

/// The values of the algorithms in a module's slots.
void add_algorithms(Module& module, bool all) {
  constexpr const char* group = "algorithms";
  for (std::uint8_t slot = 0; slot < max_slots; ++slot) {
    const ActuationModule* algorithm = find_algorithm(module.algorithms.at(slot));
    if (algorithm == nullptr) {
      continue;
    }
    if (!all) {  // else it is there already
      module.lines.push_back({canopen::find_object(object::slot_algorithm.address(slot)).value(), group, {}});
    }
    const auto add = [&](canopen::ValueKind kind, std::size_t count) {
      for (std::size_t number = 0; number < count; ++number) {
        const canopen::ValueAddress value{kind, module.algorithms.at(slot), static_cast<std::uint8_t>(number), slot};
        module.lines.push_back({canopen::find_object(canopen::address_of(value)).value(), group, {}});
      }
    };
    add(canopen::ValueKind::parameter, algorithm->declaration().parameters.size());
    if (all) {
      add(canopen::ValueKind::internal_value, algorithm->declaration().internal_values.size());
    }
  }
}

void add_lines(Module& module, bool all) {
  if (all) {
    canopen::for_each_object([&](const canopen::Object& object) {
      if (is_of_interest(object)) {
        module.lines.push_back({object, "objects", {}});
      }
    });
  } else {
    for (const Group& group : first_groups()) {
      for (const canopen::Address address : group.objects) {
        module.lines.push_back({canopen::find_object(address).value(), group.name, {}});
      }
    }
  }
  add_algorithms(module, all);
}

/// Reads the algorithms of each module. These objects also show whether the module answers at all.
void read_algorithms_of(BusAccess& bus, host::SdoQueue& queue, std::vector<Module>& modules) {
  for (Module& module : modules) {
    for (std::uint8_t slot = 0; slot < max_slots; ++slot) {
      queue.read(module.node, object::slot_algorithm.address(slot), [&module, slot](const host::SdoResult& result) {
        if (result.is_good()) {
          module.algorithms.at(slot) = static_cast<std::uint8_t>(result.number());
        } else if (result.abort_code == canopen::AbortCode::timeout) {
          module.failure = result.abort_code;
        }
      });
    }
  }
  finish(bus, queue);
}

/// "16 (no power)": what some numbers mean.
std::string value_of(const Line& line) {
  std::string text = host::value_text(line.object, line.result.value);
  if (line.object.address == object::statusword.address) {
    text.append(" (").append(host::drive_text(static_cast<std::uint16_t>(line.result.number()))).append(")");
  } else if (line.object.address == object::update_key.address) {
    text = host::image_key_text(line.result.number());
  } else if (line.object.address.index == object::slot_algorithms.index && line.object.address.sub > 0) {
    const ActuationModule* algorithm = find_algorithm(static_cast<std::uint8_t>(line.result.number()));
    text.append(" (").append(algorithm == nullptr ? "none" : algorithm->declaration().name).append(")");
  }
  return text;
}

void print_module(const Module& module, bool has_groups) {
  std::cout << "node " << unsigned{module.node} << '\n';
  std::string group;
  for (const Line& line : module.lines) {
    if (!line.result.is_good()) {
      continue;  // a module of another revision, or a field of the error history without an error
    }
    if (has_groups && group != line.group) {
      group = line.group;
      std::cout << ' ' << group << '\n';
    }
    const std::string address = host::address_text(line.object.address);
    std::cout << "  " << address << std::string(address.size() < 10 ? 10 - address.size() : 1, ' ')
              << canopen::full_name(line.object.address).view() << " = " << value_of(line) << '\n';
  }
  if (has_groups && std::ranges::all_of(module.algorithms, [](std::uint8_t id) { return id == 0; })) {
    std::cout << " algorithms\n  none: a host configures the modules when it drives the robot\n";
  }
}

/// By SDO.
bool is_writable(const canopen::Object& object) {
  return object.access == canopen::Access::read_write || object.access == canopen::Access::write_only;
}

void add_to(Json& list, const Module& module) {
  for (const Line& line : module.lines) {
    if (line.result.is_good()) {
      list.append({{"node", unsigned{module.node}},
                   {"object", host::address_text(line.object.address)},
                   {"name", std::string(canopen::full_name(line.object.address).view())},
                   {"group", line.group},
                   {"value", value_of(line)},
                   {"writable", is_writable(line.object)},
                   {"help", one_line(std::string_view(line.object.help))}});
    }
  }
}

int info(const InfoOptions& options) {
  static_cast<void>(host::parse_nodes(options.nodes));
  BusAccess bus(options);
  catch_interrupts();
  std::vector<Module> modules;
  for (const std::uint8_t node : nodes_of(bus, options.nodes)) {
    modules.push_back({.node = node, .lines = {}});
  }
  host::SdoQueue queue(bus.connection(), patient_transfers());
  read_algorithms_of(bus, queue, modules);
  for (Module& module : modules) {
    if (module.failure == canopen::AbortCode::none) {
      add_lines(module, options.all);
    }
    for (Line& line : module.lines) {
      queue.read(module.node, line.object.address, [&module, &line](const host::SdoResult& result) {
        line.result = result;
        if (result.abort_code == canopen::AbortCode::timeout) {
          module.failure = result.abort_code;
        }
      });
    }
  }
  finish(bus, queue);

  int status = exit_success;
  Json list = Json::empty_array();
  bool is_first = true;
  for (const Module& module : modules) {
    if (module.failure != canopen::AbortCode::none) {
      std::cerr << "proleg info: "
                << failure_text(module.node, "what describes it", module.failure, bus.connection().diagnosis()) << '\n';
      status = exit_failed;
    }
    if (options.json) {
      add_to(list, module);
    } else if (!module.lines.empty()) {
      std::cout << (is_first ? "" : "\n");
      is_first = false;
      print_module(module, !options.all);
    }
  }
  if (options.json) {
    std::cout << Json{{"values", list}}.text() << '\n';
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg info",
                           "Shows what modules say of themselves: identity, state, settings of the joint, and the "
                           "parameters of the algorithms in their slots.");
  InfoOptions options;
  command_line.add_option("NODE", options.nodes, "node ids, such as 3, 1,3 or 2-5, or all").required();
  add_bus_option(command_line, options);
  command_line.add_flag("--all", options.all,
                        "all objects that describe a module, and the internal values of its algorithms");
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return info(options); });
}
