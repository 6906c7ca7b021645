// proleg nmt: starts, stops and resets modules.

#include <array>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host/robot/object_word.hpp"
#include "host/robot/state_text.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/bus_access.hpp"
#include "tools/proleg/interrupt.hpp"

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

/// Counts what was sent, and notes who boots.
class Requests final : public host::BusUser {
 public:
  void receive(Microseconds /*now*/, const CanFrame& frame) override {
    const auto heartbeat = canopen::decode_heartbeat(frame);
    if (heartbeat && heartbeat->state == canopen::NmtState::boot_up) {
      std::cout << "node " << unsigned{heartbeat->node} << " boots\n";
    }
  }
  void transmitted(Microseconds /*now*/, const CanFrame& /*frame*/) override { ++transmitted_; }
  [[nodiscard]] std::size_t count() const { return transmitted_; }

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
  Requests requests;
  bus.connection().attach(requests);
  const std::size_t before = requests.count();
  std::size_t sent = 0;
  bus.wait_for("room for a frame", 1'000'000, [&] {
    while (sent < nodes.size() && bus.connection().send(canopen::encode(canopen::NmtRequest{command, nodes[sent]}))) {
      ++sent;
    }
    return sent == nodes.size() && requests.count() - before >= sent;
  });
  constexpr Microseconds boot_time = 100'000;
  bus.connection().run_for(boot_time);
  bus.connection().detach(requests);
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
