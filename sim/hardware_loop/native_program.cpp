#include "sim/hardware_loop/native_program.hpp"

#include <algorithm>

#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/kernel/fingerprint.hpp"

namespace proleg::sim {
namespace {

namespace layout = stm32f405::flash_layout;
using bootloader::FlashSlot;
using bootloader::HandoverAction;
using bootloader::NextStep;
using bootloader::StartResult;

constexpr std::size_t slot_size = layout::max_image_size + bootloader::Slots::words_size;
constexpr std::size_t first_body_size = 256;

constexpr image::Place place_of(std::uint16_t board_id) {
  return {board_id, stm32f405::board::revision, layout::image_body, layout::max_image_size - image::header_size};
}

}  // namespace

std::vector<std::uint8_t> make_native_image(std::uint16_t board_id, const image::Version& version, std::size_t size) {
  image::Header header;
  header.board_id = board_id;
  header.lowest_revision = stm32f405::board::revision;
  header.highest_revision = stm32f405::board::revision;
  header.version = version;
  header.protocol = canopen::protocol_version;
  header.core_fingerprint = core_fingerprint;
  header.settings_schema = firmware::BoardRecord::schema;
  header.address = layout::image_body;
  std::vector<std::uint8_t> body(size);
  for (std::size_t i = 0; i < size; ++i) {
    body[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  }
  image::describe_body(header, body);
  const image::HeaderBytes bytes = image::encode(header);
  body.insert(body.begin(), bytes.begin(), bytes.end());
  return body;
}

NativeProgram::NativeProgram(CanPort& port, firmware::FlashPort& settings, const firmware::ModuleIdentity& identity)
    : port_(port),
      settings_(settings),
      serial_(serial_number(identity)),
      place_(place_of(identity.board_id)),
      slot_bytes_{std::vector<std::uint8_t>(slot_size, erased), std::vector<std::uint8_t>(slot_size, erased),
                  std::vector<std::uint8_t>(layout::trust_sector.size, erased)},
      buffer_(layout::max_image_size),
      slots_(*this, place_) {
  write_image(make_native_image(identity.board_id, {}, first_body_size), true);
}

void NativeProgram::write_image(std::span<const std::uint8_t> image, bool is_confirmed) {
  std::vector<std::uint8_t>& slot = slot_bytes_[0];
  std::ranges::fill(slot, erased);
  std::ranges::copy(image, slot.begin());
  if (is_confirmed && !image.empty()) {
    static_cast<void>(slots_.confirm());
  }
  flash_time_us_ = 0;
}

void NativeProgram::reset() {
  left_ = std::exchange(handover_, {});
  bootloader_.reset();
  resets_ = false;
  NextStep step = next_step(slots_, left_);
  if (step == NextStep::prepare) {
    const StartResult result = slots_.prepare_start();
    step = result == StartResult::run || result == StartResult::run_on_trial ? NextStep::start_program
                                                                             : NextStep::serve_bus;
    left_ = {HandoverAction::start, 0};
  }
  if (step == NextStep::start_program) {
    handover_ = started_after(left_);
  } else {
    make_bootloader();
  }
}

bool NativeProgram::is_held_by(const CanFrame& frame) {
  if (bootloader_ || !broadcast::is_enter_request(frame, serial_)) {
    return false;
  }
  handover_ = {};
  left_ = {HandoverAction::stay, 0};
  make_bootloader();
  return true;
}

void NativeProgram::start_bootloader(Microseconds now) {
  if (bootloader_) {
    bootloader_->power_on(now, firmware::newest_node(settings_.contents(0), settings_.contents(1)), left_);
  }
}

ProgramHealth NativeProgram::health() const {
  return health_ ? health_(image::decode(contents(FlashSlot::a)).header) : ProgramHealth::good;
}

bool NativeProgram::take_reset_request() {
  const bool resets = resets_ || (bootloader_ && bootloader_->wants_restart());
  resets_ = false;
  return resets;
}

std::span<const std::uint8_t> NativeProgram::header() const { return contents(FlashSlot::a).first(image::header_size); }

void NativeProgram::install(const firmware::Installation& what) {
  const bootloader::ImageInRam image{static_cast<std::uint32_t>(what.size), what.session, what.ends_line,
                                     what.run_time < bootloader::first_key_time_us};
  handover_ = {HandoverAction::install, image.argument()};
  resets_ = true;
}

void NativeProgram::enter_bootloader() {
  handover_ = {HandoverAction::stay, 0};
  resets_ = true;
}

bool NativeProgram::erase(FlashSlot slot) {
  if (slot == FlashSlot::trust) {
    return false;
  }
  std::ranges::fill(slot_bytes_.at(static_cast<std::size_t>(slot)), erased);
  flash_time_us_ += erase_time_us;
  return true;
}

bool NativeProgram::program(FlashSlot slot, std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    slot_bytes_.at(static_cast<std::size_t>(slot)).at(offset++) &= byte;  // programming only clears bits
  }
  flash_time_us_ += word_time_us * (bytes.size() / 4);
  return true;
}

std::span<const std::uint8_t> NativeProgram::contents(FlashSlot slot) const {
  return slot_bytes_.at(static_cast<std::size_t>(slot));
}

canopen::LssStorage::Result NativeProgram::store_node(std::uint8_t node) {
  return {firmware::append_node(settings_, node) == firmware::AppendResult::ok ? canopen::lss::ok
                                                                               : canopen::lss::storage_failed};
}

}  // namespace proleg::sim
