#include "tools/proleg/flash/recovery.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "host/flash/start_hold.hpp"
#include "host/robot/node_plan.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/terminal.hpp"
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

std::uint32_t serial_of(const RecoveredModule& module) { return module.now.program.serial; }

canopen::LssAddress address_of(const FlashCandidate& module) {
  return {object::vendor.default_value, module.board_id, object::revision.default_value, module.program.serial};
}

std::vector<FlashCandidate> candidates_of(const std::vector<RecoveredModule>& modules) {
  std::vector<FlashCandidate> candidates;
  candidates.reserve(modules.size());
  for (const RecoveredModule& module : modules) {
    candidates.push_back(module.now);
  }
  return candidates;
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
  return missing_.empty() && std::ranges::all_of(modules_, &RecoveredModule::is_well);
}

void Recovery::examine() {
  wait();
  look();
  if (modules_.empty()) {
    throw std::runtime_error("found no joint module on the bus; " + bus_.connection().diagnosis());
  }
  require_no_power();
  for (RecoveredModule& module : modules_) {
    module.before = module.now;
    module.first_faults = module.faults;
  }
}

/// A module that was missing at the first look, while others were there, did not answer: its supply was on, too. If
/// none was there, the supply of all may have been off; then only the modules that a person has named are known to be
/// silent.
void Recovery::add(const FlashCandidate& found) {
  const bool is_named = std::ranges::find(settings_.serials, found.program.serial) != settings_.serials.end();
  const bool was_silent = has_looked_ && (has_seen_any_ || is_named);
  modules_.push_back({found, found, true, was_silent, {}, {}, {}, {}, {}});
}

/// A person may switch the supply off and on meanwhile: that is the way to a module whose program is silent.
void Recovery::wait() {
  constexpr Microseconds time_to_be_heard = second / 4;
  host::StartHold start_hold(bus_.connection());
  const host::BusAttachment attachment(bus_.connection(), start_hold);
  const auto is_heard = [&] {
    return start_hold.is_heard() || interrupted() || !bus_.connection().state().is_connected;
  };
  bus_.connection().run_until(bus_.connection().now() + time_to_be_heard, is_heard);
  if (is_heard()) {
    // On a bus that loses frames a look takes longer than such a module stays on the bus.
    look();
  }
  has_looked_ = true;
  has_seen_any_ = !modules_.empty();
  if (settings_.on_wait && settings_.wait_us != 0) {
    settings_.on_wait();
  }
  const Microseconds begin = bus_.connection().now();
  const Microseconds end = begin + settings_.wait_us;
  bus_.connection().run_until(end, is_heard);  // no look ends on a bus on which no node acknowledges
  TerminalLine line(std::chrono::milliseconds(0));
  for (Microseconds now = bus_.connection().now(); now < end; now = bus_.connection().now()) {
    if (!settings_.report.has_events() && line.is_due()) {
      line.draw("waits for modules whose program does not start: " + std::to_string((now - begin) / second) + " s of " +
                std::to_string(settings_.wait_us / second) + "; " + std::to_string(modules_.size()) +
                " modules were seen");
    }
    for (const FlashCandidate& found : find_silent_modules(bus_, candidates_of(modules_))) {
      add(found);
    }
    hold();
    if (!settings_.serials.empty() && ask(settings_.serials)) {
      return;
    }
  }
}

bool Recovery::ask(const std::vector<std::uint32_t>& serials) {
  host::ModuleQuery query(bus_.connection(), host::ModuleQueryOptions{.attempts = 3});
  const host::BusAttachment attachment(bus_.connection(), query);
  query.start(bus_.connection().now(), serials);
  bus_.wait_for("the answers of the modules", 120 * second, [&query] { return query.is_done(); });
  bool have_answered = true;
  for (const host::ModuleProgram& program : query.modules()) {
    have_answered = have_answered && program.has_answered;
    if (RecoveredModule* const module = find(program.serial); module != nullptr) {
      module->now.program = program;
      module->is_present = module->is_present || program.has_answered;
    }
  }
  return have_answered;
}

void Recovery::hold() {
  std::vector<std::uint32_t> serials;
  for (const RecoveredModule& module : modules_) {
    if (!module.now.program.is(flag::runs_program)) {
      serials.push_back(serial_of(module));
    }
  }
  ask(serials);
}

RecoveredModule* Recovery::find(std::uint32_t serial) {
  const auto module = std::ranges::find(modules_, serial, serial_of);
  return module == modules_.end() ? nullptr : &*module;
}

void Recovery::look() {
  hold();
  FoundModules found = look_for_modules(bus_, SilentSearch::always);
  silent_ = found.silent;
  others_ = found.foreign;
  others_.insert(others_.end(), silent_.begin(), silent_.end());
  for (RecoveredModule& module : modules_) {
    module.is_present = false;
  }
  for (const FlashCandidate& one : found.modules) {
    if (RecoveredModule* const module = find(one.program.serial); module != nullptr) {
      module->now = one;
      module->is_present = true;
    } else {
      add(one);
    }
  }
  await_absent();
  ask_all();
  for (RecoveredModule& module : modules_) {
    diagnose(module);
  }
  std::ranges::stable_sort(modules_, {}, [](const RecoveredModule& module) {
    return module.now.node == 0 ? unsigned{canopen::host_node} : module.now.node;
  });
  missing_.clear();
  for (const std::uint32_t serial : settings_.serials) {
    if (find(serial) == nullptr) {
      missing_.push_back(serial);
    }
  }
}

void Recovery::ask_all() {
  constexpr unsigned attempts = 4;  // a header has many words, and frames may be lost
  for (unsigned attempt = 0; attempt < attempts; ++attempt) {
    std::vector<FlashCandidate> candidates = candidates_of(modules_);
    ask_programs(bus_, candidates);
    bool is_complete = true;
    for (std::size_t i = 0; i < modules_.size(); ++i) {
      const host::ModuleProgram& program = candidates[i].program;
      is_complete = is_complete && program.has_answered && program.image.has_value() == program.is(flag::has_image);
      modules_[i].now = candidates[i];
    }
    if (is_complete) {
      return;
    }
  }
}

/// A module that was seen before may have started its program again, which hangs: it comes back.
void Recovery::await_absent() {
  const Microseconds end = bus_.connection().now() + RecoverySettings{}.wait_us;
  for (;;) {
    std::vector<std::uint32_t> absent;
    for (const RecoveredModule& module : modules_) {
      if (!module.is_present) {
        absent.push_back(serial_of(module));
      }
    }
    if (absent.empty() || bus_.connection().now() >= end) {
      return;
    }
    ask(absent);
    hold();
  }
}

void Recovery::diagnose(RecoveredModule& module) {
  std::vector<FlashCandidate> present;
  for (const RecoveredModule& one : modules_) {
    if (one.is_present) {
      present.push_back(one.now);
    }
  }
  const host::RecoveryMeans means{settings_.image ? &settings_.image->header : nullptr, settings_.resets_settings,
                                  module.tries.contains(Remedy::start), module.was_silent};
  module.faults = module.is_present ? find_module_faults(module.now, present, means) : std::vector<host::ModuleFault>();
}

void Recovery::require_no_power() const {
  for (const RecoveredModule& module : modules_) {
    if (module.now.program.is(flag::is_busy)) {
      throw std::runtime_error(name_of(module.now) +
                               ": its servo has power, or it is Operational; nothing was changed. Stop the robot first "
                               "('proleg nmt pre-operational all' takes the power: the joints go limp)");
    }
  }
}

void Recovery::recover() {
  while (apply()) {
    look();
    require_no_power();
  }
}

std::vector<RecoveredModule*> Recovery::take(Remedy remedy) {
  // Frames may be lost. What takes long makes up for that by itself.
  const unsigned max_tries = remedy == Remedy::start || remedy == Remedy::flash ? 1 : 4;
  std::vector<RecoveredModule*> modules;
  for (RecoveredModule& module : modules_) {
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
        send(bus_, broadcast::select_frame(session, serial_of(*one.module)));
        bus_.connection().run_for(time_to_select);  // two answers would have the same identifier
        ++one.requests;
      }
    }
    send(bus_, broadcast::leave_frame(session));
    bus_.connection().run_for(time_to_start);
    hold();
    for (const StartedModule& one : waiting) {
      if (one.module->now.program.is(flag::runs_program)) {
        ask({serial_of(*one.module)});  // whether it has confirmed itself
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
  number_fresh_modules(bus_, {}, {}, taken_nodes());
}

std::vector<std::uint8_t> Recovery::taken_nodes() const {
  std::vector<std::uint8_t> taken = others_;
  for (const RecoveredModule& module : modules_) {
    taken.push_back(module.now.node);
  }
  return taken;
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
  const std::vector<canopen::LssModule> free = host::free_node_ids({}, {}, taken_nodes());
  std::size_t used = 0;
  std::vector<canopen::RenumberedModule> changes;
  for (const RecoveredModule& module : modules_) {
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
