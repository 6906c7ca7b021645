#pragma once

// What puts a bootloader and a first image on an empty STM32F405: the command lines of openocd (a probe at SWD), of
// dfu-util (the chip's ROM bootloader over USB, AN3156) and of stm32flash (that bootloader over a UART, AN3155). Text
// only, no input or output.
//
// The order is: board record, key, image, bootloader, option bytes. The chip starts from sector 0, so that is written
// when all that it starts is there, and it is protected when it is right. Each step writes the same bytes again at a
// second try: after an interruption at any point the whole can be repeated. Only the sectors that are written are
// erased: a chip that had a bootloader before keeps its settings and slot B.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::host {

/// The way in which the computer reaches the chip.
enum class BareProbe : std::uint8_t {
  stlink,     ///< openocd
  jlink,      ///< openocd
  cmsis_dap,  ///< openocd
  dfu,        ///< dfu-util; BOOT0 is high
  uart,       ///< stm32flash; BOOT0 is high
};

/// Whether the probe is at the connector SWD.
[[nodiscard]] constexpr bool uses_swd(BareProbe probe) { return probe <= BareProbe::cmsis_dap; }

/// A part of the flash that is erased as a whole.
struct FlashPart {
  std::uint32_t address = 0;
  std::uint32_t size = 0;  ///< bytes
};

/// Names of files in the folder in which the commands run.
namespace bare_file {
inline constexpr const char* bootloader = "bootloader.bin";
inline constexpr const char* image = "image.pimg";
inline constexpr const char* settings = "settings.bin";  ///< settings_file_size() bytes, 0xFF behind the record
inline constexpr const char* trust = "key.bin";          ///< a record of the key of images
inline constexpr const char* present = "present.bin";    ///< the bytes of the chip in the place of the bootloader
inline constexpr const char* script = "bare.tcl";
inline constexpr const char* end = "end.txt";  ///< the last command of the script writes it
}  // namespace bare_file

struct BarePlan {
  BareProbe probe = BareProbe::stlink;
  std::string port;                   ///< the serial line; only for `uart`
  FlashPart bootloader;               ///< sectors 0 and 1
  FlashPart settings;                 ///< the sectors of board records
  FlashPart image;                    ///< the sector of slot A that the bootloader uses
  FlashPart trust;                    ///< the sector of records of the key of images
  std::uint32_t bootloader_size = 0;  ///< bytes of the file; a multiple of 4
  std::uint32_t image_size = 0;       ///< bytes of the file, header included; a multiple of 4
  std::uint32_t settings_size = 0;    ///< bytes of the file with the board record; 0: none is written
  std::uint32_t trust_size = 0;       ///< bytes of the record of the key; 0: none is written
};

struct BareStep {
  std::string what;                      ///< what the step does, for a person: "write the image"
  std::vector<std::string> command;      ///< the program and its arguments; no shell takes part
  std::string result;                    ///< a file that the command writes; empty: none
  std::string expected;                  ///< a file that the result must equal; empty: the result decides (see below)
  bool is_for_other_bootloader = false;  ///< the step is needed only if `present` differs from `bootloader`
};

/// Bytes of the file with a board record of record_size bytes. dfu-util erases the sectors that it writes to, and all
/// that have records must be erased: what stays in one of them could be newer. The others erase all by a command.
[[nodiscard]] std::uint32_t settings_file_size(const BarePlan& plan, std::uint32_t record_size);

/// The steps in their order. With openocd there is one, which runs bare_script().
[[nodiscard]] std::vector<BareStep> bare_steps(const BarePlan& plan);

/// The script for openocd, in Tcl. It also writes option bytes: brown-out level 3 and the write protection of
/// sectors 0 and 1, each only if the chip does not have it.
[[nodiscard]] std::string bare_script(const BarePlan& plan);

/// Whether the steps set the option bytes. The ROM bootloader takes them, too, but as 16 bytes with the read protection
/// among them, and RM0090 and the programs that write them do not agree on their order. A wrong byte locks the chip,
/// with 0xCC forever, so dfu-util and stm32flash do not write them.
[[nodiscard]] constexpr bool sets_option_bytes(BareProbe probe) { return uses_swd(probe); }

/// A command as a person would type it into a shell.
[[nodiscard]] std::string shell_text(const std::vector<std::string>& command);

/// One line that says what a person can do about a step (bare_steps()) whose program is not installed.
[[nodiscard]] std::string missing_program(const std::string& program);

/// One line that says what a person can do about a step whose program has failed. output: all text that it has
/// printed.
[[nodiscard]] std::string bare_failure(const BarePlan& plan, const BareStep& step, std::string_view output);

/// One line that says what a person can do about a step whose result differs from the bytes that were written.
[[nodiscard]] std::string bare_difference(const BareStep& step);

}  // namespace proleg::host
