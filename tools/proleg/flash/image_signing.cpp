// proleg image key, sign and verify.

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <string_view>

#include "host/flash/module_program.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/errors/secret_file.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/flash/image_actions.hpp"

namespace proleg::tools {
namespace {

struct KeyOptions {
  std::string file;
  bool force = false;
};

/// The file with the public key: "update.pem" has "update.pub.pem".
std::string public_name(const std::string& file) {
  const std::filesystem::path path(file);
  return path.parent_path() / (path.stem().string() + ".pub" + path.extension().string());
}

int make_key(const KeyOptions& options) {
  const std::string public_file = public_name(options.file);
  const std::array outputs{PlannedOutput{"FILE", public_file, "public key", starts_with("-----BEGIN PUBLIC KEY")}};
  check_outputs(outputs);
  const host::SigningKey key = host::SigningKey::make();
  host::write_private_key(options.file, key, options.force);
  write_file(public_file, key.public_text());
  std::cout << "written  " << one_line(options.file)
            << ", the private key: it signs images; keep it, and keep it secret\n"
            << "written  " << one_line(public_file) << ", the public key: modules and 'proleg image verify' get it\n"
            << "key id   " << host::key_id_text(image::key_id(key.public_key())) << '\n';
  return exit_success;
}

struct SignOptions {
  std::string image;
  std::string output;
  SigningOptions signing;
};

int sign_image(const SignOptions& options) {
  const Signing signing = read_signing(options.signing);
  if (!signing.key) {
    throw InputError("--key", 0, "no --key", "the private key, as 'proleg image key' makes it");
  }
  const host::ImageFile image = host::read_image(options.image);
  write_image(options.output, image.header, signing, image.body());
  return exit_success;
}

struct VerifyOptions {
  std::string image;
  std::string key;
};

int verify(const VerifyOptions& options) {
  const image::PublicKey key = host::read_public_key(options.key);
  const host::ImageFile image = host::read_image(options.image);
  const image::Error error = image::check_trust({key, {}}, image.bytes);
  if (error == image::Error::none) {
    std::cout << one_line(options.image) << ": signed with key " << host::key_id_text(image::key_id(key)) << '\n';
    return exit_success;
  }
  const std::string found = error == image::Error::not_signed     ? "no signature"
                            : error == image::Error::unusable_key ? "a key for later images that is no key of Ed25519"
                            : error == image::Error::other_key
                                ? "a signature with another key (id " + host::key_id_text(image.header.key_id) + ")"
                                : "a signature that is not valid: the image was changed after it was signed, or its "
                                  "maker does not have the key";
  throw InputError(options.image, 0, found, "one with key " + host::key_id_text(image::key_id(key)));
}

}  // namespace

image::Version parse_version(const std::string& option, const std::string& word) {
  const std::size_t first = word.find('.');
  const std::size_t second = first == std::string::npos ? first : word.find('.', first + 1);
  if (second != std::string::npos) {
    const auto major = parse_whole<std::uint16_t>(std::string_view(word).substr(0, first));
    const auto minor = parse_whole<std::uint16_t>(std::string_view(word).substr(first + 1, second - first - 1));
    const auto patch = parse_whole<std::uint16_t>(std::string_view(word).substr(second + 1));
    if (major && minor && patch) {
      return {*major, *minor, *patch};
    }
  }
  throw InputError(option, 0, in_quotes(word), "MAJOR.MINOR.PATCH, three whole numbers from 0 to 65535");
}

void add_signing_options(CommandLine& command_line, SigningOptions& options) {
  command_line.add_option("--key", options.key, "the private key that signs the image").value_name("FILE");
  command_line
      .add_option("--minimum-version", options.minimum_version,
                  "a module that has confirmed this image takes none with a lower version any more; only with --key")
      .value_name("MAJOR.MINOR.PATCH");
  command_line
      .add_option("--next-key", options.next_key,
                  "a module that has confirmed this image takes only images that are signed with the private key of "
                  "this public key; only with --key")
      .value_name("FILE");
}

Signing read_signing(const SigningOptions& options) {
  Signing signing;
  if (!options.key) {
    if (options.minimum_version || options.next_key) {
      throw InputError(options.minimum_version ? "--minimum-version" : "--next-key", 0, "it without --key",
                       "--key: modules follow it only in signed images");
    }
    return signing;
  }
  signing.key = host::SigningKey::read(*options.key);
  if (const std::optional<std::string> warning = warning_on_secret(*options.key)) {
    print_warning("proleg image", *warning);
  }
  if (options.minimum_version) {
    signing.minimum_version = parse_version("--minimum-version", *options.minimum_version);
  }
  if (options.next_key) {
    signing.next_key = host::read_public_key(*options.next_key);
  }
  return signing;
}

void write_image(const std::string& file, image::Header header, const Signing& signing,
                 std::span<const std::uint8_t> body) {
  if (header.version < signing.minimum_version) {
    throw InputError("--minimum-version", 0, host::version_number_text(signing.minimum_version),
                     "at most the version of the image, " + host::version_number_text(header.version));
  }
  const std::array outputs{PlannedOutput{"--output", file, "image", starts_with("PIMG")}};
  check_outputs(outputs);
  if (signing.key) {
    header.minimum_version = signing.minimum_version;
    header.next_key = signing.next_key;
    host::sign(header, *signing.key);
  }
  const image::HeaderBytes header_bytes = encode(header);
  std::string bytes(header_bytes.begin(), header_bytes.end());
  bytes.append(body.begin(), body.end());
  write_file(file, bytes);
  std::cout << "written  " << one_line(file) << ", " << bytes.size() << " bytes"
            << (signing.key ? ", signed with key " + host::key_id_text(header.key_id) : "") << '\n';
}

int run_image_key(int argc, char** argv) {
  CommandLine command_line(
      "proleg image key",
      "Makes a key of Ed25519 that signs images. FILE gets the private key, which only its owner can read; a file "
      "beside it, with .pub in its name, the public key. Both are PEM, which 'openssl pkey' reads.");
  KeyOptions options;
  command_line.add_option("FILE", options.file, "the private key: update.pem").required().value_name("");
  command_line.add_flag("--force", options.force, "replace a private key, which is then lost");
  return command_line.run(argc, argv, [&] { return make_key(options); });
}

int run_image_sign(int argc, char** argv) {
  CommandLine command_line("proleg image sign",
                           "Signs an image, also one that is signed already. Header and program stay but for the "
                           "signature, the lowest version and the next key.");
  SignOptions options;
  command_line.add_option("IMAGE", options.image, "an image, *.pimg").required().value_name("");
  command_line.add_option("--output", options.output, "the signed image, *.pimg; it may be IMAGE")
      .required()
      .value_name("FILE");
  add_signing_options(command_line, options.signing);
  return command_line.run(argc, argv, [&] { return sign_image(options); });
}

int run_image_verify(int argc, char** argv) {
  CommandLine command_line("proleg image verify",
                           "Checks whether an image is intact and signed with a key, as a module does that has this "
                           "key.\nExit status 2 if not.");
  VerifyOptions options;
  command_line.add_option("IMAGE", options.image, "an image, *.pimg").required().value_name("");
  command_line.add_option("--key", options.key, "the public key").required().value_name("FILE");
  return command_line.run(argc, argv, [&] { return verify(options); });
}

}  // namespace proleg::tools
