// proleg nmt: starts, stops and resets modules.

#include <algorithm>
#include <array>
#include <bitset>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host/robot/object_word.hpp"
#include "host/robot/state_text.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct NmtOptions : BusOptions {
  std::string command;
  std::string nodes;
};

struct Command {
  std::string_view word;
  canopen::NmtCommand command;
};
constexpr std::array commands{Command{"start", canopen::NmtCommand::start}, Command{"stop", canopen::NmtCommand::stop},
                              Command{"pre-operational", canopen::NmtCommand::enter_pre_operational},
                              Command{"reset-node", canopen::NmtCommand::reset_node},
                              Command{"reset-communication", canopen::NmtCommand::reset_communication}};

canopen::NmtCommand parse_command(const std::string& word) {
  std::vector<std::string> known;
  for (const Command& command : commands) {
    if (command.word == word) {
      return command.command;
    }
    known.emplace_back(command.word);
  }
  throw InputError("COMMAND", 0, in_quotes(word), "one of " + listed(known));
}

[[nodiscard]] bool is_reset(canopen::NmtCommand command) {
  return command == canopen::NmtCommand::reset_node || command == canopen::NmtCommand::reset_communication;
}

/// The nodes, of these, that answer an SDO. A Stopped one does not.
std::bitset<128> answering(BusAccess& bus, const std::vector<std::uint8_t>& nodes) {
  std::bitset<128> found;
  host::SdoQueue queue(bus.connection(), patient_transfers());
  for (const std::uint8_t node : nodes) {
    queue.read(node, canopen::object::device_type.address, [&found, node](const host::SdoResult& result) {
      found[node] = result.abort_code != canopen::AbortCode::timeout;
    });
  }
  finish(bus, queue);
  return found;
}

/// Counts what was sent, and notes who boots.
class Requests final : public host::BusUser {
 public:
  void receive(Microseconds /*now*/, const CanFrame& frame) override {
    const auto heartbeat = canopen::decode_heartbeat(frame);
    if (heartbeat && heartbeat->state == canopen::NmtState::boot_up) {
      std::cout << "node " << unsigned{heartbeat->node} << " boots\n";
      booted.set(heartbeat->node);
    }
  }
  void transmitted(Microseconds /*now*/, const CanFrame& /*frame*/) override { ++transmitted_; }
  [[nodiscard]] std::size_t count() const { return transmitted_; }

  std::bitset<128> booted;

 private:
  std::size_t transmitted_ = 0;
};

int nmt(const NmtOptions& options) {
  const canopen::NmtCommand command = parse_command(options.command);
  const auto listed_nodes = host::parse_nodes(options.nodes);
  const std::vector<std::uint8_t> nodes = listed_nodes.value_or(std::vector<std::uint8_t>{0});
  BusAccess bus(options);
  catch_interrupts();
  require_no_host(bus);
  std::bitset<128> found;
  if (listed_nodes && command == canopen::NmtCommand::stop) {
    found = answering(bus, *listed_nodes);  // afterwards it answers no more
  }
  Requests requests;
  const host::BusAttachment attachment(bus.connection(), requests);
  const std::size_t before = requests.count();
  std::size_t sent = 0;
  bus.wait_for("room for a frame", 1'000'000, [&] {
    while (sent < nodes.size() && bus.connection().send(canopen::encode(canopen::NmtRequest{command, nodes[sent]}))) {
      ++sent;
    }
    return sent == nodes.size() && requests.count() - before >= sent;
  });
  constexpr Microseconds boot_time = 400'000;
  const auto all_have_booted = [&] {
    return listed_nodes && std::ranges::all_of(nodes, [&](std::uint8_t node) { return requests.booted[node]; });
  };
  if (is_reset(command)) {
    bus.connection().run_until(bus.connection().now() + boot_time, all_have_booted);
    found = requests.booted;
  }
  if (!listed_nodes) {
    return exit_success;
  }
  if (!is_reset(command) && command != canopen::NmtCommand::stop) {
    found = answering(bus, *listed_nodes);
  }
  std::vector<std::string> missing;
  for (const std::uint8_t node : nodes) {
    if (!found[node]) {
      missing.push_back(std::to_string(node));
    }
  }
  if (!missing.empty()) {
    throw std::runtime_error((missing.size() == 1 ? "no sign of node " : "no sign of the nodes ") + listed(missing) +
                             (command == canopen::NmtCommand::stop ? ", before it was told to stop; " : "; ") +
                             bus.connection().diagnosis());
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg nmt",
                           "Sends a command of network management (CiA 301) to modules, unless another host drives the "
                           "robot. Every command except start takes the power from the servo.");
  NmtOptions options;
  command_line.add_option("COMMAND", options.command, "start, stop, pre-operational, reset-node or reset-communication")
      .required();
  command_line.add_option("NODE", options.nodes, "node ids, such as 3, 1,3 or 2-5, or all").required();
  add_bus_option(command_line, options);
  return command_line.run(argc, argv, [&] { return nmt(options); });
}
