#include "tools/proleg/flash/module_search.hpp"

#include <algorithm>
#include <string>

#include "host/flash/start_hold.hpp"
#include "shared/canopen/messages.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/flash/flash_modules.hpp"

namespace proleg::tools {
namespace {

using host::FlashCandidate;
using host::Remedy;
namespace flag = broadcast::module_flag;

constexpr Microseconds second = 1'000'000;

std::vector<FlashCandidate> candidates_of(const std::vector<RecoveredModule>& modules) {
  std::vector<FlashCandidate> candidates;
  candidates.reserve(modules.size());
  for (const RecoveredModule& module : modules) {
    candidates.push_back(module.now);
  }
  return candidates;
}

}  // namespace

/// A module that was missing at the first look, while others were there, did not answer: its supply was on, too. If
/// none was there, the supply of all may have been off; then only the modules that a person has named are known to be
/// silent.
void ModuleSearch::add(const FlashCandidate& found) {
  const bool is_named = std::ranges::find(settings_.serials, found.program.serial) != settings_.serials.end();
  const bool was_silent = has_looked_ && (has_seen_any_ || is_named);
  modules_.push_back({found, found, true, was_silent, {}, {}, {}, {}, {}});
}

/// A person may switch the supply off and on meanwhile: that is the way to a module whose program is silent.
void ModuleSearch::wait() {
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
  if (settings_.wait_us > 0) {
    search(settings_.wait_us, settings_.serials, is_heard);
  }
}

void ModuleSearch::search(Microseconds longest, const std::vector<std::uint32_t>& serials,
                          const std::function<bool()>& is_heard) {
  TerminalLine line(std::chrono::milliseconds(0));
  const Microseconds begin = bus_.connection().now();
  const Microseconds end = begin + longest;
  Microseconds report_at = begin;
  bool have_answered = false;
  for (Microseconds now = begin; now < end && !have_answered; now = bus_.connection().now()) {
    if (settings_.on_wait && now >= report_at) {
      settings_.on_wait({longest, end - now, modules_.size()});
      report_at += (now - report_at) / second * second + second;
    }
    if (!settings_.report.has_events() && line.is_due()) {
      line.draw("waits for modules whose program does not start: " + std::to_string((now - begin) / second) + " s of " +
                std::to_string(longest / second) + "; " + std::to_string(modules_.size()) + " modules were seen");
    }
    if (!is_heard()) {
      bus_.connection().run_until(std::min(end, now + second), is_heard);  // no look ends on a bus without a node
      continue;
    }
    for (const FlashCandidate& found : find_silent_modules(bus_, candidates_of(modules_))) {
      add(found);
    }
    hold();
    have_answered = !serials.empty() && ask(serials);
  }
  if (settings_.on_wait) {
    settings_.on_wait({longest, 0, modules_.size()});
  }
}

bool ModuleSearch::ask(const std::vector<std::uint32_t>& serials) {
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

void ModuleSearch::hold() {
  std::vector<std::uint32_t> serials;
  for (const RecoveredModule& module : modules_) {
    if (!module.now.program.is(flag::runs_program)) {
      serials.push_back(module.serial());
    }
  }
  ask(serials);
}

RecoveredModule* ModuleSearch::find(std::uint32_t serial) {
  const auto module = std::ranges::find(modules_, serial, &RecoveredModule::serial);
  return module == modules_.end() ? nullptr : &*module;
}

void ModuleSearch::look() {
  find_present();
  await_absent();
  if (await_supply()) {
    find_present();  // the supply of the others was switched, too
  }
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

void ModuleSearch::find_present() {
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
}

void ModuleSearch::ask_all() {
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

std::vector<std::uint32_t> ModuleSearch::absent() const {
  std::vector<std::uint32_t> serials;
  for (const RecoveredModule& module : modules_) {
    if (!module.is_present) {
      serials.push_back(module.serial());
    }
  }
  return serials;
}

/// A module that was seen before may have started its program again, which hangs: it comes back.
void ModuleSearch::await_absent() {
  const Microseconds end = bus_.connection().now() + RecoverySettings{}.wait_us;
  for (std::vector<std::uint32_t> serials = absent(); !serials.empty() && bus_.connection().now() < end;
       serials = absent()) {
    ask(serials);
    hold();
  }
}

/// Such a module was in its bootloader because its supply had been switched off and on shortly before.
bool ModuleSearch::await_supply() {
  constexpr Microseconds shortest = 30 * second;  // for a person at the switch
  const std::vector<std::uint32_t> serials = absent();
  const bool is_of_use = settings_.image && std::ranges::any_of(modules_, [](const RecoveredModule& module) {
                           return !module.is_present && module.tries.contains(Remedy::start);
                         });
  if (!is_of_use || has_awaited_supply_) {
    return false;
  }
  has_awaited_supply_ = true;
  for (RecoveredModule& module : modules_) {
    if (module.is_present) {
      module.tries.erase(Remedy::start);  // its program ran, and is to start again
    }
  }
  host::StartHold start_hold(bus_.connection());
  const host::BusAttachment attachment(bus_.connection(), start_hold);
  search(std::max(settings_.wait_us, shortest), serials, [] { return true; });
  return true;
}

void ModuleSearch::diagnose(RecoveredModule& module) {
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

std::vector<std::uint8_t> ModuleSearch::taken_nodes() const {
  std::vector<std::uint8_t> taken = others_;
  for (const RecoveredModule& module : modules_) {
    taken.push_back(module.now.node);
  }
  return taken;
}

}  // namespace proleg::tools
