#include "host/flash/bare_commands.hpp"

#include <algorithm>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

using Words = std::vector<std::string>;

std::string address_word(const FlashPart& part) { return hexadecimal(part.address, 8); }

/// The range ADDRESS:SIZE as an argument of dfu-util and stm32flash.
std::string range_word(std::uint32_t address, std::uint32_t size) {
  return hexadecimal(address, 8) + ':' + std::to_string(size);
}

std::vector<BareStep> openocd_steps(BareProbe probe) {
  Words command{"openocd", "-f"};
  if (probe == BareProbe::stlink) {
    command.emplace_back("interface/stlink.cfg");
  } else {  // both have JTAG, too
    command.insert(command.end(), {probe == BareProbe::jlink ? "interface/jlink.cfg" : "interface/cmsis-dap.cfg", "-c",
                                   "transport select swd"});
  }
  command.insert(command.end(), {"-f", "target/stm32f4x.cfg", "-f", bare_file::script});
  return {{"write all", std::move(command), bare_file::end, "", false}};
}

/// Makes the steps for both protocols of the ROM bootloader.
class RomSteps {
 public:
  explicit RomSteps(const BarePlan& plan) : plan_(plan) {}

  std::vector<BareStep> make() {
    read("read the place of the bootloader", plan_.bootloader, plan_.bootloader_size, bare_file::present, "");
    if (plan_.settings_size > 0) {
      write("the board record", plan_.settings, plan_.settings_size, bare_file::settings);
    }
    if (plan_.trust_size > 0) {
      write("the key", plan_.trust, plan_.trust_size, bare_file::trust);
    }
    write("the image", plan_.image, plan_.image_size, bare_file::image);
    const std::size_t first = steps_.size();
    write("the bootloader", plan_.bootloader, plan_.bootloader_size, bare_file::bootloader);
    std::for_each(steps_.begin() + static_cast<std::ptrdiff_t>(first), steps_.end(),
                  [](BareStep& step) { step.is_for_other_bootloader = true; });
    return std::move(steps_);
  }

 private:
  /// A command of stm32flash. It begins with the byte by which the ROM bootloader measures the baud rate. The second
  /// and later commands must omit it, because it would be taken for a command.
  [[nodiscard]] Words stm32flash(const Words& options, const std::string& range) const {
    Words words{"stm32flash", "-b", "115200"};
    if (!steps_.empty()) {
      words.emplace_back("-c");
    }
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), {"-S", range, plan_.port});
    return words;
  }

  [[nodiscard]] static Words dfu_util(const std::string& place, const char* direction, const std::string& file) {
    return {"dfu-util", "-d", ",0483:df11", "-a", "0", "-s", place, direction, file};
  }

  void read(const std::string& what, const FlashPart& part, std::uint32_t size, const std::string& result,
            const std::string& expected) {
    const std::string range = range_word(part.address, size);
    steps_.push_back({what,
                      plan_.probe == BareProbe::dfu ? dfu_util(range, "-U", result) : stm32flash({"-r", result}, range),
                      result, expected, false});
  }

  /// Adds the steps that write a part and read it back: neither an exit status nor an answer of the ROM bootloader
  /// says that a sector was not protected.
  void write(const std::string& what, const FlashPart& part, std::uint32_t size, const std::string& file) {
    // The range has a size: without it stm32flash erases all up to the end of the flash. -f: the file is binary,
    // whatever its bytes are.
    steps_.push_back({"write " + what,
                      plan_.probe == BareProbe::dfu
                          ? dfu_util(address_word(part), "-D", file)
                          : stm32flash({"-f", "-w", file}, range_word(part.address, part.size)),
                      "", "", false});
    read("read " + what + " back", part, size, "read_" + file, file);
  }

  const BarePlan& plan_;
  std::vector<BareStep> steps_;
};

// Addresses of RM0090: DBGMCU_IDCODE (section 38.6.1), FLASH_OPTCR (3.9.10).
constexpr std::string_view script_start = R"(gdb_port disabled
tcl_port disabled
telnet_port disabled

proc refuse {text} {
  echo "refused: $text"
  shutdown error
}

# FLASH_OPTCR, with read protection level 0 (bits 15:8 are 0xAA). Any other level locks the chip, 0xCC does it forever.
# The commands that write option bytes write the level that they read. So it is checked before each of them.
proc option_bytes {} {
  set word [mrw 0x40023C14]
  set level [expr {($word >> 8) & 0xFF}]
  if {$level != 0xAA} {
    refuse [format "found the read protection 0x%02X, expected 0xAA, which is none" $level]
  }
  return $word
}

proc bytes_of {name} {
  set file [open $name rb]
  set bytes [read $file]
  close $file
  return $bytes
}

init
reset halt
set chip [expr {[mrw 0xE0042000] & 0xFFF}]
if {$chip != 0x413} {
  refuse [format "found a chip with the device id 0x%03X, expected 0x413, an STM32F405" $chip]
}
option_bytes

)";

constexpr std::string_view script_lifts_protection =
    R"(  # Bits 16 and 17, nWRP of sectors 0 and 1: a sector whose bit is 0 is protected.
  if {([option_bytes] & 0x30000) != 0x30000} {
    flash protect 0 0 1 off
    reset halt
  }
)";

// OpenOCD may end with status 0 although a command of a configuration file has failed.
constexpr std::string_view script_end = R"(
# Bits 3:2, BOR_LEV, become 0: brown-out level 3. The other user options stay.
if {[option_bytes] & 0x0C} {
  stm32f2x options_write 0 [expr {[option_bytes] & 0xF0}]
}
if {[option_bytes] & 0x30000} {
  flash protect 0 0 1 on
}
reset halt
set word [option_bytes]
if {$word & 0x3000C} {
  refuse [format "found the option bytes 0x%08X, expected bits 17, 16, 3 and 2 to be 0: the chip did not take them" $word]
}
reset run
set file [open end.txt w]
puts $file "all is written"
close $file
shutdown
)";

void write_sectors(std::ostream& out, const char* indent, const char* file, const FlashPart& part) {
  const std::string address = address_word(part);
  out << indent << "flash erase_address " << address << ' ' << part.size << '\n';
  // The option `erase` is not used: it programs the rest of the sector with 0xFF.
  out << indent << "flash write_image " << file << ' ' << address << " bin\n";
  out << indent << "verify_image " << file << ' ' << address << " bin\n";
}

/// A text that a program prints, in the version of Debian 12, and its meaning.
struct Symptom {
  std::string_view text;
  std::string_view meaning;
};

constexpr std::string_view udev_hint = "the udev rules 70-proleg.rules (docs/installing.md) give them to you";

constexpr std::string_view no_chip =
    "found a probe without a chip, expected an STM32F405 behind it: check SWDIO, SWCLK, ground, and the board's supply";

// The first symptom that fits counts: causes are listed before their consequences.
constexpr Symptom openocd_symptoms[] = {
    {"LIBUSB_ERROR_ACCESS", "found a probe without the rights to open it, expected rights: "},
    {"LIBUSB_ERROR_BUSY", "found a probe that another program uses, expected a free one: close it"},
    {"Error: open failed", "found no ST-LINK, expected one on USB: plug it in, 'lsusb -d 0483:' lists it"},
    {"No J-Link device found",
     "found no J-Link that can be opened, expected one on USB: plug it in, 'lsusb -d 1366:' lists it; if it is there, "
     "rights are missing: "},
    {"Multiple devices found", "found several J-Links, expected one: pull the plugs of the others"},
    {"unable to find a matching CMSIS-DAP",
     "found no CMSIS-DAP probe that can be opened, expected one on USB: plug it in, 'lsusb -v' lists it as CMSIS-DAP; "
     "if it is there, rights are missing: "},
    {"unable to open CMSIS-DAP device", "found a probe without the rights to open it, expected rights: "},
    {"target voltage may be too low",
     "found a chip without supply voltage, expected 3.3 V: connect the board's supply"},
    {"unable to connect to the target", no_chip},
    {"Error connecting DP", no_chip},
    {"stm32x device protected",
     "found a sector that is write-protected, expected at most sectors 0 and 1 to be: 'flash protect' of openocd shows "
     "how"},
    {"contents differ", "found other bytes in the flash than were written, expected the same: check supply and wires"},
};

constexpr Symptom dfu_symptoms[] = {
    {"LIBUSB_ERROR_ACCESS", "found a DFU device without the rights to open it, expected rights: "},
    {"More than one DFU capable", "found several DFU devices, expected one: pull the plugs of the others"},
    {"No DFU capable USB device",
     "found no DFU device, expected an STM32F405 on USB: set BOOT0 to high, reset the board, 'lsusb -d 0483:df11' "
     "lists "
     "it"},
    {"status(11)",
     "found a chip whose read protection is on, expected none: 'proleg flash --bare --probe stlink' says more"},
};

constexpr Symptom uart_symptoms[] = {
    {"Failed to open port", "found a serial line that cannot be used, expected a UART: another program may use it"},
    {"Failed to init device",
     "found no answer on the line, expected the ROM bootloader: set BOOT0 to high, reset the board, check the wires"},
    {"Failed to read memory",
     "found a chip whose read protection is on, expected none: 'proleg flash --bare --probe stlink' says more"},
};

std::span<const Symptom> symptoms_of(BareProbe probe) {
  switch (probe) {
    case BareProbe::dfu:
      return dfu_symptoms;
    case BareProbe::uart:
      return uart_symptoms;
    case BareProbe::stlink:
    case BareProbe::jlink:
    case BareProbe::cmsis_dap:
      break;
  }
  return openocd_symptoms;
}

constexpr std::string_view repeat_hint = "; the command can be repeated";

std::string_view protection_hint(const BareStep& step) {
  return step.is_for_other_bootloader ? "; if sectors 0 and 1 are write-protected, flash with --probe stlink" : "";
}

}  // namespace

std::uint32_t settings_file_size(const BarePlan& plan, std::uint32_t record_size) {
  return plan.probe == BareProbe::dfu ? plan.settings.size : record_size;
}

std::vector<BareStep> bare_steps(const BarePlan& plan) {
  return uses_swd(plan.probe) ? openocd_steps(plan.probe) : RomSteps(plan).make();
}

std::string bare_script(const BarePlan& plan) {
  std::ostringstream script;
  script << script_start;
  if (plan.settings_size > 0) {
    write_sectors(script, "", bare_file::settings, plan.settings);
  }
  if (plan.trust_size > 0) {
    write_sectors(script, "", bare_file::trust, plan.trust);
  }
  write_sectors(script, "", bare_file::image, plan.image);
  script << "\ndump_image " << bare_file::present << ' ' << address_word(plan.bootloader) << ' ' << plan.bootloader_size
         << "\nif {[bytes_of " << bare_file::present << "] ne [bytes_of " << bare_file::bootloader << "]} {\n"
         << script_lifts_protection;
  write_sectors(script, "  ", bare_file::bootloader, plan.bootloader);
  script << "}\n" << script_end;
  return script.str();
}

std::string shell_text(const Words& command) {
  const auto is_plain = [](char character) {
    return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z') ||
           (character >= '0' && character <= '9') ||
           std::string_view("_-+./:,=@%").find(character) != std::string::npos;
  };
  std::string text;
  for (const std::string& word : command) {
    text += text.empty() ? "" : " ";
    if (!word.empty() && std::ranges::all_of(word, is_plain)) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char character : word) {
      if (character == '\'') {
        text += "'\\'";  // ends the quotes and adds an apostrophe; the next character opens the quotes again
      }
      text += character;
    }
    text += '\'';
  }
  return text;
}

std::string missing_program(const std::string& program) {
  return "found no program " + program + ", expected the Debian package of that name: 'sudo apt install " + program +
         "' installs it";
}

std::string bare_failure(const BarePlan& plan, const BareStep& step, std::string_view output) {
  // The beginning of a line that bare_script() prints.
  constexpr std::string_view refused = "refused: ";
  if (const std::size_t at = output.find(refused); at != std::string_view::npos) {
    const std::string_view rest = output.substr(at + refused.size());
    return std::string(rest.substr(0, rest.find('\n')));
  }
  std::string text = "found an error of " + step.command.front() + " in the step '" + step.what +
                     "', expected none: its last lines say more";
  for (const Symptom& symptom : symptoms_of(plan.probe)) {
    if (output.find(symptom.text) != std::string_view::npos) {
      text = symptom.meaning;
      text += text.ends_with(": ") ? udev_hint : "";
      break;
    }
  }
  return text.append(protection_hint(step)).append(repeat_hint);
}

std::string bare_difference(const BareStep& step) {
  std::string text = "found other bytes in the step '" + step.what + "' than were written, expected the same";
  return text.append(protection_hint(step)).append(repeat_hint);
}

}  // namespace proleg::host
