#pragma once

// Decides what flashing an image would do to a module, before anything is sent.

#include <cstdint>
#include <string>

#include "host/flash/module_query.hpp"

namespace proleg::host {

/// A module that may be flashed.
struct FlashCandidate {
  ModuleProgram program;
  std::uint8_t node = 0;       ///< node id; 0: the module has none
  std::uint16_t board_id = 0;  ///< object 0x1018:2
  bool serves_objects = true;  ///< the module answers SDO; otherwise only LSS has found it
};

struct FlashPermissions {
  bool other_board = false;
  bool older_version = false;
};

enum class FlashAction : std::uint8_t {
  install,
  nothing,  ///< the module runs this image, confirmed
  refuse,
};

struct FlashVerdict {
  FlashAction action = FlashAction::refuse;
  std::string text;  ///< what changes, or why nothing changes; without a full stop
};

[[nodiscard]] FlashVerdict judge(const image::Header& image, const FlashCandidate& module,
                                 const FlashPermissions& permissions);

/// The number of a version, such as "0.1.0".
[[nodiscard]] std::string version_number_text(const image::Version& version);
/// The version of an image, such as "0.1.0 (5267b59d)", with a "+" behind the commit of changed sources.
[[nodiscard]] std::string version_text(const image::Header& image);
/// The commit of an image, such as "5267b59d", or "unknown".
[[nodiscard]] std::string commit_text(const image::Header& image);

/// Whether two headers belong to the same image.
[[nodiscard]] bool is_same_image(const image::Header& one, const image::Header& other);

}  // namespace proleg::host
