// proleg bus: a simulated robot that other programs reach, paced to real time.

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/robot/object_word.hpp"
#include "host/transport/bus_server.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/random.hpp"
#include "sim/bus/candump_log.hpp"
#include "sim/live/live_robot.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/hil/broken_modules.hpp"
#include "tools/proleg/hil/gateway_line.hpp"
#include "tools/proleg/hil/hil_modules.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

/// The time that a simulation has to reach, so that it keeps the pace of real time. A simulation that is late, because
/// the computer is too slow or was suspended, catches up by at most 50 ms: for the rest of the delay its clock stops.
class RealTimePace {
 public:
  /// Largest lateness that the simulation catches up; more is a delay.
  static constexpr std::uint64_t tolerance_ns = 50'000'000;

  /// Time since the start, without the delays.
  [[nodiscard]] std::uint64_t now_ns() const { return since_start_ns() - delayed_ns_; }

  /// Notes the time that the simulation has reached.
  void simulated_to(std::uint64_t time_ns) {
    if (const std::uint64_t now = now_ns(); now > time_ns + tolerance_ns) {
      delayed_ns_ += now - time_ns;
      ++delays_;
    }
  }
  [[nodiscard]] std::uint64_t delays() const { return delays_; }
  [[nodiscard]] std::uint64_t delayed_ns() const { return delayed_ns_; }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::uint64_t since_start_ns() const {
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start_).count());
  }

  Clock::time_point start_ = Clock::now();
  std::uint64_t delayed_ns_ = 0;
  std::uint64_t delays_ = 0;
};

struct ServerOptions : ModuleOptions {
  ScenarioOptions scenario;
  std::vector<std::string> can;
  bool pty = false;
  std::vector<std::string> tcp;
  std::optional<std::string> descriptor;
  std::optional<std::string> gateway;
  std::optional<std::string> fresh;
  std::optional<std::string> shuffle;
  std::vector<std::string> broken;
  std::optional<std::string> can_log;
  bool verbose = false;
};

CanStatus status_of(const sim::Controller& controller) {
  constexpr unsigned warning_limit = 96;
  CanStatus status;
  status.transmit_errors = static_cast<std::uint16_t>(controller.transmit_errors());
  status.receive_errors = static_cast<std::uint16_t>(controller.receive_errors());
  switch (controller.error_state()) {
    case sim::ErrorState::bus_off:
      status.state = CanState::bus_off;
      break;
    case sim::ErrorState::passive:
      status.state = CanState::error_passive;
      break;
    case sim::ErrorState::active:
      status.state = std::max(status.transmit_errors, status.receive_errors) >= warning_limit ? CanState::error_warning
                                                                                              : CanState::error_active;
      break;
  }
  return status;
}

/// Node ids that the modules have at the start: those of the robot's file, shuffled ones, those of other modules, or
/// none.
std::vector<std::uint8_t> start_nodes(const ServerOptions& options, const sim::Scenario& scenario,
                                      const BrokenModules& broken) {
  std::vector<std::uint8_t> nodes;
  for (const sim::ModulePlace& module : scenario.modules) {
    nodes.push_back(module.node);
  }
  if (options.shuffle) {
    const auto seed = parse_whole<std::uint64_t>(*options.shuffle);
    if (!seed) {
      throw InputError("--shuffle", 0, in_quotes(*options.shuffle), "SEED, a whole number");
    }
    Pcg32 random(*seed, 0);
    for (std::size_t i = nodes.size(); i > 1; --i) {
      std::swap(nodes[i - 1], nodes[random.below(static_cast<std::uint32_t>(i))]);
    }
  }
  broken.share_node_ids(nodes);
  if (options.fresh) {
    const auto fresh = host::parse_nodes(*options.fresh, "--fresh");
    for (const std::uint8_t node : fresh.value_or(std::vector<std::uint8_t>{})) {
      static_cast<void>(joint_of_node(scenario, node, "--fresh", std::to_string(node)));
    }
    for (std::size_t joint = 0; joint < nodes.size(); ++joint) {
      const std::uint8_t node = scenario.modules[joint].node;
      if (!fresh || std::ranges::find(*fresh, node) != fresh->end()) {
        nodes[joint] = 0;
      }
    }
  }
  return nodes;
}

/// The place at which a program reaches the serial line of a module, if one is a gateway. nodes: those of
/// start_nodes().
std::optional<GatewayPlace> gateway_place(const ServerOptions& options, const sim::Scenario& scenario,
                                          const std::vector<std::uint8_t>& nodes) {
  if (!options.gateway) {
    return std::nullopt;
  }
  const GatewayPlace place = parse_gateway(scenario, *options.gateway);
  if (nodes[place.joint] == 0) {
    throw InputError("--gateway", 0,
                     "node " + std::to_string(scenario.modules[place.joint].node) + ", which --fresh names",
                     "a module with a node id: one from the factory has no gateway role");
  }
  return place;
}

void require_native(const BrokenModules& broken, const HilModules& modules, const sim::Scenario& scenario) {
  for (unsigned joint = 0; joint < scenario.modules.size(); ++joint) {
    if (broken.makes(joint) && modules.is_virtual(joint)) {
      throw InputError(
          "--broken", 0,
          "node " + std::to_string(scenario.modules[joint].node) + ", which --modules makes a virtual chip",
          "a native module");
    }
  }
}

/// The robot and the programs that reach it.
class Server final : private host::BusServerListener {
 public:
  Server(const ServerOptions& options, const ScenarioRun& run, HilModules& modules, const BrokenModules& broken)
      : nodes_(start_nodes(options, run.scenario, broken)),
        gateway_place_(gateway_place(options, run.scenario, nodes_)),
        robot_model_(run.scenario.robot),
        is_verbose_(options.verbose),
        log_(options.can_log ? std::make_unique<sim::CandumpLog>(*options.can_log) : nullptr),
        robot_(run.scenario, live_options(modules, broken)) {
    open(options);
  }

  /// Serves clients until the user interrupts, the descriptor is closed, or the robot's time is `until` (0: no end).
  void serve(sim::BusTime until) {
    RealTimePace pace;
    while (!interrupted() && !is_closed_ && (until == 0 || robot_.now() < until)) {
      // The clients' frames enter the bus at the present time.
      advance(pace);
      take_input();
      context_.restart();
      const std::uint64_t wake_ns = std::min(robot_.next_event(), robot_.now() + longest_wait_ns);
      if (const std::uint64_t now_ns = pace.now_ns(); now_ns < wake_ns) {
        context_.run_one_for(std::chrono::nanoseconds(wake_ns - now_ns));
      }
      context_.poll();
    }
    report_delays(pace);
    if (log_) {
      log_->finish();
    }
  }

 private:
  static constexpr std::uint64_t longest_wait_ns = 10'000'000;
  /// If the simulation is late, it gives the clients a turn after pieces of this length.
  static constexpr sim::BusTime longest_piece_ns = 1'000'000;

  sim::LiveRobotOptions live_options(HilModules& modules, const BrokenModules& broken) {
    sim::LiveRobotOptions options;
    options.threads = modules.threads();
    options.make_module = [&modules, &broken](const sim::ModuleParts& parts) {
      std::unique_ptr<sim::JointModule> module = broken.make(parts);
      return module ? std::move(module) : modules.make(parts);
    };
    options.change_identity = [this](unsigned joint, firmware::ModuleIdentity& identity) {
      identity.node = nodes_[joint];
    };
    if (gateway_place_) {
      options.gateway = {gateway_place_->joint, &gateway_line_};
    }
    options.on_frame = [this](const sim::Transmission& transmission, bool is_own) {
      if (log_) {
        log_->write(transmission.end, transmission.frame);
      }
      if (!is_own) {
        server_.broadcast(transmission.end / 1'000, transmission.frame);
      }
    };
    options.on_sent = [this](sim::BusTime time, const CanFrame& frame, std::uint32_t client) {
      server_.broadcast(time / 1'000, frame, client);
    };
    options.on_state = [this](const sim::Controller& adapter) { server_.status_changed(status_of(adapter)); };
    options.notice = [](const std::string& text) { std::cerr << "proleg bus: " << text << '\n'; };
    return options;
  }

  void open(const ServerOptions& options) {
    for (const std::string& name : options.can) {
      server_.add_can(name);
      std::cout << "CAN interface " << name << ": --bus " << name << '\n';
    }
    for (const std::string& argument : options.tcp) {
      ServedPort served = parse_served_port("--tcp", argument);
      served.port = server_.add_tcp(served.address, served.port);
      std::cout << "slcan over TCP: --bus " << bus_argument(served) << '\n';
    }
    if (options.pty) {
      std::cout << "slcan on a pseudo terminal: --bus serial:" << server_.add_pseudo_terminal() << '\n';
    }
    if (options.descriptor) {
      const auto number = parse_whole<int>(*options.descriptor);
      if (!number || *number < 0) {
        throw InputError("--fd", 0, in_quotes(*options.descriptor), "the number of an open file descriptor");
      }
      server_.add_descriptor(*number);
    }
    if (gateway_place_) {
      std::cout << "gateway on the serial line of node " << unsigned{nodes_[gateway_place_->joint]} << ": --bus "
                << gateway_line_.open(*gateway_place_) << '\n';
    }
    std::cout.flush();
  }

  void advance(RealTimePace& pace) {
    const std::uint64_t now = pace.now_ns();
    robot_.advance_to(std::min(now, robot_.now() + longest_piece_ns));
    pace.simulated_to(robot_.now());
    if (is_verbose_) {
      report_power();
    }
  }

  /// A person switches the supply of the robot by lines of standard input.
  void take_input() {
    while (const auto line = input_lines_.next()) {
      const std::string word(trimmed(*line));
      if (word == "off" || word == "on") {
        switch_supply(word == "on");
      } else if (!word.empty()) {
        std::cerr << "proleg bus: found the line " << in_quotes(word)
                  << ", expected off or on: the supply of the robot\n";
      }
    }
  }

  void switch_supply(bool is_on) {
    constexpr std::uint32_t nominal_mv = 3'300;
    for (unsigned joint = 0; joint < robot_.joint_count(); ++joint) {
      robot_.module(joint).set_supply(robot_.now(), is_on ? nominal_mv : 0);
    }
    std::cerr << "proleg bus: the supply of the robot is " << (is_on ? "on" : "off") << '\n';
  }

  /// Reports the power of joints: a person at a real robot sees which joint moves.
  void report_power() {
    for (unsigned joint = 0; joint < robot_.joint_count(); ++joint) {
      const bool has_power = robot_.module(joint).pulse().has_value();
      if (has_power != has_power_[joint]) {
        std::cerr << "proleg bus: " << robot_model_.joints[joint].name << (has_power ? " has" : " has no")
                  << " power\n";
        has_power_[joint] = has_power;
      }
    }
  }

  static void report_delays(const RealTimePace& pace) {
    if (pace.delays() > 0) {
      print_warning("proleg bus", "the clock of the robot stood still " + std::to_string(pace.delays()) +
                                      " times, for " + number_text(static_cast<double>(pace.delayed_ns()) * 1e-9) +
                                      " s in all, because this computer was too slow or busy");
    }
  }

  [[nodiscard]] bool frame_from_client(host::BusClient client, const CanFrame& frame) override {
    return robot_.send(frame, client);
  }
  void client_event(const std::string& line) override {
    if (is_verbose_) {
      std::cerr << "proleg bus: " << line << '\n';
    }
  }
  void descriptor_closed() override { is_closed_ = true; }

  std::vector<std::uint8_t> nodes_;  ///< node ids at the start, by joint; 0: none
  std::optional<GatewayPlace> gateway_place_;
  const sim::RobotModel& robot_model_;
  std::vector<bool> has_power_ = std::vector<bool>(nodes_.size());  ///< reported power by joint
  bool is_verbose_;
  bool is_closed_ = false;
  InputLines input_lines_;
  std::unique_ptr<sim::CandumpLog> log_;
  boost::asio::io_context context_{1};
  host::BusServer server_{context_, *this};
  GatewayLine gateway_line_{context_, [this] { return robot_.now(); },
                            [this](const std::string& line) { client_event(line); }};
  sim::LiveRobot robot_;
};

int serve(const ServerOptions& options) {
  if (options.can.empty() && !options.pty && options.tcp.empty() && !options.descriptor && !options.gateway) {
    throw BadInput(
        "found no way to reach the robot, expected --pty, --tcp PORT, --can INTERFACE, --gateway NODE or --fd N");
  }
  const ScenarioRun run = prepare_run(options.scenario);
  print_warnings("proleg bus", run.scenario);
  const BrokenModules broken(options.broken, run.scenario);
  HilModules modules(options, run.scenario);
  require_native(broken, modules, run.scenario);
  std::vector<PlannedOutput> outputs = modules.planned_traces();
  if (options.can_log) {
    outputs.push_back({"--can-log", *options.can_log, "CAN log", starts_with(std::string(1, sim::candump_log_start))});
  }
  check_outputs(outputs);
  modules.flash("proleg bus");
  modules.open_traces();
  catch_interrupts();
  Server server(options, run, modules, broken);
  const double seconds = options.scenario.seconds ? run.scenario.duration_s : 0.0;
  server.serve(static_cast<sim::BusTime>(seconds * 1e9));
  modules.finish();
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg bus",
      "A simulated robot in real time, whose bus other programs reach as they reach a real one: with --bus of the "
      "other "
      "subcommands, and with any CAN tool. Its modules are switched on and wait for a host. The lines 'off' and 'on' "
      "of "
      "standard input switch its supply. Ends with Ctrl-C.");
  ServerOptions options;
  add_scenario(command_line, options.scenario.file, "scenario").required();
  command_line.add_option("--can", options.can, "a CAN interface of this computer, such as vcan0. May be repeated.")
      .value_name("INTERFACE");
  command_line.add_flag("--pty", options.pty, "slcan on a new pseudo terminal, whose name is printed");
  command_line
      .add_option("--tcp", options.tcp,
                  "slcan on a TCP port, for several programs at once; on this computer only, unless an ADDRESS of a "
                  "network is given. Port 0: any free one. May be repeated.")
      .value_name("[ADDRESS:]PORT");
  command_line.add_option("--fd", options.descriptor, "slcan on an open file descriptor; the robot ends with it")
      .value_name("N");
  command_line
      .add_option(
          "--gateway", options.gateway,
          "the module of this node is a gateway: its serial line (1 Mbaud) is a new pseudo terminal, whose name is "
          "printed, or a TCP port, for one program after the other")
      .value_name("NODE[=[ADDRESS:]PORT]");
  add_module_options(command_line, options);
  command_line
      .add_option("--fresh", options.fresh, "these modules come from the factory, without a node id: 1,3 or all")
      .value_name("NODES");
  command_line
      .add_option("--shuffle", options.shuffle,
                  "the modules have each other's node ids, in an order that this seed decides")
      .value_name("SEED");
  command_line
      .add_option("--broken", options.broken,
                  "this module needs 'proleg recover': " + BrokenModules::syntax() + ". May be repeated.")
      .value_name("NODE=KIND");
  command_line.add_option("--seconds", options.scenario.seconds, "end after this time");
  command_line.add_option("--seed", options.scenario.overrides.seed,
                          "seed of the crystals and unique ids, instead of that of the scenario");
  command_line.add_option("--can-log", options.can_log, "write all frames into this file, as 'candump -l' does");
  command_line.add_flag("--verbose", options.verbose, "print which programs come and go, and which joints have power");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return serve(options); });
}
