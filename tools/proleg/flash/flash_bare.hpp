#pragma once

#include <optional>
#include <string>

namespace proleg::tools {

class CommandLine;

/// Options of `proleg flash --bare`. Flashing over the bus has an image, nodes, a dry run and a key, too: flash.cpp
/// declares the first four.
struct BareOptions {
  std::string image;                ///< a file
  std::optional<std::string> node;  ///< of the board record that is written; without it none is
  bool dry_run = false;             ///< only shows the commands
  /// A file; without it the key that the chip has, or none, stays.
  std::optional<std::string> public_key;
  // The options that add_bare_options() declares:
  std::optional<std::string> probe;
  std::optional<std::string> port;
  std::optional<std::string> bootloader;
};

/// Declares the options that only --bare has.
void add_bare_options(CommandLine& command_line, BareOptions& options);

/// proleg flash --bare: puts the bootloader and the first image on an empty chip, by a probe. Returns the exit
/// status. Throws InputError, and std::runtime_error if the chip is not flashed.
int run_flash_bare(const BareOptions& options);

}  // namespace proleg::tools
