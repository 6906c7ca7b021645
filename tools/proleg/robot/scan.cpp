// proleg scan: who is on a bus.

#include <cstdio>
#include <iostream>
#include <string>

#include "host/robot/state_text.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/image/board_names.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct ScanOptions : BusOptions {
  bool json = false;
};

std::string version_text(std::uint16_t version) {
  return std::to_string(version >> 8U) + "." + std::to_string(version & 0xFFU);
}

void print_json(const host::BusScan& scan, const std::string& bus) {
  Json nodes = Json::empty_array();
  for (const host::ScannedNode& node : scan.nodes()) {
    nodes.append({{"node", unsigned{node.node}},
                  {"answers", node.has_answered},
                  {"state", node.state ? Json(host::state_text(*node.state)) : Json()},
                  {"joint_module", node.is_module},
                  {"joint", node.joint ? Json(unsigned{*node.joint}) : Json()},
                  {"drive", node.is_module ? Json(host::drive_text(node.statusword)) : Json()},
                  {"error_register", unsigned{node.error_register}},
                  {"vendor", node.vendor},
                  {"product", node.product},
                  {"revision", node.revision},
                  {"serial", node.serial},
                  {"protocol", node.protocol},
                  {"core_fingerprint", node.core_fingerprint},
                  {"images", node.update_key ? Json(host::image_key_text(*node.update_key)) : Json()},
                  {"name", node.name},
                  {"hardware", node.hardware},
                  {"software", node.software}});
  }
  Json duplicates = Json::empty_array();
  for (const std::uint8_t node : scan.duplicates()) {
    duplicates.append(unsigned{node});
  }
  std::cout << Json{{"bus", bus},
                    {"nodes", nodes},
                    {"host", scan.has_host()},
                    {"sync", scan.syncs() > 0},
                    {"modules_without_node_id", scan.has_fresh_modules()},
                    {"duplicate_node_ids", duplicates}}
                   .text()
            << '\n';
}

void print_table(const host::BusScan& scan, const std::string& bus) {
  std::printf("%s\n", bus.c_str());
  const auto nodes = scan.nodes();
  if (!nodes.empty()) {
    std::printf("%-5s %-6s %-16s %-18s %-11s %-9s %-16s %s\n", "node", "joint", "state", "drive", "serial", "protocol",
                "images", "name");
  }
  for (const host::ScannedNode& node : nodes) {
    // A module sends heartbeats when a host has set it up; other devices always do.
    const std::string state(node.state       ? host::state_text(*node.state)
                            : node.is_module ? "not driven"
                                             : "no heartbeat");
    if (!node.has_answered) {
      std::printf("%-5u %-6s %-16s does not answer\n", unsigned{node.node}, "-", state.c_str());
      continue;
    }
    // What differs from the reference board, in the module's own words.
    const bool is_other_board = node.is_module && node.product != image::board_names[0].id && !node.hardware.empty();
    const std::string board(image::board_name(static_cast<std::uint16_t>(node.product)));
    const std::string hardware =
        is_other_board ? "  (" + one_line(node.hardware) + (board.empty() ? "" : "; " + board) + ")" : "";
    std::printf("%-5u %-6s %-16s %-18s %-11s %-9s %-16s %s%s%s\n", unsigned{node.node},
                node.joint ? std::to_string(*node.joint).c_str() : "-", state.c_str(),
                node.is_module ? std::string(host::drive_text(node.statusword)).c_str() : "-",
                hexadecimal(node.serial, 8).c_str(), node.is_module ? version_text(node.protocol).c_str() : "-",
                node.update_key ? host::image_key_text(*node.update_key).c_str() : "-", node.name.c_str(),
                hardware.c_str(), node.error_register != 0 ? "  (reports an error)" : "");
  }
  std::printf("%zu node%s%s%s\n", nodes.size(), nodes.size() == 1 ? "" : "s", scan.syncs() > 0 ? ", SYNC" : "",
              scan.has_host() ? ", driven by a host" : "");
  if (scan.has_fresh_modules()) {
    std::printf("There are modules without a node id.\n");
  }
}

int run(const ScanOptions& options) {
  BusAccess bus(options);
  catch_interrupts();
  host::BusScan all(bus.connection());
  scan(bus, all);
  if (options.json) {
    print_json(all, bus.connection().description());
  } else {
    print_table(all, bus.connection().description());
  }
  for (const std::uint8_t node : all.duplicates()) {
    print_warning("proleg scan",
                  "several modules have the node id " + std::to_string(node) + "; switch all but one of them off");
  }
  for (const host::ScannedNode& node : all.nodes()) {
    if (node.is_module && node.core_fingerprint != core_fingerprint) {
      print_warning("proleg scan", "node " + std::to_string(node.node) + " computes with the core " +
                                       hexadecimal(node.core_fingerprint, 8) + ", this program with " +
                                       hexadecimal(core_fingerprint, 8) + "; flash its module anew");
    }
  }
  if (all.nodes().empty() && !all.has_fresh_modules()) {
    std::cerr << "proleg scan: found no node; " << bus.connection().diagnosis() << '\n';
    return exit_failed;
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg scan", "Lists the nodes on a bus. Reads only: it disturbs no robot that moves.");
  ScanOptions options;
  add_bus_option(command_line, options);
  command_line.add_flag("--json", options.json, "print one JSON object");
  return command_line.run(argc, argv, [&] { return run(options); });
}
