#pragma once

// Finds modules that are of no use as they are, and brings them back (host/flash/module_fault.hpp).

#include <cstdint>
#include <vector>

#include "host/flash/module_fault.hpp"
#include "tools/proleg/flash/module_search.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

class Recovery {
 public:
  /// Keeps other hosts away while it exists.
  Recovery(BusAccess& bus, const RecoverySettings& settings)
      : bus_(bus), settings_(settings), presence_(bus.connection()), search_(bus, settings) {}

  /// Waits, and finds out who is there and what is wrong. Changes nothing. Throws std::runtime_error if there is no
  /// module, or one of them has power or is Operational.
  void examine();
  /// Applies the remedies until none is left. Throws std::runtime_error if the connection is lost, or the user
  /// interrupts.
  void recover();

  [[nodiscard]] const std::vector<RecoveredModule>& modules() const { return search_.modules(); }
  /// Serial numbers of the settings that no module has.
  [[nodiscard]] const std::vector<std::uint32_t>& missing() const { return search_.missing(); }
  /// Nodes that send, answer nothing, and are no modules.
  [[nodiscard]] const std::vector<std::uint8_t>& silent() const { return search_.silent(); }
  [[nodiscard]] bool are_all_well() const;

 private:
  void require_no_power() const;

  /// Modules with a remedy that has tries left; this is one.
  [[nodiscard]] std::vector<RecoveredModule*> take(host::Remedy remedy);
  /// The first remedies that are due. False: there are none.
  bool apply();
  void start(const std::vector<RecoveredModule*>& modules);
  void flash(const std::vector<RecoveredModule*>& modules);
  void flash_at_once(const std::vector<RecoveredModule*>& modules, bool through_its_line);
  void number(const std::vector<RecoveredModule*>& modules);
  void renumber(const std::vector<RecoveredModule*>& modules);
  void renumber_duplicates(std::uint8_t node);
  void restart(const std::vector<RecoveredModule*>& modules);
  void reset_settings(const std::vector<RecoveredModule*>& modules);

  BusAccess& bus_;
  const RecoverySettings& settings_;
  HostPresence presence_;
  ModuleSearch search_;
};

}  // namespace proleg::tools
