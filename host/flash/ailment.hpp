#pragma once

// What keeps a module from being of use, and what brings it back.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/flash/flash_verdict.hpp"

namespace proleg::host {

enum class AilmentKind : std::uint8_t {
  no_update_protocol,  ///< answers no broadcast
  no_bootloader,
  no_program,
  starts_badly,     ///< its bootloader has given the program up
  never_confirmed,  ///< the program has not started well yet
  in_bootloader,    ///< though its program has started well once
  no_node_id,
  duplicate_node_id,
  stopped,  ///< it serves LSS and broadcasts only, as after a collision of node ids
  newer_settings,
};

enum class Remedy : std::uint8_t {
  by_hand,
  start,           ///< the program
  flash,           ///< the image
  number,          ///< gets a free node id
  renumber,        ///< the same instead of the one that it shares
  keep_number,     ///< of those that share it; restarts with them
  restart,         ///< by NMT
  reset_settings,  ///< save them in the program's own schema
};

struct Ailment {
  AilmentKind kind{};
  std::string text;  ///< what is wrong; without a full stop
  Remedy remedy = Remedy::by_hand;
  std::string to_do;  ///< what is done about it, or what a person can do; without a full stop
};

struct RecoveryMeans {
  const image::Header* image = nullptr;  ///< null: none was given
  bool resets_settings = false;
  bool has_tried_start = false;  ///< what it says now is what came of it
};

/// Of a module that answers anything at all, the most important one first; none: it is well. all: the modules on the
/// bus, this one too.
[[nodiscard]] std::vector<Ailment> find_ailments(const FlashCandidate& module, std::span<const FlashCandidate> all,
                                                 const RecoveryMeans& means);

/// "no_program".
[[nodiscard]] std::string_view code_of(AilmentKind kind);

}  // namespace proleg::host
