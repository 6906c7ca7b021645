#include "sim/mcu/module/flashed_chip.hpp"

#include <algorithm>
#include <functional>
#include <span>
#include <stdexcept>
#include <utility>

#include "firmware/bootloader/slots.hpp"
#include "firmware/module/module_identity.hpp"
#include "firmware/stm32f405/flash_layout.hpp"
#include "shared/broadcast/image_sender.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/little_endian.hpp"
#include "shared/image/board_names.hpp"
#include "sim/bus/bus.hpp"
#include "sim/hardware_loop/crystal.hpp"

namespace proleg::sim {
namespace {

namespace layout = stm32f405::flash_layout;
using bootloader::Slots;
using broadcast::ReceiverState;
using State = broadcast::ImageSender::State;

constexpr BusTime ms = 1'000'000;
constexpr BusTime s = 1'000 * ms;
constexpr const char* the_bootloader = "the bootloader of a module (firmware/stm32f405/bootloader)";

FlashImage read_bootloader(const std::filesystem::path& file) {
  FlashImage image(file);
  for (const ElfImage::Segment& segment : image.elf().segments()) {
    if (segment.load_address + segment.bytes.size() > layout::board_records) {
      throw ElfError(file.string() + ": found a program with bytes at " + hexadecimal(segment.load_address, 8) +
                     ", expected " + the_bootloader + ", all of it in sectors 0 and 1, below " +
                     hexadecimal(layout::board_records, 8));
    }
  }
  return image;
}

firmware::ModuleIdentity identity_of(const std::array<std::uint32_t, 3>& unique_id) {
  firmware::ModuleIdentity identity;
  identity.node = 1;
  identity.unique_id = unique_id;
  return identity;
}

/// The bootloader must be that of the image's board: another one can have another clock.
void require_same_board(const FirmwareImage& image, const FlashImage& bootloader) {
  constexpr std::uint32_t id_bits = 0xFFFF;
  std::uint32_t word = 0;
  for (const ElfImage::Segment& segment : bootloader.elf().segments()) {
    if (segment.load_address == layout::bootloader && segment.bytes.size() >= image::bootloader_board_at + 4) {
      word = static_cast<std::uint32_t>(read_little_endian(segment.bytes, image::bootloader_board_at, 4));
    }
  }
  const auto board = static_cast<std::uint16_t>(word & id_bits);
  if ((word & ~id_bits) == image::bootloader_board_mark && board != image.board().id) {
    const auto text = [](std::uint16_t id) {
      return "board " + std::to_string(id) + " (" + std::string(image::board_name(id)) + ")";
    };
    throw ElfError(image.file().string() + ": found an image for " + text(image.board().id) + ", expected one for " +
                   text(board) + ", as the bootloader " + bootloader.elf().file().string());
  }
}

/// A slot that contains only this image.
std::vector<std::uint8_t> slot_with(std::span<const std::uint8_t> image) {
  constexpr std::uint8_t erased = 0xFF;
  std::vector<std::uint8_t> slot(layout::image_sector_a.size, erased);
  std::ranges::copy(image, slot.begin());
  return slot;
}

/// A host with one module on a bus.
class Flashing final : private BusListener {
 public:
  Flashing(const FirmwareImage& image, const FlashImage& bootloader, const firmware::ModuleIdentity& identity)
      : file_(image.file()),
        image_(image.image()),
        bootloader_{bootloader.elf().file(), bootloader.elf().segments()},
        module_(parts(identity), image, {.flash = &bootloader_}),
        controller_(bus_.attach(*this)),
        boot_up_delay_(BusTime{firmware::boot_up_delay_us(identity)} * 1'000),
        targets_{{{.serial = firmware::serial_number(identity)}}} {
    bus_.set_frame_listener([this](const Transmission& transmission) {
      const auto heartbeat = canopen::decode_heartbeat(transmission.frame);
      if (heartbeat && heartbeat->state == canopen::NmtState::boot_up) {
        boot_up_ = transmission.start;
      }
    });
  }

  FlashedChip run() {
    install();
    std::vector<std::uint8_t> slot = contents();
    require(slot, slot_with(image_));
    FlashedChip chip;
    if (confirms_itself()) {
      chip.flash_time = bus_.now();
      slot = contents();
      require(slot, confirmed_slot());
      chip.start_time = start();
    }
    chip.flash = bootloader_;
    chip.flash.parts.push_back({layout::slot_a, std::move(slot)});
    chip.image_size = image_.size();
    while (auto problem = module_.take_problem()) {
      chip.problems.push_back(std::move(*problem));
    }
    return chip;
  }

 private:
  static constexpr std::uint8_t session = 1;
  static constexpr BusTime start_timeout = s;
  static constexpr BusTime flash_timeout = 30 * s;  ///< the sender gives up earlier
  static constexpr BusTime trial_timeout = 3 * s;
  static constexpr BusTime question_period = 100 * ms;

  [[nodiscard]] ModuleParts parts(const firmware::ModuleIdentity& identity) {
    const auto readings = [] { return ServoReadings{}; };
    return {bus_, 0, identity, Crystal(), [] { return std::uint8_t{0}; }, readings, readings, false};
  }

  void install() {
    const broadcast::Target& target = targets_[0];
    const auto require_bootloader = [this](bool is_one, const std::string& found) {
      if (!is_one) {
        throw ElfError(bootloader_.bootloader.string() + ": found a program that " + found + ", expected " +
                       the_bootloader);
      }
    };
    module_.power_on(bus_.now());
    require_bootloader(wait_for([this] { return boot_up_.has_value(); }, start_timeout), "sends no boot-up");
    sender_.start(clock_.at(bus_.now()));
    wait_for([this] { return sender_.state() == State::complete || target_is_lost(); }, flash_timeout);
    require_bootloader(!target.is_lost, "receives no image");
    sender_.install(clock_.at(bus_.now()));
    wait_for([this] { return sender_.state() == State::done; }, flash_timeout);
    if (target.status.state == ReceiverState::refused) {
      refuse(static_cast<image::Error>(target.status.error));
    }
    require_bootloader(target.status.state == ReceiverState::installed, "does not install an image");
  }

  [[noreturn]] void refuse(image::Error error) const {
    const image::Header header = image::decode(image_).header;
    const std::string_view name = image::board_name(header.board_id);
    throw ElfError(file_.string() + ": found an image for board " + std::to_string(header.board_id) + " (" +
                   std::string(name.empty() ? "not known" : name) + ") at " + hexadecimal(header.address, 8) +
                   " that the bootloader refuses (" + std::string(image::describe(error)) +
                   "), expected an image for the board of " + bootloader_.bootloader.string() + " at " +
                   hexadecimal(layout::image_body, 8));
  }

  /// Starts the program on trial; true if it confirms itself.
  [[nodiscard]] bool confirms_itself() {
    static_cast<void>(controller_.send(broadcast::leave_frame(session)));
    constexpr std::uint32_t word_at = layout::image_sector_a.address + layout::image_sector_a.size - Slots::words_size;
    const BusTime end = bus_.now() + trial_timeout;
    std::array<std::uint8_t, 4> word{};
    for (BusTime next_question = bus_.now();
         bus_.now() < end && read_little_endian(word, 0, word.size()) != Slots::confirmed_word;) {
      if (bus_.now() >= next_question) {
        // A program that receives no frame is not confirmed: it could not be replaced.
        static_cast<void>(controller_.send(broadcast::status_frame(targets_[0].serial)));
        next_question = bus_.now() + question_period;
      }
      run_until(bus_.now() + ms);
      module_.chip().read(word_at, word);
    }
    return bus_.now() < end;
  }

  /// Starts the program and returns the duration of the start.
  [[nodiscard]] BusTime start() {
    boot_up_.reset();
    const BusTime begin = bus_.now();
    module_.power_on(begin);
    if (!wait_for([this] { return boot_up_.has_value(); }, start_timeout)) {
      throw std::runtime_error(file_.string() +
                               ": found a program that has confirmed itself and sends no boot-up at its "
                               "next start, expected one within a second");
    }
    return *boot_up_ - begin - boot_up_delay_;
  }

  /// The slot's contents after the program has confirmed itself at its first start on trial.
  [[nodiscard]] std::vector<std::uint8_t> confirmed_slot() const {
    std::vector<std::uint8_t> slot = slot_with(image_);
    const std::size_t words = slot.size() - Slots::words_size;
    write_little_endian(slot, words, 4, Slots::confirmed_word);
    write_little_endian(slot, words + 4, 4, 0);
    return slot;
  }

  [[nodiscard]] std::vector<std::uint8_t> contents() {
    std::vector<std::uint8_t> slot(layout::image_sector_a.size);
    module_.chip().read(layout::image_sector_a.address, slot);
    return slot;
  }

  void require(const std::vector<std::uint8_t>& slot, const std::vector<std::uint8_t>& expected) const {
    const auto [found, wanted] = std::ranges::mismatch(slot, expected);
    if (found != slot.end()) {
      const auto offset = static_cast<std::uint32_t>(found - slot.begin());
      throw std::runtime_error(file_.string() + ": flashed, found " + hexadecimal(*found, 2) + " at " +
                               hexadecimal(layout::slot_a + offset, 8) + " of the chip, expected " +
                               hexadecimal(*wanted, 2));
    }
  }

  [[nodiscard]] bool target_is_lost() const { return targets_[0].is_lost; }

  /// Waits for a condition; returns whether it became true before the timeout.
  bool wait_for(const std::function<bool()>& wanted, BusTime timeout) {
    const BusTime end = bus_.now() + timeout;
    while (!wanted() && bus_.now() < end) {
      take_step(end);
    }
    return wanted();
  }
  void run_until(BusTime time) {
    while (bus_.now() < time) {
      take_step(time);
    }
  }
  void take_step(BusTime until) {
    const BusTime deadline = clock_.when(sender_.next_deadline());
    const BusTime next = std::max(bus_.now(), std::min({until, deadline, bus_.next_event(), module_.next_event()}));
    bus_.advance_to(next);
    if (module_.next_event() <= next) {
      module_.advance_to(next, bus_.earliest_delivery());
    }
    if (clock_.when(sender_.next_deadline()) <= next) {
      sender_.poll(clock_.at(next));
    }
  }

  void received(BusTime time, const CanFrame& frame) override { sender_.receive(clock_.at(time), frame); }
  void transmitted(BusTime time, const CanFrame& /*frame*/) override { sender_.transmitted(clock_.at(time)); }

  std::filesystem::path file_;
  std::vector<std::uint8_t> image_;
  FlashContents bootloader_;
  Bus bus_;
  VirtualModule module_;
  Controller& controller_;
  Crystal clock_;
  BusTime boot_up_delay_;
  std::array<broadcast::Target, 1> targets_;
  broadcast::ImageSender sender_{controller_, image_, targets_, {.session = session}};
  std::optional<BusTime> boot_up_;
};

}  // namespace

FlashedChip flash_chip(const FirmwareImage& image, const std::filesystem::path& bootloader,
                       const std::array<std::uint32_t, 3>& unique_id) {
  const FlashImage program = read_bootloader(bootloader);
  require_same_board(image, program);
  return Flashing(image, program, identity_of(unique_id)).run();
}

}  // namespace proleg::sim
