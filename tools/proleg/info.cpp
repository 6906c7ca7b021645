// proleg info: what a module says of itself.

#include <iostream>
#include <string>
#include <vector>

#include "host/robot/object_word.hpp"
#include "shared/canopen/object_name.hpp"
#include "shared/gait/registry.hpp"
#include "tools/proleg/bus_access.hpp"
#include "tools/proleg/interrupt.hpp"
#include "tools/proleg/json_output.hpp"
#include "tools/proleg/object_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct InfoOptions : BusOptions {
  std::string nodes;
  bool json = false;
};

struct Line {
  std::uint8_t node;
  canopen::Object object;
  std::optional<host::SdoResult> result;
};

/// What a person wants to know first: every entry that can be read, except those that repeat for each joint, the
/// mappings and the communication parameters.
bool is_of_interest(const canopen::Object& object) {
  const unsigned index = object.address.index;
  const bool is_communication = index >= 0x1200 && index < 0x2000;
  const bool is_received = index >= 0x2100 && index < 0x2180;
  const bool is_count = object.address.sub == 0 && canopen::find_group(object.address.index) != nullptr &&
                        object.access == canopen::Access::constant;
  return !is_count && object.access != canopen::Access::write_only && !is_communication && !is_received &&
         index < 0x7000 && !canopen::value_address(object.address);
}

int info(const InfoOptions& options) {
  static_cast<void>(host::parse_nodes(options.nodes));
  BusAccess bus(options);
  catch_interrupts();
  const std::vector<std::uint8_t> nodes = nodes_of(bus, options.nodes);
  host::SdoQueue queue(bus.connection(), patient_transfers());
  std::vector<Line> lines;
  for (const std::uint8_t node : nodes) {
    canopen::for_each_object([&](const canopen::Object& object) {
      if (is_of_interest(object)) {
        lines.push_back({node, object, std::nullopt});
      }
    });
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    queue.read(lines[i].node, lines[i].object.address,
               [&lines, i](const host::SdoResult& result) { lines[i].result = result; });
  }
  finish(bus, queue);

  int status = exit_success;
  Json list = Json::empty_array();
  std::uint8_t node = 0;
  for (const Line& line : lines) {
    if (line.result->abort_code == canopen::AbortCode::timeout) {
      if (node != line.node) {
        std::cerr << "proleg info: "
                  << failure_text(line.node, host::address_text(line.object.address), line.result->abort_code,
                                  bus.connection().diagnosis())
                  << '\n';
      }
      node = line.node;
      status = exit_failed;
      continue;
    }
    if (!line.result->is_good()) {
      continue;  // a module of another revision, or a field of the error history without an error
    }
    const std::string name(canopen::full_name(line.object.address).view());
    const std::string value = host::value_text(line.object, line.result->value);
    if (options.json) {
      list.append({{"node", unsigned{line.node}},
                   {"object", host::address_text(line.object.address)},
                   {"name", name},
                   {"value", value}});
      continue;
    }
    if (node != line.node) {
      std::cout << (node == 0 ? "" : "\n") << "node " << unsigned{line.node} << '\n';
      node = line.node;
    }
    const std::string address = host::address_text(line.object.address);
    std::cout << "  " << address << std::string(address.size() < 10 ? 10 - address.size() : 1, ' ') << name << " = "
              << value << '\n';
  }
  if (options.json) {
    std::cout << Json{{"values", list}}.text() << '\n';
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg info", "Shows what modules say of themselves: all objects that describe them.");
  InfoOptions options;
  command_line.add_option("NODE", options.nodes, "node ids, such as 3, 1,3 or 2-5, or all").required();
  add_bus_option(command_line, options);
  command_line.add_flag("--json", options.json, "print one JSON object");
  return command_line.run(argc, argv, [&] { return info(options); });
}
