#pragma once

// The actions of `proleg image`, and what the actions that write images share.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "host/flash/key_file.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

// Each runs an action and returns the exit status.
int run_image_info(int argc, char** argv);
int run_image_make(int argc, char** argv);
int run_image_key(int argc, char** argv);
int run_image_sign(int argc, char** argv);
int run_image_verify(int argc, char** argv);

/// A version of three numbers. Throws InputError that names the option.
[[nodiscard]] image::Version parse_version(const std::string& option, const std::string& word);

struct SigningOptions {
  std::optional<std::string> key;              ///< file with the private key; nothing: not signed
  std::optional<std::string> minimum_version;  ///< Header::minimum_version
  std::optional<std::string> next_key;         ///< file with a public key, Header::next_key
};

void add_signing_options(CommandLine& command_line, SigningOptions& options);

/// What the options say.
struct Signing {
  std::optional<host::SigningKey> key;
  image::Version minimum_version;
  image::PublicKey next_key{};
};

/// Reads the files of the options. Throws InputError, also for options that need --key without it.
[[nodiscard]] Signing read_signing(const SigningOptions& options);

/// Writes an image, signed if there is a key, and says so. Throws InputError if the file exists and is no image.
void write_image(const std::string& file, image::Header header, const Signing& signing,
                 std::span<const std::uint8_t> body);

}  // namespace proleg::tools
