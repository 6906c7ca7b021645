// Any header, and anything that a bus can do to a bootloader. A header that is accepted has one form only. Whatever
// frames come: the flash is written only with an image that is right for the board, and an image that runs remains.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "firmware/bootloader/bootloader.hpp"
#include "shared/fixed/crc32.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using namespace proleg::bootloader;
using test::FuzzInput;
using test::require;

constexpr image::Place place{1, 0, 0x0802'0200, 256};
constexpr std::uint32_t serial = 0x11223344;
constexpr std::uint8_t node = 9;

/// Of a key that has signed nothing: the public key of RFC 8032, section 7.1, test 1.
const image::Trust trust{
    image::PublicKey{0xD7, 0x5A, 0x98, 0x01, 0x82, 0xB1, 0x0A, 0xB7, 0xD5, 0x4B, 0xFE, 0xD3, 0xC9, 0x64, 0x07, 0x3A,
                     0x0E, 0xE1, 0x72, 0xF3, 0xDA, 0xA6, 0x23, 0x25, 0xAF, 0x02, 0x1A, 0x68, 0xF7, 0x07, 0x51, 0x1A},
    {1, 2, 3}};

void check_header(std::span<const std::uint8_t> input, bool repairs_crc) {
  std::vector<std::uint8_t> bytes(input.begin(), input.end());
  if (repairs_crc && bytes.size() >= image::header_size) {
    write_little_endian(bytes, 508, 4, crc32(std::span(bytes).first(508)));
  }
  const auto [header, error] = image::decode(bytes);
  if (error == image::Error::none) {
    require(std::ranges::equal(image::encode(header), std::span(bytes).first(image::header_size)),
            "a header has one form");
  }
  require(image::describe(error) != "unknown error", "every error has a description");
  if (bytes.size() >= image::header_size) {
    require(image::check_trust(trust, bytes) != image::Error::none, "nobody signs without the key");
    require(!(image::trust_after(trust, bytes).minimum_version < trust.minimum_version), "the lowest version rises");
  }
}

std::vector<std::uint8_t> image_bytes(std::uint16_t number) {
  std::vector<std::uint8_t> body(64 + 4 * (number % 40U));
  for (std::size_t i = 0; i < body.size(); ++i) {
    body[i] = static_cast<std::uint8_t>(i * number);
  }
  image::Header header;
  header.board_id = place.board_id;
  header.version = {number, 0, 0};
  header.address = place.address;
  image::describe_body(header, body);
  const image::HeaderBytes header_bytes = image::encode(header);
  std::vector<std::uint8_t> bytes(header_bytes.begin(), header_bytes.end());
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

class Memory final : public SlotFlash {
 public:
  bool erase(FlashSlot slot) override {
    std::ranges::fill(bytes(slot), std::uint8_t{0xFF});
    ++erases;
    return true;
  }
  bool program(FlashSlot slot, std::uint32_t offset, std::span<const std::uint8_t> part) override {
    require(offset % 4 == 0 && part.size() % 4 == 0 && offset + part.size() <= bytes(slot).size(), "inside the slot");
    for (std::size_t i = 0; i < part.size(); ++i) {
      std::uint8_t& byte = bytes(slot)[offset + i];
      require((byte & part[i]) == part[i], "a bit cannot be set without an erase");
      byte = part[i];
    }
    return true;
  }
  [[nodiscard]] std::span<const std::uint8_t> contents(FlashSlot slot) const override {
    return slots[static_cast<std::size_t>(slot)];
  }

  unsigned erases = 0;

 private:
  using Bytes = std::vector<std::uint8_t>;
  Bytes& bytes(FlashSlot slot) { return slots[static_cast<std::size_t>(slot)]; }
  Bytes slots[3] = {Bytes(2'048, 0xFF), Bytes(2'048, 0xFF), Bytes(256, 0xFF)};
};

class Bus final : public CanPort {
 public:
  [[nodiscard]] bool send(const CanFrame& frame) override {
    require(frame.identifier <= CanFrame::max_identifier && frame.length <= CanFrame::max_length, "frames are valid");
    return !is_full;
  }
  bool is_full = false;
};

class Settings final : public canopen::LssStorage {
 public:
  Result store_node(std::uint8_t /*node*/) override { return {}; }
};

/// A bootloader with an image that has proven itself, and a host that may be anybody.
class Session {
 public:
  explicit Session(bool has_key) : has_key_(has_key) {
    require(slots_.install(image_bytes(1)) == InstallResult::ok, "installed");
    require(slots_.prepare_start() == StartResult::run_on_trial && slots_.confirm(), "confirmed");
    require(!has_key || slots_.trust().append(trust), "the key is kept");
    erases_ = memory_.erases;
    bootloader_.power_on(0, node, {});
  }

  void play(FuzzInput& input) {
    while (!input.empty() && !bootloader_.wants_restart()) {
      play_event(input);
    }
    bus_.is_full = false;
    const StartResult result = slots_.prepare_start();
    require(result == StartResult::run || result == StartResult::run_on_trial, "an image runs");
    require(!slots_.image_in(FlashSlot::a).empty(), "it is complete, and for this board");
  }

 private:
  void play_event(FuzzInput& input) {
    constexpr std::uint16_t identifiers[]{broadcast::host_identifier, 0x600 + node, 0x7E5, 0x000};
    const std::uint8_t event = input.byte();
    switch (event % 8) {
      case 0:
        now_ += 1'000U * input.byte();
        break;
      case 1:
        bus_.is_full = (event & 8U) != 0;
        break;
      case 2:
        bootloader_.bus_was_lost();
        break;
      case 3:
        bring_image(input);
        break;
      default: {
        CanFrame frame{identifiers[event % 4], static_cast<std::uint8_t>(input.byte() % 9U), {}};
        std::generate_n(frame.data.begin(), frame.length, [&input] { return input.byte(); });
        receive(frame);
      }
    }
    const unsigned erases = memory_.erases;
    bootloader_.poll(now_);
    if (memory_.erases != erases) {
      require(image::check_image(slots_.image_in(FlashSlot::a), place) == image::Error::none,
              "what was written is complete, and right for the board");
    }
    require(!has_key_ || (memory_.erases == erases_ && slots_.trust().read() == trust),
            "without the key nobody changes anything");
    require(bootloader_.next_deadline() > now_ || bus_.is_full || bootloader_.next_deadline() == 0,
            "a deadline that is polled is over");
  }

  /// A host that knows the protocol, with an image in which one byte may be wrong.
  void bring_image(FuzzInput& input) {
    std::vector<std::uint8_t> bytes = image_bytes(input.byte());
    const std::uint32_t checksum = crc32(broadcast::block_of(std::span<const std::uint8_t>(bytes), 0));
    const std::uint8_t session = input.byte();
    const std::size_t wrong = input.byte() * 4U + input.byte();
    if (wrong < bytes.size()) {
      bytes[wrong] ^= input.byte();
    }
    receive(broadcast::select_frame(session, serial));
    receive(broadcast::begin_frame(session, static_cast<std::uint32_t>(bytes.size())));
    receive(broadcast::block_frame(session, 0, broadcast::BlockKind::symbols));
    if (wrong % 2 == 0) {
      receive(broadcast::check_frame(session, 0, checksum));
    }
    for (unsigned number = 0; number < broadcast::symbols_of(bytes.size()); ++number) {
      receive(broadcast::symbol_frame(number, broadcast::symbol_of(bytes, number)));
    }
    receive(broadcast::report_frame(serial));
    receive(broadcast::install_frame(session));
  }

  void receive(const CanFrame& frame) {
    bootloader_.receive(now_, frame);
    if (!bus_.is_full) {
      bootloader_.transmitted(now_, frame);
    }
  }

  const bool has_key_;
  unsigned erases_ = 0;  ///< before the host
  Memory memory_;
  Bus bus_;
  Settings settings_;
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(image::header_size + place.room);
  Slots slots_{memory_, place};
  Bootloader bootloader_{place, serial, Ports{bus_, memory_, settings_, buffer_}};
  Microseconds now_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input({data, size});
  const std::uint8_t mode = input.byte();
  if (mode % 4 < 2 && size > 0) {
    check_header({data + 1, size - 1}, mode % 4 == 1);
  } else {
    Session(mode % 8 < 4).play(input);
  }
  return 0;
}
