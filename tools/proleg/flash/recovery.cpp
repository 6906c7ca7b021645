#include "tools/proleg/flash/recovery.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "host/robot/node_plan.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/flash/flash_modules.hpp"
#include "tools/proleg/flash/update_run.hpp"
#include "tools/proleg/robot/node_numbering.hpp"

namespace proleg::tools {
namespace {

using host::FlashCandidate;
using host::Remedy;
namespace flag = broadcast::module_flag;
namespace object = canopen::object;

constexpr Microseconds second = 1'000'000;

canopen::LssAddress address_of(const FlashCandidate& module) {
  return {object::vendor.default_value, module.board_id, object::revision.default_value, module.program.serial};
}

bool is_in_bootloader(const host::ModuleProgram& program) {
  return program.has_answered && !program.is(flag::runs_program);
}
bool runs_well(const host::ModuleProgram& program) {
  return program.is(flag::runs_program) && program.is(flag::is_confirmed);
}

/// A module whose program is to start.
struct StartedModule {
  /// Frames may be lost, and a program that was given up comes back at once.
  static constexpr unsigned max_requests = 3;

  RecoveredModule* module = nullptr;
  unsigned requests = 0;

  [[nodiscard]] bool has_ended() const {
    const host::ModuleProgram& program = module->now.program;
    const bool is_given_up = requests >= max_requests || program.is(flag::starts_badly);
    return runs_well(program) || (is_in_bootloader(program) && is_given_up);
  }
};

void send(BusAccess& bus, const CanFrame& frame) {
  bus.wait_for("room for a frame", second, [&] { return bus.connection().send(frame); });
}

}  // namespace

bool Recovery::are_all_well() const {
  return search_.missing().empty() && std::ranges::all_of(search_.modules(), &RecoveredModule::is_well);
}

void Recovery::examine() {
  search_.wait();
  search_.look();
  if (search_.modules().empty()) {
    throw std::runtime_error("found no joint module on the bus; " + bus_.connection().diagnosis());
  }
  require_no_power();
  for (RecoveredModule& module : search_.modules()) {
    module.before = module.now;
    module.first_faults = module.faults;
  }
}

void Recovery::require_no_power() const {
  for (const RecoveredModule& module : search_.modules()) {
    if (module.now.program.is(flag::is_busy)) {
      throw std::runtime_error(name_of(module.now) +
                               ": its servo has power, or it is Operational; nothing was changed. Stop the robot first "
                               "('proleg nmt pre-operational all' takes the power: the joints go limp)");
    }
  }
}

void Recovery::recover() {
  while (apply()) {
    search_.look();
    require_no_power();
  }
}

std::vector<RecoveredModule*> Recovery::take(Remedy remedy) {
  // Frames may be lost. What takes long makes up for that by itself.
  const unsigned max_tries = remedy == Remedy::start || remedy == Remedy::flash ? 1 : 4;
  std::vector<RecoveredModule*> modules;
  for (RecoveredModule& module : search_.modules()) {
    const bool is_due = std::ranges::find(module.faults, remedy, &host::ModuleFault::remedy) != module.faults.end();
    if (is_due && module.tries[remedy] < max_tries) {
      ++module.tries[remedy];
      modules.push_back(&module);
    }
  }
  return modules;
}

/// Programs first: what follows needs one, and the node id that a module has does not matter to them.
bool Recovery::apply() {
  using Apply = void (Recovery::*)(const std::vector<RecoveredModule*>&);
  struct Step {
    Remedy remedy;
    Apply apply;
  };
  static constexpr std::array steps{
      Step{Remedy::start, &Recovery::start},       Step{Remedy::flash, &Recovery::flash},
      Step{Remedy::renumber, &Recovery::renumber}, Step{Remedy::number, &Recovery::number},
      Step{Remedy::restart, &Recovery::restart},   Step{Remedy::reset_settings, &Recovery::reset_settings}};
  for (const Step& step : steps) {
    const std::vector<RecoveredModule*> modules = take(step.remedy);
    if (modules.empty()) {
      continue;
    }
    try {
      (this->*step.apply)(modules);
    } catch (const std::runtime_error& error) {
      if (interrupted() || !bus_.connection().state().is_connected) {
        throw;
      }
      for (RecoveredModule* const module : modules) {
        module->problem = error.what();
      }
    }
    return true;
  }
  return false;
}

/// The bootloader starts the program when a host's session ends. One that hangs is started five times.
void Recovery::start(const std::vector<RecoveredModule*>& modules) {
  constexpr Microseconds longest = 8 * second;
  constexpr Microseconds time_to_select = 50'000;
  constexpr Microseconds time_to_start = 400'000;
  const std::uint8_t session = new_session(bus_);
  std::vector<StartedModule> waiting;
  waiting.reserve(modules.size());
  for (RecoveredModule* const module : modules) {
    waiting.push_back({module, 0});
  }
  const Microseconds end = bus_.connection().now() + longest;
  while (!waiting.empty() && bus_.connection().now() < end) {
    for (StartedModule& one : waiting) {
      if (is_in_bootloader(one.module->now.program)) {
        send(bus_, broadcast::select_frame(session, one.module->serial()));
        bus_.connection().run_for(time_to_select);  // two answers would have the same identifier
        ++one.requests;
      }
    }
    send(bus_, broadcast::leave_frame(session));
    bus_.connection().run_for(time_to_start);
    search_.hold();
    for (const StartedModule& one : waiting) {
      if (one.module->now.program.is(flag::runs_program)) {
        search_.ask({one.module->serial()});  // whether it has confirmed itself
      }
    }
    std::erase_if(waiting, [](const StartedModule& one) { return one.has_ended(); });
  }
  for (RecoveredModule* const module : modules) {
    if (runs_well(module->now.program)) {
      module->done.emplace_back("its program was started");
    }
  }
}

/// Gateways last, one after the other: through one that fails the host may have reached the next one.
void Recovery::flash(const std::vector<RecoveredModule*>& modules) {
  std::vector<FlashCandidate> candidates;
  std::vector<RecoveredModule*> ordinary;
  for (RecoveredModule* const module : modules) {
    candidates.push_back(module->now);
    if (!module->now.program.is(flag::is_gateway)) {
      ordinary.push_back(module);
    }
  }
  wait_for_sessions(bus_, candidates);
  if (!ordinary.empty()) {
    flash_at_once(ordinary, false);
  }
  for (RecoveredModule* const module : modules) {
    if (module->now.program.is(flag::is_gateway)) {
      flash_at_once({module}, true);
      if (!module->problem.empty()) {
        return;
      }
    }
  }
}

void Recovery::flash_at_once(const std::vector<RecoveredModule*>& modules, bool through_its_line) {
  std::vector<FlashCandidate> candidates;
  candidates.reserve(modules.size());
  for (const RecoveredModule* const module : modules) {
    candidates.push_back(module->now);
  }
  const UpdateRun run = run_update(bus_, settings_.image->bytes, candidates, through_its_line, settings_.report);
  for (std::size_t i = 0; i < modules.size(); ++i) {
    const host::UpdatedModule& result = run.modules[i];
    if (result.outcome == host::UpdateOutcome::runs) {
      modules[i]->done.emplace_back("it was flashed");
    } else {
      modules[i]->problem = "after the image was sent: " + describe(result.outcome, result.detail);
      ++modules[i]->tries[Remedy::start];  // that was part of it
    }
  }
}

void Recovery::number(const std::vector<RecoveredModule*>& /*modules*/) {
  number_fresh_modules(bus_, {}, {}, search_.taken_nodes());
}

void Recovery::renumber(const std::vector<RecoveredModule*>& modules) {
  std::set<std::uint8_t> shared;
  for (const RecoveredModule* const module : modules) {
    shared.insert(module->now.node);
  }
  for (const std::uint8_t node : shared) {
    renumber_duplicates(node);
  }
}

/// Gives modules that have this node id in common ids of their own, and restarts them by the common id. A module in its
/// bootloader starts its program again.
void Recovery::renumber_duplicates(std::uint8_t node) {
  const std::vector<canopen::LssModule> free = host::free_node_ids({}, {}, search_.taken_nodes());
  std::size_t used = 0;
  std::vector<canopen::RenumberedModule> changes;
  for (const RecoveredModule& module : search_.modules()) {
    if (!module.is_present || module.now.node != node) {
      continue;
    }
    const bool keeps =
        std::ranges::find(module.faults, Remedy::keep_number, &host::ModuleFault::remedy) != module.faults.end();
    if (!keeps && used == free.size()) {
      throw std::runtime_error("no node id is free");
    }
    changes.push_back(
        {address_of(module.now), keeps ? node : free[used++].node, module.now.program.is(flag::runs_program)});
  }
  try {
    tools::renumber(bus_, changes, node);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(error.what()) + "; run proleg recover again");
  }
}

void Recovery::restart(const std::vector<RecoveredModule*>& modules) {
  constexpr Microseconds boot_time = 400'000;
  for (RecoveredModule* const module : modules) {
    send(bus_, canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, module->now.node}));
    module->done.emplace_back("it was restarted");
  }
  bus_.connection().run_for(boot_time);
}

void Recovery::reset_settings(const std::vector<RecoveredModule*>& modules) {
  host::SdoQueue queue(bus_.connection(), patient_transfers());
  for (RecoveredModule* const module : modules) {
    queue.write(module->now.node, object::store_parameters.address, object::store_parameters.type,
                canopen::signature_save, [module](const host::SdoResult& result) {
                  if (result.is_good()) {
                    module->done.emplace_back("all settings but its node id have their default values now");
                  } else {
                    module->problem = "it did not save its settings: " + std::string(describe(result.abort_code));
                  }
                });
  }
  finish(bus_, queue);
}

}  // namespace proleg::tools
