#pragma once

// Finds modules that are of no use as they are, and brings them back (host/flash/module_fault.hpp).

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

struct RecoverySettings {
  /// A program that hangs is started five times, a second each, before its bootloader stays on the bus for ten seconds.
  /// Between, nothing shows that there is a module.
  Microseconds wait_us = 8'000'000;
  std::vector<std::uint32_t> serials;  ///< the wait ends when these modules were seen; empty: it does not end before
  std::optional<host::ImageFile> image;
  bool resets_settings = false;
  ProgramReport report;  ///< of what takes long
  /// Called when the wait begins: from now on a person may switch the supply off and on.
  std::function<void()> on_wait;
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

  [[nodiscard]] bool is_well() const { return is_present && faults.empty(); }
};

class Recovery {
 public:
  /// Keeps other hosts away while it exists.
  Recovery(BusAccess& bus, const RecoverySettings& settings)
      : bus_(bus), settings_(settings), presence_(bus.connection()) {}

  /// Waits, and finds out who is there and what is wrong. Changes nothing. Throws std::runtime_error if there is no
  /// module, or one of them has power or is Operational.
  void examine();
  /// Applies the remedies until none is left. Throws std::runtime_error if the connection is lost, or the user
  /// interrupts.
  void recover();

  [[nodiscard]] const std::vector<RecoveredModule>& modules() const { return modules_; }
  /// Serial numbers of the settings that no module has.
  [[nodiscard]] const std::vector<std::uint32_t>& missing() const { return missing_; }
  /// Nodes that send, answer nothing, and are no modules.
  [[nodiscard]] const std::vector<std::uint8_t>& silent() const { return silent_; }
  [[nodiscard]] bool are_all_well() const;

 private:
  void wait();
  void add(const host::FlashCandidate& found);
  /// Asks these modules for their programs. Whether all have answered.
  bool ask(const std::vector<std::uint32_t>& serials);
  /// Asks all modules that run no program: their bootloaders stay on the bus for ten seconds then.
  void hold();
  void look();
  void ask_all();
  void await_absent();
  /// The module with this serial number; null: none has it.
  [[nodiscard]] RecoveredModule* find(std::uint32_t serial);
  void diagnose(RecoveredModule& module);
  void require_no_power() const;

  /// Modules with a remedy that has tries left; this is one.
  [[nodiscard]] std::vector<RecoveredModule*> take(host::Remedy remedy);
  /// The first remedies that are due. False: there are none.
  bool apply();
  void start(const std::vector<RecoveredModule*>& modules);
  void flash(const std::vector<RecoveredModule*>& modules);
  void flash_at_once(const std::vector<RecoveredModule*>& modules, bool through_its_line);
  [[nodiscard]] std::vector<std::uint8_t> taken_nodes() const;
  void number(const std::vector<RecoveredModule*>& modules);
  void renumber(const std::vector<RecoveredModule*>& modules);
  void renumber_duplicates(std::uint8_t node);
  void restart(const std::vector<RecoveredModule*>& modules);
  void reset_settings(const std::vector<RecoveredModule*>& modules);

  BusAccess& bus_;
  const RecoverySettings& settings_;
  HostPresence presence_;
  std::vector<RecoveredModule> modules_;
  std::vector<std::uint32_t> missing_;
  bool has_looked_ = false;
  bool has_seen_any_ = false;  ///< at the first look
  std::vector<std::uint8_t> silent_;
  std::vector<std::uint8_t> others_;  ///< node ids of nodes that are no modules
};

}  // namespace proleg::tools
