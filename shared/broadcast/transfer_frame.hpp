#pragma once

// The frames with which an image goes to many modules at once. Programs and bootloaders of modules take part alike. The
// host sends with one identifier: a frame of 8 bytes is a symbol, a shorter one a request. A module answers only if the
// request names its serial number, so that two never send with the same identifier at once.
//
//   symbol    8 bytes   u8 number of the symbol (of the repair symbol) in the present block, 7 bytes
//   select    6 bytes   1, u8 session (1 to 255), u32 serial number: the module takes part          answer: status
//   begin     5 bytes   2, u8 session, u24 bytes of the image
//   block     4 bytes   3, u8 session, u8 block, u8 0: symbols follow, 1: repair symbols
//   report    5 bytes   4, u32 serial number                                                       answer: report
//   install   2 bytes   5, u8 session
//   status    5 bytes   6, u32 serial number                                                        answer: status
//   leave     2 bytes   7, u8 session: start the program
//   header    6 bytes   8, u8 word, u32 serial number                                              answer: header
//   enter     5 bytes   9, u32 serial number: restart, and stay in the bootloader                  answer: status
//                       (0: all modules whose bootloader listens after power on)                   no answer
//   check     7 bytes   10, u8 session, u8 block, u32 CRC-32 of the block's bytes, after `block`
//
// Answers have 8 bytes and begin with the code of the request and the low 16 bits of the serial number:
//
//   status    u8 state, u8 error, u8 session, u8 flags (module_flag), u8 node id, 0: none
//   header    u8 word, u32 this word of the header of the image in slot A; 0 without an image; words 128 to 130 say
//             which images the module takes (TrustSummary)
//   report    u8 blocks that miss symbols (255: the module waits for `begin`), u8 the most that one of them misses of
//             those that repair symbols can complete, 3 x u8 some of these blocks, first those that repair symbols
//             cannot complete, with bit 7; 255: there are no more

#include <array>
#include <optional>

#include "shared/broadcast/block_decoder.hpp"
#include "shared/can/can_frame.hpp"
#include "shared/can/can_port.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::broadcast {

inline constexpr std::uint16_t host_identifier = 0x690;
inline constexpr std::uint16_t module_identifier = 0x691;

inline constexpr unsigned max_blocks = 96;
inline constexpr std::size_t block_size = block_symbols * symbol_size;
inline constexpr std::uint8_t no_image = 0xFF;  ///< as the number of blocks in a report: the module waits for `begin`
inline constexpr std::uint8_t no_block = 0xFF;
/// Bit of the number of a block in a report: repair symbols cannot complete the block.
inline constexpr std::uint8_t needs_symbols = 0x80;

/// Serial number in `enter` that names every module whose bootloader listens after power on. Modules whose program runs
/// ignore it.
inline constexpr std::uint32_t every_serial = 0;
/// Time after power on in which the bootloader listens for `enter` before it starts the program: eight requests of a
/// host that repeats them, so that some may be lost. The checksum of the program is computed meanwhile, with the full
/// clock. With the clock after a reset it takes as long as the window, so a start is no later than one without.
inline constexpr Microseconds start_window_us = 87'000;
/// Period of the requests of a host that holds modules in their bootloaders: 1 % of the bus.
inline constexpr Microseconds hold_period_us = 10'000;

enum class Code : std::uint8_t { select = 1, begin, block, report, install, status, leave, header, enter, check };

enum class BlockKind : std::uint8_t { symbols, repairs };

/// States of a module in a broadcast.
enum class ReceiverState : std::uint8_t {
  idle,       ///< takes part in no session
  selected,   ///< waits for `begin`
  receiving,  ///< symbols are missing
  complete,   ///< has all symbols
  installed,
  refused,  ///< it has rejected the image; the flash is unchanged
  failed,   ///< the flash has failed
};

/// Bits of the flags in a status.
namespace module_flag {
inline constexpr std::uint8_t runs_program = 1U << 0U;  ///< the program answers; else the bootloader answers
inline constexpr std::uint8_t has_image = 1U << 1U;     ///< slot A holds a complete image
inline constexpr std::uint8_t is_confirmed = 1U << 2U;  ///< that image has started well once
/// The servo has power, or the module is Operational: the module does not restart.
inline constexpr std::uint8_t is_busy = 1U << 3U;
/// The settings have a later schema, so the program uses only their node id.
inline constexpr std::uint8_t has_newer_settings = 1U << 4U;
/// A host may be connected to its serial line, which ends when the module installs an image.
inline constexpr std::uint8_t is_gateway = 1U << 5U;
/// The program has stopped just after its start several times, so the bootloader stays active.
inline constexpr std::uint8_t starts_badly = 1U << 6U;
/// The module has a bootloader; without it nothing can be installed over the bus.
inline constexpr std::uint8_t has_bootloader = 1U << 7U;
}  // namespace module_flag

struct ModuleCondition {
  std::uint8_t flags = 0;  ///< bits of module_flag
  std::uint8_t node = 0;   ///< node id; 0: none

  friend bool operator==(const ModuleCondition&, const ModuleCondition&) = default;
};

// Errors of the state `refused`; smaller numbers are those of image::Error.
inline constexpr std::uint8_t refused_busy = 0x80;    ///< the module is_busy (module_flag)
inline constexpr std::uint8_t refused_size = 0x81;    ///< the module has no room for an image of this size
inline constexpr std::uint8_t refused_supply = 0x82;  ///< the supply of the module is too low to write its flash

struct StatusAnswer {
  ReceiverState state = ReceiverState::idle;
  std::uint8_t error = 0;  ///< error of the states `refused` and `failed`, from the installer
  std::uint8_t session = 0;
  ModuleCondition condition{};
};

struct HeaderWord {
  std::uint8_t number = 0;
  std::uint32_t value = 0;
};

/// Which images a module takes. It is read as words behind those of the header: the key id; major and, in the upper
/// half, minor; patch. Modules that do not know these words answer 0.
struct TrustSummary {
  std::uint32_t key_id = 0;  ///< id of the key with which images must be signed; 0: it takes any image
  std::uint16_t major = 0;   ///< with a key: the lowest version that it takes
  std::uint16_t minor = 0;
  std::uint16_t patch = 0;

  static constexpr std::uint8_t first_word = 128;
  static constexpr unsigned words = 3;

  /// One of the words; 0 for all others.
  [[nodiscard]] constexpr std::uint32_t word(unsigned number) const {
    switch (number) {
      case first_word:
        return key_id;
      case first_word + 1:
        return major | std::uint32_t{minor} << 16U;
      case first_word + 2:
        return patch;
      default:
        return 0;
    }
  }
  constexpr void set_word(unsigned number, std::uint32_t value) {
    if (number == first_word) {
      key_id = value;
    } else if (number == first_word + 1) {
      major = static_cast<std::uint16_t>(value);
      minor = static_cast<std::uint16_t>(value >> 16U);
    } else if (number == first_word + 2) {
      patch = static_cast<std::uint16_t>(value);
    }
  }

  friend bool operator==(const TrustSummary&, const TrustSummary&) = default;
};

struct ReportAnswer {
  std::uint8_t blocks = 0;  ///< number of blocks that miss symbols
  std::uint8_t most = 0;    ///< greatest number of symbols that one of them misses, at most BlockDecoder::max_missing
  std::array<std::uint8_t, 3> some{no_block, no_block, no_block};
};

/// Bytes of block `number` of an image; empty behind the last block.
template <typename Byte>
[[nodiscard]] constexpr std::span<Byte> block_of(std::span<Byte> image, unsigned number) {
  const std::size_t begin = number * block_size;
  return begin >= image.size()
             ? std::span<Byte>()
             : image.subspan(begin, image.size() - begin < block_size ? image.size() - begin : block_size);
}

[[nodiscard]] constexpr unsigned blocks_of(std::size_t bytes) {
  return static_cast<unsigned>((bytes + block_size - 1) / block_size);
}

[[nodiscard]] CanFrame symbol_frame(unsigned number, const Symbol& symbol);
[[nodiscard]] CanFrame select_frame(std::uint8_t session, std::uint32_t serial);
[[nodiscard]] CanFrame begin_frame(std::uint8_t session, std::uint32_t size);
[[nodiscard]] CanFrame block_frame(std::uint8_t session, unsigned block, BlockKind kind);
[[nodiscard]] CanFrame check_frame(std::uint8_t session, unsigned block, std::uint32_t checksum);
[[nodiscard]] CanFrame report_frame(std::uint32_t serial);
[[nodiscard]] CanFrame install_frame(std::uint8_t session);
[[nodiscard]] CanFrame status_frame(std::uint32_t serial);
[[nodiscard]] CanFrame leave_frame(std::uint8_t session);
[[nodiscard]] CanFrame header_frame(std::uint32_t serial, std::uint8_t word);
[[nodiscard]] CanFrame enter_frame(std::uint32_t serial);

/// Whether a frame is an `enter` for every module, or for the one with this serial number.
[[nodiscard]] bool is_enter_request(const CanFrame& frame, std::uint32_t serial);

[[nodiscard]] CanFrame answer_frame(Code code, std::uint32_t serial, const StatusAnswer& status);
[[nodiscard]] CanFrame answer_frame(std::uint32_t serial, const ReportAnswer& report);
[[nodiscard]] CanFrame answer_frame(std::uint32_t serial, const HeaderWord& word);

/// The answer of this module to a request with this code; nothing for any other frame.
[[nodiscard]] std::optional<StatusAnswer> decode_status(const CanFrame& frame, Code code, std::uint32_t serial);
[[nodiscard]] std::optional<ReportAnswer> decode_report(const CanFrame& frame, std::uint32_t serial);
[[nodiscard]] std::optional<HeaderWord> decode_header_word(const CanFrame& frame, std::uint32_t serial);

}  // namespace proleg::broadcast
