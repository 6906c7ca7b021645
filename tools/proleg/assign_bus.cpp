#include "tools/proleg/assign_bus.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "shared/computer/master_text/master_text.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

using canopen::LssMaster;
using canopen::LssRenumbering;

constexpr unsigned attempts = 4;
constexpr Microseconds second = 1'000'000;

/// A state machine of shared/master as the user of a bus.
template <typename Machine>
class MachineUser final : public host::BusUser {
 public:
  explicit MachineUser(Machine& machine) : machine_(machine) {}
  void receive(Microseconds now, const CanFrame& frame) override { machine_.receive(now, frame); }
  void transmitted(Microseconds now, const CanFrame& frame) override { machine_.transmitted(now, frame); }
  void poll(Microseconds now) override { machine_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const override { return machine_.next_deadline(); }

 private:
  Machine& machine_;
};

/// Whether the machine is done; false: it has failed.
template <typename Machine>
bool run(BusAccess& bus, Machine& machine, const std::string& what) {
  constexpr Microseconds longest = 300 * second;  // the machines end by themselves; this bounds one with a fault
  MachineUser<Machine> user(machine);
  bus.connection().attach(user);
  machine.start(bus.connection().now());
  try {
    bus.wait_for(what, longest, [&] { return machine.state() != Machine::State::working; });
  } catch (...) {
    bus.connection().detach(user);
    throw;
  }
  bus.connection().detach(user);
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

void reset_all(BusAccess& bus) {
  constexpr Microseconds boot_time = 400'000;
  bus.wait_for("room for a frame", second, [&bus] {
    return bus.connection().send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, 0}));
  });
  bus.connection().run_for(boot_time);
}

void number_fresh_modules(BusAccess& bus, std::span<const std::uint8_t> nodes, std::span<const std::uint32_t> serials) {
  for (unsigned attempt = 1;; ++attempt) {
    host::BusScan all(bus.connection());
    scan(bus, all);
    if (attempt == 1 && !all.has_fresh_modules()) {
      return;
    }
    std::vector<std::uint8_t> taken;
    for (const host::ScannedNode& node : all.nodes()) {
      taken.push_back(node.node);
    }
    std::vector<canopen::LssModule> entries = host::free_node_ids(nodes, serials, taken);
    canopen::LssMasterOptions options;
    options.attempts = attempts;
    LssMaster master(bus.connection(), entries, options);
    if (run(bus, master, "modules without a node id")) {
      return;
    }
    // A lost frame may have ended it: what was done shows in the next scan.
    if (attempt == attempts) {
      throw std::runtime_error(problem_of(serial_text(master.found()), master.problem(), master.problem_detail()));
    }
  }
}

std::vector<host::PlacedModule> find_modules(BusAccess& bus) {
  host::BusScan all(bus.connection());
  scan(bus, all);
  if (const auto duplicates = all.duplicates(); !duplicates.empty()) {
    throw std::runtime_error("several modules have the node id " + std::to_string(duplicates.front()) +
                             "; switch all but one of them off, and run proleg assign again");
  }
  std::vector<host::PlacedModule> modules;
  for (const host::ScannedNode& node : all.nodes()) {
    if (!node.is_module) {
      continue;
    }
    const canopen::LssAddress address{node.vendor, node.product, node.revision, node.serial};
    if (std::ranges::find(modules, address, &host::PlacedModule::address) != modules.end()) {
      throw std::runtime_error("two modules have the serial number " + hexadecimal(node.serial, 8) +
                               "; only one of them can be on the bus while node ids are given");
    }
    modules.push_back({node.node, address, std::nullopt});
  }
  if (modules.empty()) {
    throw std::runtime_error("found no joint module on the bus; " + bus.connection().diagnosis());
  }
  return modules;
}

void renumber(BusAccess& bus, std::span<const canopen::RenumberedModule> changes) {
  std::vector<canopen::RenumberedModule> modules(changes.begin(), changes.end());
  LssRenumbering renumbering(bus.connection(), modules);
  if (!run(bus, renumbering, "the modules to store their node ids")) {
    const auto stored = std::ranges::count(modules, true, &canopen::RenumberedModule::has_stored);
    throw std::runtime_error(problem_of(serial_text(modules[renumbering.problem_module()].address),
                                        renumbering.problem(), renumbering.problem_detail()) +
                             "; " + std::to_string(stored) + " of " + std::to_string(modules.size()) +
                             " modules have stored their new node ids. Run proleg assign again");
  }
}

MovingJoint::MovingJoint(BusAccess& bus, std::uint8_t node, const host::JointMotionOptions& options)
    : bus_(bus), motion_(bus.connection(), node, options) {
  using State = host::JointMotion::State;
  constexpr Microseconds longest = 60 * second;  // it ends by itself; this bounds one with a fault
  bus_.connection().attach(motion_);
  try {
    motion_.start(bus_.connection().now());
    bus_.wait_for("the joint to move", longest,
                  [this] { return motion_.state() == State::moving || motion_.state() == State::failed; });
    if (motion_.state() == State::failed) {
      throw std::runtime_error(
          problem_text(motion_.problem(), [](std::uint8_t its_node) { return "node " + std::to_string(its_node); }) +
          "; " + bus_.connection().diagnosis());
    }
  } catch (...) {
    static_cast<void>(try_to_stop());
    bus_.connection().detach(motion_);
    throw;
  }
}

MovingJoint::~MovingJoint() {
  if (!is_off_) {
    static_cast<void>(try_to_stop());
  }
  bus_.connection().detach(motion_);
}

bool MovingJoint::try_to_stop() {
  constexpr Microseconds longest = 20 * second;
  host::BusConnection& bus = bus_.connection();
  motion_.stop(bus.now());
  bus.run_until(bus.now() + longest, [this] { return motion_.state() == host::JointMotion::State::stopped; });
  is_off_ = motion_.state() == host::JointMotion::State::stopped;
  while (const auto event = motion_.take_event()) {
    is_off_ = is_off_ && event->kind != canopen::EventKind::not_stopped;
  }
  return is_off_;
}

void MovingJoint::stop() {
  if (!try_to_stop()) {
    throw std::runtime_error("the module has not confirmed that its servo has no power: switch the robot off");
  }
}

}  // namespace proleg::tools
