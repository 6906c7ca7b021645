#include "tools/proleg/robot/node_numbering.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "host/robot/node_plan.hpp"
#include "shared/computer/master/master_report.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

using canopen::LssMaster;
using canopen::LssRenumbering;

constexpr unsigned attempts = 4;
constexpr Microseconds releasing_time = 20'000;

/// Whether the machine is done; false: it has failed.
template <typename Machine>
bool run(BusAccess& bus, Machine& machine, const std::string& what) {
  constexpr Microseconds longest = 300'000'000;  // the machines end by themselves; this bounds one with a fault
  try {
    host::MachineUser<Machine> user(machine);
    const host::BusAttachment attachment(bus.connection(), user);
    machine.start(bus.connection().now());
    bus.wait_for(what, longest, [&] { return machine.state() != Machine::State::working; });
  } catch (...) {
    // No module stays selected: the next master would configure it with its own.
    static_cast<void>(bus.connection().send(canopen::lss_release_request()));
    bus.connection().run_for(releasing_time);
    throw;
  }
  return machine.state() == Machine::State::done;
}

std::string problem_of(const std::string& module, canopen::LssProblem problem, std::uint8_t detail) {
  std::string text = module + ": " + std::string(describe(problem));
  if (problem == canopen::LssProblem::store_refused || problem == canopen::LssProblem::node_refused) {
    text += " (error " + std::to_string(detail) + ")";
  }
  return text;
}

std::string serial_text(const canopen::LssAddress& address) {
  return "the module with the serial number " + hexadecimal(address.back(), 8);
}

}  // namespace

unsigned number_fresh_modules(BusAccess& bus, std::span<const std::uint8_t> nodes,
                              std::span<const std::uint32_t> serials, std::span<const std::uint8_t> taken) {
  unsigned numbered = 0;
  for (unsigned attempt = 1;; ++attempt) {
    host::BusScan all(bus.connection());
    scan(bus, all);
    if (attempt == 1 && !all.has_fresh_modules()) {
      return 0;
    }
    std::vector<std::uint8_t> all_taken(taken.begin(), taken.end());
    for (const host::ScannedNode& node : all.nodes()) {
      all_taken.push_back(node.node);
    }
    std::vector<canopen::LssModule> entries = host::free_node_ids(nodes, serials, all_taken);
    canopen::LssMasterOptions options;
    options.attempts = attempts;
    options.first_answer_timeout_us = host::patient_timeout_us;
    LssMaster master(bus.connection(), entries, options);
    const bool is_done = run(bus, master, "modules without a node id");
    numbered += master.assigned();
    if (is_done) {
      return numbered;
    }
    // A lost frame may have ended it: what was done shows in the next scan.
    if (attempt == attempts) {
      throw std::runtime_error(problem_of(serial_text(master.found()), master.problem(), master.problem_detail()));
    }
  }
}

void renumber(BusAccess& bus, std::span<canopen::RenumberedModule> modules, std::uint8_t reset_node) {
  canopen::LssRenumberingOptions options;
  options.reset_node = reset_node;
  LssRenumbering renumbering(bus.connection(), modules, options);
  if (!run(bus, renumbering, "the modules to store their node ids")) {
    const auto stored = std::ranges::count(modules, true, &canopen::RenumberedModule::has_stored);
    throw std::runtime_error(problem_of(serial_text(modules[renumbering.problem_module()].address),
                                        renumbering.problem(), renumbering.problem_detail()) +
                             "; " + std::to_string(stored) + " of " + std::to_string(modules.size()) +
                             " node ids were stored");
  }
}

}  // namespace proleg::tools
