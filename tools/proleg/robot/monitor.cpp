// proleg monitor: what happens on the bus of a robot.

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <optional>
#include <string>

#include "host/robot/bus_monitor.hpp"
#include "host/robot/state_text.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct MonitorOptions : BusOptions {
  std::optional<std::string> seconds;
  bool json = false;
};

constexpr Microseconds show_period_us = 1'000'000;
constexpr Microseconds silent_us = 1'000'000;

double degrees(std::int32_t angle) { return angle * 90.0 / (1 << 30); }

std::optional<double> measured_degrees(const host::MonitoredNode& node) {
  return node.position ? std::optional(degrees(*node.position)) : std::nullopt;
}

std::string fixed_text(std::optional<double> value, const char* unit) {
  if (!value) {
    return "-";
  }
  char text[32];
  std::snprintf(text, sizeof text, "%.1f%s", *value, unit);
  return text;
}

std::string contacts_text(const host::MonitoredNode& node) {
  std::string text;
  for (unsigned bit = 0; node.contacts && bit < 4; ++bit) {
    text += (*node.contacts >> bit & 1U) != 0 ? '#' : '.';
  }
  return text.empty() ? "-" : text;
}

std::string fault_text(const host::MonitoredNode& node, bool is_silent) {
  if (is_silent) {
    return "silent";
  }
  if (node.error_register.value_or(0) == 0) {
    return "";
  }
  return node.last_emergency ? std::string(canopen::describe(node.last_emergency->code)) : "reports an error";
}

void print_table(const host::BusMonitor& monitor, const host::BusMonitor::Traffic& traffic, Microseconds now,
                 bool redraws) {
  if (redraws) {
    std::fputs("\033[H\033[J", stdout);
  }
  std::printf("%u SYNC, %llu frames, bus load about %.1f %%%s\n", traffic.syncs,
              static_cast<unsigned long long>(traffic.frames), 100 * traffic.load,
              monitor.has_host(now) ? ", driven by a host" : "");
  std::printf("%-5s %-16s %-18s %10s %10s %8s %9s %6s  %s\n", "node", "state", "drive", "set-point", "angle",
              "contacts", "current", "chip", "fault");
  for (const host::MonitoredNode& node : monitor.nodes()) {
    const std::optional<double> current(node.current_ma);
    const std::optional<double> temperature(node.temperature_c);
    std::printf("%-5u %-16s %-18s %10s %10s %8s %9s %6s  %s\n", unsigned{node.node},
                node.state        ? std::string(host::state_text(*node.state)).c_str()
                : node.statusword ? "not driven"
                                  : "no heartbeat",
                node.statusword ? std::string(host::drive_text(*node.statusword)).c_str() : "-",
                fixed_text(node.setpoint ? std::optional(degrees(*node.setpoint)) : std::nullopt, " deg").c_str(),
                fixed_text(measured_degrees(node), " deg").c_str(), contacts_text(node).c_str(),
                fixed_text(current, " mA").c_str(), fixed_text(temperature, " C").c_str(),
                fault_text(node, node.last_heard + silent_us < now).c_str());
  }
  if (!monitor.has_host(now)) {
    std::printf(
        "no host drives the robot, and modules that no host has set up send nothing by themselves: "
        "'proleg scan' asks them, 'proleg drive FILE' drives them\n");
  }
  std::fflush(stdout);
}

/// One line.
void print_json(const host::BusMonitor& monitor, const host::BusMonitor::Traffic& traffic, Microseconds now) {
  Json nodes = Json::empty_array();
  for (const host::MonitoredNode& node : monitor.nodes()) {
    const bool is_silent = node.last_heard + silent_us < now;
    nodes.append({{"node", unsigned{node.node}},
                  {"state", node.state ? Json(host::state_text(*node.state)) : Json()},
                  {"drive", node.statusword ? Json(host::drive_text(*node.statusword)) : Json()},
                  {"setpoint_deg", node.setpoint ? Json(degrees(*node.setpoint)) : Json()},
                  {"angle_deg", measured_degrees(node)},
                  {"contacts", node.contacts ? Json(unsigned{*node.contacts}) : Json()},
                  {"current_ma", node.current_ma ? Json(*node.current_ma) : Json()},
                  {"temperature_c", node.temperature_c ? Json(*node.temperature_c) : Json()},
                  {"error_register", node.error_register ? Json(unsigned{*node.error_register}) : Json()},
                  {"silent", is_silent},
                  {"fault", fault_text(node, is_silent)}});
  }
  std::string line;
  bool is_indentation = false;
  for (const char character : Json{
           {"syncs", traffic.syncs},
           {"frames", traffic.frames},
           {"bus_load", traffic.load},
           {"host", monitor.has_host(now)},
           {"nodes", nodes}}.text()) {
    is_indentation = character == '\n' || (is_indentation && character == ' ');
    if (!is_indentation) {
      line += character;
    }
  }
  std::cout << line << std::endl;
}

int run(const MonitorOptions& options) {
  std::optional<double> seconds;
  if (options.seconds) {
    seconds = parse_number(*options.seconds);
    if (!seconds || *seconds <= 0 || *seconds > 1e9) {
      throw InputError("--seconds", 0, in_quotes(*options.seconds), "a number above 0");
    }
  }
  BusAccess bus(options);
  catch_interrupts();
  host::BusConnection& connection = bus.connection();
  host::BusMonitor monitor(connection);
  const host::BusAttachment attachment(connection, monitor);
  const bool redraws = isatty(STDOUT_FILENO) == 1;
  const Microseconds begin = connection.now();
  const auto is_over = [&] {
    return interrupted() || !connection.state().is_connected ||
           (seconds && static_cast<double>(connection.now() - begin) * 1e-6 >= *seconds);
  };
  for (Microseconds next = begin + show_period_us; !is_over(); next += show_period_us) {
    connection.run_until(next, is_over);
    if (interrupted()) {
      break;
    }
    const Microseconds now = connection.now();
    const host::BusMonitor::Traffic traffic = monitor.take_traffic(now);
    options.json ? print_json(monitor, traffic, now) : print_table(monitor, traffic, now, redraws);
  }
  const host::Statistics numbers = connection.statistics();
  if (!connection.state().is_connected || (numbers.received == 0 && numbers.malformed > 0)) {
    std::cerr << "proleg monitor: " << connection.diagnosis() << '\n';
    return exit_failed;
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg monitor",
      "Shows what the modules on a bus do: set-point, angle, contacts, current, temperature, faults. "
      "Reads only. Ends with Ctrl-C.");
  MonitorOptions options;
  add_bus_option(command_line, options);
  command_line.add_option("--seconds", options.seconds, "end after this time");
  command_line.add_flag("--json", options.json, "print one JSON object a second, each on a line");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return run(options); });
}
