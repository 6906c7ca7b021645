#pragma once

// The faults of a module that keep it from being used, and their remedies.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/flash/module_program.hpp"

namespace proleg::host {

enum class ModuleFaultKind : std::uint8_t {
  no_update_protocol,  ///< the module answers no broadcast
  no_bootloader,
  no_program,
  starts_badly,     ///< the bootloader does not start the program any more
  silent_program,   ///< the program answers nothing, though it runs
  never_confirmed,  ///< the program has not started successfully yet
  in_bootloader,    ///< the bootloader runs, though the program has started successfully once
  no_node_id,
  duplicate_node_id,
  stopped,  ///< the module serves LSS and broadcasts only, as after a collision of node ids
  newer_settings,
};

enum class Remedy : std::uint8_t {
  by_hand,
  start,           ///< start the program
  flash,           ///< flash the image
  number,          ///< give the module a free node id
  renumber,        ///< give the module a free node id instead of the one that it shares
  keep_number,     ///< keep the shared node id, and restart with the modules that share it
  restart,         ///< restart the module by NMT
  reset_settings,  ///< save the settings in the program's own schema
};

struct ModuleFault {
  ModuleFaultKind kind{};
  std::string text;  ///< what is wrong; without a full stop
  Remedy remedy = Remedy::by_hand;
  std::string to_do;  ///< the remedy that is applied, or that a person can apply; without a full stop
};

struct RecoveryMeans {
  const image::Header* image = nullptr;  ///< image to flash; null: none was given
  bool resets_settings = false;
  bool has_tried_start = false;  ///< the program was started before, and the present report is the result
  bool was_silent = false;       ///< no answer of the module was received before its supply was switched off and on
};

/// The faults of a module that answers any request, the most important one first; empty if it has none. all: the
/// modules on the bus, including this one.
[[nodiscard]] std::vector<ModuleFault> find_module_faults(const FlashCandidate& module,
                                                          std::span<const FlashCandidate> all,
                                                          const RecoveryMeans& means);

/// The name of a fault for programs, such as "no_program".
[[nodiscard]] std::string_view code_of(ModuleFaultKind kind);

}  // namespace proleg::host
