#include "tools/proleg/flash/flash_bare.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "firmware/bootloader/trust_store.hpp"
#include "firmware/module/board_record.hpp"
#include "firmware/stm32f405/flash_layout.hpp"
#include "host/flash/bare_commands.hpp"
#include "host/flash/image_file.hpp"
#include "host/flash/key_file.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/common/scratch_folder.hpp"

namespace proleg::tools {
namespace {

namespace flash_layout = stm32f405::flash_layout;
using firmware::BoardRecord;
using host::BarePlan;
using host::BareProbe;
using host::BareStep;
using Bytes = std::vector<std::uint8_t>;

constexpr const char* default_bootloader = "proleg_boot_stm32f405.bin";

/// A folder for the files of the commands.
class WorkFolder {
 public:
  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }

  void write(const std::string& name, std::string_view content) const {
    write_file((path() / name).string(), std::string(content));
  }
  void write(const std::string& name, const Bytes& content) const {
    write(name, std::string(content.begin(), content.end()));
  }
  /// The bytes of a file of the folder; empty if the file does not exist.
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ifstream file(path() / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  ScratchFolder folder_;
};

/// What goes onto the chip, and how.
struct Work {
  BarePlan plan;
  std::string bootloader_name;
  std::uint16_t board_id = 0;
  Bytes bootloader;
  Bytes image;
  Bytes settings;  ///< with the board record; empty: none is written
  Bytes trust;     ///< the record of the key; empty: none is written
};

BareProbe parse_probe(const std::optional<std::string>& word) {
  constexpr const char* expected = "stlink, jlink, cmsis-dap, dfu or uart";
  if (!word) {
    throw InputError("--bare", 0, "no --probe", std::string("--probe ") + expected);
  }
  constexpr std::pair<std::string_view, BareProbe> probes[] = {{"stlink", BareProbe::stlink},
                                                               {"jlink", BareProbe::jlink},
                                                               {"cmsis-dap", BareProbe::cmsis_dap},
                                                               {"dfu", BareProbe::dfu},
                                                               {"uart", BareProbe::uart}};
  for (const auto& [name, probe] : probes) {
    if (*word == name) {
      return probe;
    }
  }
  throw InputError("--probe", 0, in_quotes(*word), expected);
}

/// The port as an absolute path, because the commands run in another folder.
std::string parse_port(const BareOptions& options, BareProbe probe) {
  if (probe != BareProbe::uart) {
    if (options.port) {
      throw InputError("--port", 0, "it without --probe uart", "the serial line of the chip's UART");
    }
    return "";
  }
  if (!options.port || options.port->empty()) {
    throw InputError("--probe", 0, "uart without --port",
                     "the serial line of the chip's UART, for example /dev/ttyUSB0");
  }
  return std::filesystem::absolute(*options.port).string();
}

void check_rights(const std::string& port) {
  if (access(port.c_str(), F_OK) != 0) {
    throw InputError("--port", 0, "no file " + port, "the serial line of the chip's UART: plug the converter in");
  }
  if (access(port.c_str(), R_OK | W_OK) != 0) {
    throw InputError("--port", 0, "no rights to use " + port,
                     "rights: the udev rules 70-proleg.rules (docs/installing.md) give them to you");
  }
}

Bytes read_settings(const std::string& word, const BarePlan& plan) {
  const auto node = parse_whole<std::uint8_t>(word);
  if (!node || *node < 1 || *node > BoardRecord::max_node) {
    throw InputError("--node", 0, in_quotes(word), "a node id from 1 to " + std::to_string(BoardRecord::max_node));
  }
  BoardRecord record;
  record.node = *node;
  const auto bytes = encode(record, 1);
  Bytes settings(settings_file_size(plan, BoardRecord::size), 0xFF);
  std::ranges::copy(bytes, settings.begin());
  return settings;
}

host::ImageFile read_checked_image(const std::string& file) {
  host::ImageFile image = host::read_image(file);
  image::Place place;
  place.board_id = image.header.board_id;
  place.revision = image.header.lowest_revision;  // nothing but the board knows its own
  place.address = flash_layout::image_body;
  place.room = flash_layout::max_image_size - image::header_size;
  if (const image::Error error = check_place(image.header, place); error != image::Error::none) {
    throw InputError(file, 0, std::string(describe(error)),
                     "an image for the address " + hexadecimal(place.address, 8) + ", as 'proleg image info' shows");
  }
  return image;
}

/// Nothing but these two files knows which board it is: a bootloader starts only images for its own.
void require_same_board(const BareOptions& options, const Work& work) {
  const std::uint16_t board = host::board_of_bootloader(work.bootloader);
  if (work.board_id != board) {
    throw InputError(options.image, 0, "an image for " + host::board_text(work.board_id),
                     "one for " + host::board_text(board) + ", as the bootloader " + work.bootloader_name);
  }
}

/// The record of a key. The image starts on trial, so it must be signed with the key.
Bytes read_trust(const std::string& file, const std::string& image_file, const Bytes& image) {
  const image::Trust trust{host::read_public_key(file), {}};
  if (const image::Error error = image::check_trust(trust, image); error != image::Error::none) {
    throw InputError(image_file, 0, "an image that the module would not start (" + std::string(describe(error)) + ")",
                     "one that 'proleg image sign' has signed with key " +
                         host::key_id_text(image::key_id(*trust.key)) + ", because of --public-key");
  }
  const auto record = bootloader::TrustStore::encode(trust);
  return {record.begin(), record.end()};
}

Work read_work(const BareOptions& options) {
  Work work;
  BarePlan& plan = work.plan;
  plan.probe = parse_probe(options.probe);
  plan.port = parse_port(options, plan.probe);
  plan.bootloader = {flash_layout::bootloader, flash_layout::bootloader_size};
  plan.settings = {flash_layout::board_records, flash_layout::board_records_size};
  plan.image = {flash_layout::image_sector_a.address, flash_layout::image_sector_a.size};
  plan.trust = {flash_layout::trust_sector.address, flash_layout::trust_sector.size};
  if (options.node) {
    work.settings = read_settings(*options.node, plan);
    plan.settings_size = static_cast<std::uint32_t>(work.settings.size());
  }
  host::ImageFile image = read_checked_image(options.image);
  work.board_id = image.header.board_id;
  work.image = std::move(image.bytes);
  if (options.public_key) {
    work.trust = read_trust(*options.public_key, options.image, work.image);
    plan.trust_size = static_cast<std::uint32_t>(work.trust.size());
  }
  work.bootloader_name =
      options.bootloader.value_or((std::filesystem::path(options.image).parent_path() / default_bootloader).string());
  work.bootloader = host::read_bootloader(work.bootloader_name, plan.bootloader);
  require_same_board(options, work);
  plan.image_size = static_cast<std::uint32_t>(work.image.size());
  plan.bootloader_size = static_cast<std::uint32_t>(work.bootloader.size());
  return work;
}

void print_files(const BareOptions& options, const Work& work) {
  const auto print = [](std::string name, const Bytes& bytes, const std::string& what, const host::FlashPart& part) {
    name.resize(16, ' ');
    std::cout << name << bytes.size() << " bytes, " << what << ", for " << hexadecimal(part.address, 8) << '\n';
  };
  print(host::bare_file::bootloader, work.bootloader, one_line(work.bootloader_name), work.plan.bootloader);
  print(host::bare_file::image, work.image, one_line(options.image) + ", " + host::board_text(work.board_id),
        work.plan.image);
  if (work.plan.settings_size > 0) {
    print(host::bare_file::settings, work.settings, "the board record of node " + *options.node, work.plan.settings);
  }
  if (work.plan.trust_size > 0) {
    print(host::bare_file::trust, work.trust, "the public key " + one_line(*options.public_key), work.plan.trust);
  }
  if (uses_swd(work.plan.probe)) {
    std::cout << host::bare_file::script << ":\n";
    const std::string script = host::bare_script(work.plan);
    for (std::size_t at = 0; at < script.size();) {
      const std::size_t end = script.find('\n', at);
      std::cout << (end == at ? "" : "    ") << script.substr(at, end - at) << '\n';
      at = end + 1;
    }
  }
}

void print_step(const BareStep& step, std::string_view remark) {
  std::cout << step.what << remark << ":\n    " << one_line(host::shell_text(step.command)) << std::endl;
}

void run_step(const BarePlan& plan, const BareStep& step, const WorkFolder& folder) {
  print_step(step, "");
  const ProgramResult result = run_program(step.command, folder.path().string());
  if (!result.was_found) {
    throw std::runtime_error(host::missing_program(step.command.front()));
  }
  if (interrupted()) {
    throw std::runtime_error("interrupted; the command can be repeated");
  }
  // An exit status of 0 does not prove that there is a result.
  if (result.status != 0 || (!step.result.empty() && folder.content(step.result).empty())) {
    throw std::runtime_error(host::bare_failure(plan, step, result.output));
  }
  if (!step.expected.empty() && folder.content(step.result) != folder.content(step.expected)) {
    throw std::runtime_error(host::bare_difference(step));
  }
}

void run_all(const Work& work) {
  const WorkFolder folder;
  folder.write(host::bare_file::bootloader, work.bootloader);
  folder.write(host::bare_file::image, work.image);
  folder.write(host::bare_file::script, host::bare_script(work.plan));
  if (work.plan.settings_size > 0) {
    folder.write(host::bare_file::settings, work.settings);
  }
  if (work.plan.trust_size > 0) {
    folder.write(host::bare_file::trust, work.trust);
  }
  std::cout << "in " << folder.path().string() << ":\n";
  for (const BareStep& step : bare_steps(work.plan)) {
    if (step.is_for_other_bootloader &&
        folder.content(host::bare_file::present) == folder.content(host::bare_file::bootloader)) {
      std::cout << step.what << ": not needed, the chip has this bootloader\n";
      continue;
    }
    run_step(work.plan, step, folder);
  }
}

void print_end(const BarePlan& plan) {
  std::cout << "flashed  the bootloader and the image, which starts on trial\n";
  if (sets_option_bytes(plan.probe)) {
    std::cout << "options  brown-out level 3, sectors 0 and 1 write-protected\n";
    return;
  }
  std::cout
      << "options  not set: brown-out level and write protection of sectors 0 and 1 are as they were. The same command "
         "with a probe at SWD (--probe stlink, jlink or cmsis-dap) sets them, once for each board\n"
         "to do    set BOOT0 to low and reset the board\n";
}

}  // namespace

void add_bare_options(CommandLine& command_line, BareOptions& options) {
  command_line
      .add_option(
          "--probe", options.probe,
          "how the chip is reached, with --bare: stlink, jlink or cmsis-dap (such a probe at the connector SWD, by "
          "openocd), dfu (its USB, by dfu-util) or uart (a serial line, by stm32flash); for dfu and uart BOOT0 is high")
      .value_name("PROBE");
  command_line.add_option("--port", options.port, "the serial line, with --probe uart: /dev/ttyUSB0")
      .value_name("DEVICE");
  command_line
      .add_option("--bootloader", options.bootloader,
                  std::string("the bootloader, an ELF file or a raw binary, with --bare; without it: ") +
                      default_bootloader + " in the folder of IMAGE")
      .value_name("FILE");
}

int run_flash_bare(const BareOptions& options) {
  const Work work = read_work(options);
  print_files(options, work);
  if (options.dry_run) {
    for (const BareStep& step : bare_steps(work.plan)) {
      print_step(step, step.is_for_other_bootloader ? ", if the chip has another one" : "");
    }
    return exit_success;
  }
  if (work.plan.probe == BareProbe::uart) {
    check_rights(work.plan.port);
  }
  catch_interrupts();
  run_all(work);
  print_end(work.plan);
  return exit_success;
}

}  // namespace proleg::tools
