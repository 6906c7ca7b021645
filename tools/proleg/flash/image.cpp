// proleg image: files with images of modules.

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/flash/image_file.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/little_endian.hpp"
#include "shared/image/board_names.hpp"
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

using image::header_size;

constexpr const char* a_binary = "the raw binary of a program";

struct MakeOptions {
  std::string body;
  std::string output;
  std::string board;
  std::string address;
  std::string version;
  std::string protocol;
  std::string fingerprint;
  std::string schema;
  std::string revisions = "0:255";
  std::optional<std::string> commit;
  bool changed_sources = false;
};

/// Decimal, or hexadecimal after 0x.
template <std::unsigned_integral Number>
std::optional<Number> parse_number_word(std::string_view word) {
  return word.starts_with("0x") ? parse_whole<Number>(word.substr(2), 16) : parse_whole<Number>(word);
}

template <std::unsigned_integral Number>
Number parse_option(const std::string& option, const std::string& word, Number lowest = 0) {
  const auto number = parse_number_word<Number>(word);
  if (!number || *number < lowest) {
    throw InputError(option, 0, in_quotes(word),
                     "a whole number from " + std::to_string(lowest) + " to " +
                         std::to_string(std::numeric_limits<Number>::max()) + ", also as 0x and hexadecimal digits");
  }
  return *number;
}

image::Version parse_version(const std::string& word) {
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
  throw InputError("--version", 0, in_quotes(word), "MAJOR.MINOR.PATCH, three whole numbers from 0 to 65535");
}

std::uint32_t parse_fingerprint(const std::string& word) {
  constexpr std::size_t digits = 8;
  const std::string_view hexadecimal_part = std::string_view(word).substr(word.starts_with("0x") ? 2 : 0);
  const auto number = parse_whole<std::uint32_t>(hexadecimal_part, 16);
  if (!number || hexadecimal_part.size() != digits) {
    throw InputError("--fingerprint", 0, in_quotes(word), "eight hexadecimal digits");
  }
  return *number;
}

void parse_revisions(const std::string& word, Header& header) {
  const std::size_t colon = word.find(':');
  const auto lowest = parse_whole<std::uint8_t>(std::string_view(word).substr(0, colon));
  const auto highest = colon == std::string::npos ? std::optional<std::uint8_t>()
                                                  : parse_whole<std::uint8_t>(std::string_view(word).substr(colon + 1));
  if (!lowest || !highest || *lowest > *highest) {
    throw InputError("--revisions", 0, in_quotes(word), "LOWEST:HIGHEST, two whole numbers from 0 to 255");
  }
  header.lowest_revision = *lowest;
  header.highest_revision = *highest;
}

void parse_commit(const MakeOptions& options, Header& header) {
  if (!options.commit) {
    if (options.changed_sources) {
      throw InputError("--changed-sources", 0, "it without --commit", "the commit that the sources differ from");
    }
    return;
  }
  const std::string& word = *options.commit;
  bool is_good = word.size() == 2 * header.commit.size();
  for (std::size_t i = 0; is_good && i < header.commit.size(); ++i) {
    const auto byte = parse_whole<std::uint8_t>(std::string_view(word).substr(2 * i, 2), 16);
    header.commit.at(i) = byte.value_or(0);
    is_good = byte.has_value();
  }
  // All digits 0 mean in a header that the commit is not known.
  if (!is_good || word.find_first_not_of('0') == std::string::npos) {
    throw InputError("--commit", 0, in_quotes(word),
                     "40 hexadecimal digits, not all 0, as 'git rev-parse HEAD' prints them");
  }
  header.has_changed_sources = options.changed_sources;
}

Header parse_header(const MakeOptions& options) {
  Header header;
  header.board_id = parse_option<std::uint16_t>("--board", options.board, 1);
  parse_revisions(options.revisions, header);
  header.version = parse_version(options.version);
  header.protocol = parse_option<std::uint16_t>("--protocol", options.protocol);
  header.core_fingerprint = parse_fingerprint(options.fingerprint);
  header.settings_schema = parse_option<std::uint8_t>("--schema", options.schema);
  parse_commit(options, header);
  const auto address = parse_number_word<std::uint32_t>(options.address);
  if (!address || *address < header_size || *address % header_size != 0) {
    throw InputError("--address", 0, in_quotes(options.address),
                     "the address of the body: a multiple of 0x200, at least 0x200, because the header is in front");
  }
  header.address = *address;
  return header;
}

/// The program, with 0xFF up to the next multiple of 4.
std::vector<std::uint8_t> read_body(const std::string& file) {
  std::vector<std::uint8_t> body = host::read_bytes(file, a_binary);
  using Format = host::ProgramFormat;
  const Format format = host::find_format(body);
  if (format == Format::image) {
    throw InputError(file, 0, "an image", std::string(a_binary) + ", without a header");
  }
  if (format == Format::elf || format == Format::intel_hex || format == Format::s_records) {
    throw InputError(file, 0, std::string(name_of(format)),
                     std::string(a_binary) + ", which 'objcopy -O binary' makes of it");
  }
  if (body.size() > host::max_image_size - header_size) {
    throw InputError(file, 0, "more than " + std::to_string(host::max_image_size - header_size) + " bytes",
                     std::string(a_binary) + " of at most as many");
  }
  body.resize((body.size() + 3) / 4 * 4, 0xFF);
  return body;
}

/// A program that is linked for another slot does not start.
void check_reset_vector(const std::string& file, const Header& header, const std::vector<std::uint8_t>& body) {
  constexpr std::size_t reset_at = 4;
  if (body.size() < reset_at + 4) {
    throw InputError(file, 0, std::to_string(body.size()) + " bytes",
                     std::string(a_binary) + ", which begins with a vector table");
  }
  const std::uint64_t end = std::uint64_t{header.address} + body.size();
  if (end > std::uint64_t{std::numeric_limits<std::uint32_t>::max()} + 1) {
    throw InputError("--address", 0, hexadecimal(header.address, 8),
                     "an address behind which there is room for " + std::to_string(body.size()) + " bytes");
  }
  const std::uint32_t reset = read_little_endian(body, reset_at, 4);
  if (reset % 2 == 0 || reset < header.address || reset >= end) {
    throw InputError(file, 0, "the reset vector " + hexadecimal(reset, 8) + " in the second word",
                     "an odd address from " + hexadecimal(header.address, 8) + " to " +
                         hexadecimal(static_cast<std::uint32_t>(end - 1), 8) +
                         ": --address is the one for which the program is linked");
  }
}

int make(const MakeOptions& options) {
  Header header = parse_header(options);
  const std::vector<std::uint8_t> body = read_body(options.body);
  check_reset_vector(options.body, header, body);
  const std::array outputs{PlannedOutput{"--output", options.output, "image", starts_with("PIMG")}};
  check_outputs(outputs);

  image::describe_body(header, body);
  const image::HeaderBytes header_bytes = encode(header);
  std::string bytes(header_bytes.begin(), header_bytes.end());
  bytes.append(body.begin(), body.end());
  write_file(options.output, bytes);
  std::cout << "written  " << options.output << ", " << bytes.size() << " bytes\n";
  return exit_success;
}

/// proleg image info: what the headers of images say. Returns the exit status.
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

/// proleg image make: puts a header in front of a program. Returns the exit status.
int run_image_make(int argc, char** argv) {
  CommandLine command_line(
      "proleg image make",
      "Puts a header in front of a program, which makes an image. The program is a raw binary that "
      "begins with its vector table; it gets bytes 0xFF up to a multiple of 4.\nNumbers are decimal, "
      "or hexadecimal after 0x. FILE is replaced if it is an image.");
  MakeOptions options;
  const auto add = [&](const char* name, std::string& variable, const char* value, const char* help) {
    command_line.add_option(name, variable, help).required().value_name(value);
  };
  add("BODY", options.body, "", "the program, for example of 'objcopy -O binary'");
  add("--output", options.output, "FILE", "the image, *.pimg");
  add("--board", options.board, "ID", "board id, as object 0x2000:4: 1 is the reference board");
  add("--address", options.address, "ADDRESS", "where the program is linked: the slot's address + 0x200");
  add("--version", options.version, "MAJOR.MINOR.PATCH", "of the program");
  add("--protocol", options.protocol, "N", "protocol version, as object 0x2000:1: 0x0100 is version 1.0");
  add("--fingerprint", options.fingerprint, "HEX8", "core fingerprint, as object 0x2000:3: eight hexadecimal digits");
  add("--schema", options.schema, "N", "schema version of the settings that the program writes, 0 to 255");
  command_line.add_option("--revisions", options.revisions, "hardware revisions of the board; 0:255 means all")
      .value_name("LOWEST:HIGHEST")
      .shows_default();
  command_line.add_option("--commit", options.commit, "git commit of the sources").value_name("HEX40");
  command_line.add_flag("--changed-sources", options.changed_sources, "the sources were not those of the commit");
  return command_line.run(argc, argv, [&] { return make(options); });
}

}  // namespace
}  // namespace proleg::tools

int main(int argc, char** argv) {
  using namespace proleg;
  const std::string_view word = argc > 1 ? argv[1] : "";
  if (word == "info") {
    return tools::run_image_info(argc - 1, argv + 1);
  }
  if (word == "make") {
    return tools::run_image_make(argc - 1, argv + 1);
  }
  tools::CommandLine command_line(
      "proleg image",
      "Shows and makes images: the files that are flashed into modules (docs/flashing.md).\n"
      "'proleg image info --help' and 'proleg image make --help' explain the two actions.");
  std::string action;
  command_line
      .add_option(
          "ACTION", action,
          "info FILE...: show what images contain and whether they are intact; make BODY --output FILE ...: put "
          "a header in front of a program")
      .required()
      .value_name("");
  // What follows belongs to an action that does not exist.
  return command_line.run(std::min(argc, 2), argv,
                          [&]() -> int { throw InputError("ACTION", 0, in_quotes(action), "info or make"); });
}
