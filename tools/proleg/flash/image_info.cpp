#include "tools/proleg/flash/image_info.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "host/flash/image_file.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"

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

std::string version_text(const image::Version& version) {
  return std::to_string(version.major) + '.' + std::to_string(version.minor) + '.' + std::to_string(version.patch);
}

/// Empty if it is not known.
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

/// In percent.
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
  print("board", std::to_string(header.board_id) + ", " + revisions_text(header));
  print("version", version_text(header.version));
  print("commit", (commit.empty() ? "not known" : commit) + (header.has_changed_sources ? " + changes" : ""));
  print("protocol version", std::to_string(header.protocol >> 8U) + '.' + std::to_string(header.protocol & 0xFFU));
  print("core fingerprint", hexadecimal(header.core_fingerprint, 8));
  print("settings schema", std::to_string(header.settings_schema));
  print("address", hexadecimal(header.address, 8));
  print("length", std::to_string(header.length) + " bytes, " + slot_share_text(header) + " % of the " +
                      std::to_string(host::slot_room) + " of a slot");
  print("CRC-32", hexadecimal(header.crc, 8));
  print("SHA-256", hexadecimal_digits(header.hash));
  print("signature",
        header.key_id == 0 ? "none" : "with key " + hexadecimal(header.key_id, 8) + ", which was not checked");
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
  object.add("version", version_text(header.version));
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
  object.add("key_id", header.key_id == 0 ? Json() : Json(header.key_id));
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
