// proleg image: files with images of modules.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/flash/image_file.hpp"
#include "host/flash/key_file.hpp"
#include "host/flash/module_program.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/image/board_names.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/flash/image_actions.hpp"

namespace proleg::tools {
namespace {

using image::Header;

struct ImageInfoOptions {
  std::vector<std::string> files;
  bool json = false;
};

/// What is known of a file.
struct Examined {
  std::optional<Header> header;  ///< nothing if it is no image, or its header is damaged
  std::string error;             ///< one line; empty for an intact image
};

Examined examine(const std::string& file) {
  Examined examined;
  try {
    const std::vector<std::uint8_t> bytes = host::read_bytes(file, "an image (.pimg)");
    examined.header = host::read_image_header(file, bytes);
    host::check_image_body(file, *examined.header, bytes);
  } catch (const InputError& error) {
    examined.error = error.what();
  }
  return examined;
}

/// The digits of the commit; empty if it is not known.
std::string commit_digits(const Header& header) {
  const bool is_known = std::ranges::any_of(header.commit, [](std::uint8_t byte) { return byte != 0; });
  return is_known ? hexadecimal_digits(header.commit) : "";
}

std::string revisions_text(const Header& header) {
  if (header.lowest_revision == 0 && header.highest_revision == 255) {
    return "all hardware revisions";
  }
  const std::string lowest = std::to_string(header.lowest_revision);
  return header.lowest_revision == header.highest_revision
             ? "hardware revision " + lowest
             : "hardware revisions " + lowest + " to " + std::to_string(header.highest_revision);
}

/// The share of a slot that the image takes, in percent.
std::string slot_share_text(const Header& header) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", 100.0 * header.length / host::slot_room);
  return text.data();
}

void print_text(const std::string& file, const Examined& examined) {
  const Header& header = *examined.header;
  const auto print = [](std::string name, const std::string& value) {
    name.resize(18, ' ');
    std::cout << "  " << name << value << '\n';
  };
  const std::string commit = commit_digits(header);
  std::cout << one_line(file) << '\n';
  const std::string_view board = image::board_name(header.board_id);
  print("board", std::to_string(header.board_id) + (board.empty() ? "" : " (" + std::string(board) + ")") + ", " +
                     revisions_text(header));
  print("version", host::version_number_text(header.version));
  print("commit", (commit.empty() ? "not known" : commit) + (header.has_changed_sources ? " + changes" : ""));
  print("protocol version", std::to_string(header.protocol >> 8U) + '.' + std::to_string(header.protocol & 0xFFU));
  print("core fingerprint", hexadecimal(header.core_fingerprint, 8));
  print("settings schema", std::to_string(header.settings_schema));
  print("address", hexadecimal(header.address, 8));
  print("length", std::to_string(header.length) + " bytes, " + slot_share_text(header) + " % of the " +
                      std::to_string(host::slot_room) + " of a slot");
  print("CRC-32", hexadecimal(header.crc, 8));
  print("SHA-256", hexadecimal_digits(header.hash));
  print("signature", header.key_id == 0 ? "none"
                                        : "with key " + host::key_id_text(header.key_id) +
                                              ", not checked: 'proleg image verify' does that");
  if (header.minimum_version != image::Version{}) {
    print("minimum version", host::version_number_text(header.minimum_version) + ", for images after this one");
  }
  if (header.next_key != image::PublicKey{}) {
    print("next key", host::key_id_text(image::key_id(header.next_key)) + ", for images after this one");
  }
  print("body", examined.error.empty() ? "intact" : "not intact");
}

Json json_of(const std::string& file, const Examined& examined) {
  Json object{{"file", file},
              {"intact", examined.error.empty()},
              {"error", examined.error.empty() ? Json() : Json(examined.error)}};
  if (!examined.header) {
    return object;
  }
  const Header& header = *examined.header;
  const std::string commit = commit_digits(header);
  object.add("board", header.board_id);
  object.add("lowest_revision", unsigned{header.lowest_revision});
  object.add("highest_revision", unsigned{header.highest_revision});
  object.add("version", host::version_number_text(header.version));
  object.add("commit", commit.empty() ? Json() : Json(commit));
  object.add("changed_sources", header.has_changed_sources);
  object.add("protocol", header.protocol);
  object.add("core_fingerprint", header.core_fingerprint);
  object.add("settings_schema", unsigned{header.settings_schema});
  object.add("address", header.address);
  object.add("length", header.length);
  object.add("slot_percent", 100.0 * header.length / host::slot_room);
  object.add("crc32", header.crc);
  object.add("sha256", hexadecimal_digits(header.hash));
  object.add("key_id", header.key_id == 0 ? Json() : Json(host::key_id_text(header.key_id)));
  object.add("minimum_version", header.minimum_version == image::Version{}
                                    ? Json()
                                    : Json(host::version_number_text(header.minimum_version)));
  object.add("next_key_id",
             header.next_key == image::PublicKey{} ? Json() : Json(host::key_id_text(image::key_id(header.next_key))));
  return object;
}

int info(const ImageInfoOptions& options, const std::string& program) {
  int status = exit_success;
  bool is_first = true;
  Json list = Json::empty_array();
  for (const std::string& file : options.files) {
    const Examined examined = examine(file);
    if (options.json) {
      list.append(json_of(file, examined));
    } else if (examined.header) {
      std::cout << (is_first ? "" : "\n");
      is_first = false;
      print_text(file, examined);
    }
    if (!examined.error.empty()) {
      std::cout.flush();  // the line comes behind the table that it explains
      std::cerr << program << ": " << examined.error << '\n';
      status = exit_bad_input;
    }
  }
  if (options.json) {
    std::cout << Json{{"images", list}}.text() << '\n';
  }
  return status;
}

}  // namespace

int run_image_info(int argc, char** argv) {
  CommandLine command_line("proleg image info",
                           "Shows what the headers of images say, and whether the images are intact: header and body "
                           "have the checksums and the length that the header gives.\nExit status 2 if a file is no "
                           "intact image.");
  ImageInfoOptions options;
  command_line.add_option("FILE", options.files, "images, *.pimg").takes_several().required().value_name("");
  command_line.add_flag("--json", options.json, "print one JSON object, with an element of \"images\" for each file");
  return command_line.run(argc, argv, [&] { return info(options, command_line.name()); });
}

}  // namespace proleg::tools

int main(int argc, char** argv) {
  using namespace proleg;
  struct Action {
    std::string_view name;
    int (*run)(int argc, char** argv);
    const char* help;
  };
  constexpr std::array actions{
      Action{"info", tools::run_image_info, "info FILE...: show what images contain and whether they are intact"},
      Action{"make", tools::run_image_make, "make BODY --output FILE ...: put a header in front of a program"},
      Action{"key", tools::run_image_key, "key FILE: make a key that signs images"},
      Action{"sign", tools::run_image_sign, "sign IMAGE --key FILE --output FILE: sign an image"},
      Action{"verify", tools::run_image_verify, "verify IMAGE --key FILE: check the signature of an image"}};
  const std::string_view word = argc > 1 ? argv[1] : "";
  std::string names;
  std::string help;
  for (const Action& action : actions) {
    if (word == action.name) {
      return action.run(argc - 1, argv + 1);
    }
    names += std::string(names.empty() ? "" : &action == &actions.back() ? " or " : ", ") + std::string(action.name);
    help += std::string(help.empty() ? "" : "; ") + action.help;
  }
  tools::CommandLine command_line(
      "proleg image",
      "Shows, makes and signs images: the files that are flashed into modules (docs/flashing.md).\n"
      "'proleg image info --help' explains the action info; the others in the same way.");
  std::string action;
  command_line.add_option("ACTION", action, help).required().value_name("");
  // What follows belongs to an action that does not exist.
  return command_line.run(std::min(argc, 2), argv,
                          [&]() -> int { throw InputError("ACTION", 0, in_quotes(action), names); });
}
