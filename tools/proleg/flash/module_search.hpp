#pragma once

// Finds the modules on a bus, also those whose program does not start, and what is wrong with each of them.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/flash/image_file.hpp"
#include "host/flash/module_fault.hpp"
#include "tools/proleg/common/program_report.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

/// How far a wait for modules is in which a person may switch the supply off and on.
struct SupplyWait {
  Microseconds longest = 0;  ///< it may end before
  Microseconds rest = 0;     ///< longest at its beginning, 0 when it has ended
  std::size_t seen = 0;      ///< number of modules that were seen
};

struct RecoverySettings {
  /// A program that hangs is started five times, a second each, before its bootloader stays on the bus for ten seconds.
  /// Between, nothing shows that there is a module.
  Microseconds wait_us = 8'000'000;
  std::vector<std::uint32_t> serials;  ///< the wait ends when these modules were seen; empty: it does not end before
  std::optional<host::ImageFile> image;
  bool resets_settings = false;
  ProgramReport report;  ///< of what takes long
  /// Called when a wait begins, about once a second, and when it has ended.
  std::function<void(const SupplyWait& wait)> on_wait;
};

struct RecoveredModule {
  host::FlashCandidate before;
  host::FlashCandidate now;
  bool is_present = true;   ///< else it has answered before
  bool was_silent = false;  ///< RecoveryMeans
  std::vector<host::ModuleFault> first_faults;
  std::vector<host::ModuleFault> faults;  ///< now
  std::map<host::Remedy, unsigned> tries;
  std::vector<std::string> done;  ///< "was flashed"
  std::string problem;            ///< of the last remedy that has failed; empty: none

  [[nodiscard]] std::uint32_t serial() const { return now.program.serial; }
  [[nodiscard]] bool is_well() const { return is_present && faults.empty(); }
};

class ModuleSearch {
 public:
  /// settings must outlive the object.
  ModuleSearch(BusAccess& bus, const RecoverySettings& settings) : bus_(bus), settings_(settings) {}

  /// Looks for modules that are silent most of the time, as long as the settings say.
  void wait();
  /// Finds out which modules are there now, and what is wrong with each.
  void look();
  /// Asks these modules for their programs. Whether all have answered.
  bool ask(const std::vector<std::uint32_t>& serials);
  /// Asks all modules that run no program: their bootloaders stay on the bus for ten seconds then.
  void hold();

  [[nodiscard]] std::vector<RecoveredModule>& modules() { return modules_; }
  [[nodiscard]] const std::vector<RecoveredModule>& modules() const { return modules_; }
  /// Serial numbers of the settings that no module has.
  [[nodiscard]] const std::vector<std::uint32_t>& missing() const { return missing_; }
  /// Nodes that send, answer nothing, and are no modules.
  [[nodiscard]] const std::vector<std::uint8_t>& silent() const { return silent_; }
  /// Node ids of modules and of other nodes.
  [[nodiscard]] std::vector<std::uint8_t> taken_nodes() const;

 private:
  /// Looks for modules, which a person may bring back by the supply, until all of these have answered; empty: until the
  /// time is over.
  void search(Microseconds longest, const std::vector<std::uint32_t>& serials, const std::function<bool()>& is_heard);
  void add(const host::FlashCandidate& found);
  void find_present();
  void ask_all();
  [[nodiscard]] std::vector<std::uint32_t> absent() const;
  void await_absent();
  /// Waits, once, for a person who brings back the modules whose program was started and answers nothing. Whether there
  /// was such a wait.
  bool await_supply();
  /// The module with this serial number; null: none has it.
  [[nodiscard]] RecoveredModule* find(std::uint32_t serial);
  void diagnose(RecoveredModule& module);

  BusAccess& bus_;
  const RecoverySettings& settings_;
  std::vector<RecoveredModule> modules_;
  std::vector<std::uint32_t> missing_;
  bool has_looked_ = false;
  bool has_seen_any_ = false;  ///< at the first look
  bool has_awaited_supply_ = false;
  std::vector<std::uint8_t> silent_;
  std::vector<std::uint8_t> others_;  ///< node ids of nodes that are no modules
};

}  // namespace proleg::tools
