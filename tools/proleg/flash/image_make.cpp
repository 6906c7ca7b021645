// proleg image make: puts a header in front of a program.

#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/flash/image_file.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/little_endian.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/flash/image_actions.hpp"

namespace proleg::tools {
namespace {

using image::Header;
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
  SigningOptions signing;
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
  // Without a colon it is empty, which is no number.
  const auto highest =
      parse_whole<std::uint8_t>(std::string_view(word).substr(colon == std::string::npos ? word.size() : colon + 1));
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
  header.version = parse_version("--version", options.version);
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
  const Signing signing = read_signing(options.signing);
  const std::vector<std::uint8_t> body = read_body(options.body);
  check_reset_vector(options.body, header, body);
  image::describe_body(header, body);
  write_image(options.output, header, signing, body);
  return exit_success;
}

}  // namespace

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
  add_signing_options(command_line, options.signing);
  return command_line.run(argc, argv, [&] { return make(options); });
}

}  // namespace proleg::tools
