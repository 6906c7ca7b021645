#include "firmware/bootloader/bootloader.hpp"

#include <algorithm>

#include "shared/fixed/crc32.hpp"

namespace proleg::bootloader {

using broadcast::ReceiverState;
namespace module_flag = broadcast::module_flag;
using canopen::AbortCode;
using canopen::Address;
using canopen::Entry;

namespace {

std::uint32_t status_of(image::Error error) {
  const std::uint32_t reason = static_cast<std::uint32_t>(error) << 8U;
  switch (error) {
    case image::Error::none:
      return 0;
    case image::Error::too_short:
    case image::Error::not_an_image:
    case image::Error::unknown_format:
      return reason | object::status_unknown_format;
    case image::Error::damaged_header:
    case image::Error::wrong_length:
    case image::Error::damaged_body:
      return reason | object::status_wrong_data;
    default:
      return reason | object::status_other_error;
  }
}

}  // namespace

Bootloader::Bootloader(const image::Place& place, std::uint32_t serial, const Ports& ports)
    : place_(place),
      address_{canopen::placeholder_vendor, place.board_id, canopen::object::revision.default_value, serial},
      ports_(ports),
      slots_(ports.flash, place),
      queue_(ports.can),
      receiver_(ports.buffer, serial, *this),
      sdo_(0, *this) {}

void Bootloader::power_on(Microseconds now, std::uint8_t node, const Handover& left) {
  lss_.power_on(node);
  idle_at_ = now + idle_timeout_us;
  flags_ = module_flag::has_bootloader | (starts_badly(left) ? module_flag::starts_badly : 0U);
  slots_.keep_new_trust();  // before another image is checked
  look_at_slot();
  key_until_ = now + first_key_time_us;
  if (left.action == HandoverAction::install) {
    const ImageInRam image = ImageInRam::of(left.argument);
    key_until_ = image.may_be_key ? key_until_ : now;
    receiver_.resume(image.session, image.size);
    ends_line_ = image.ends_line;
  }
  start_network(now, node);
}

/// Checks the image in the slot. It computes a checksum, which takes long.
void Bootloader::look_at_slot() {
  const bool is_complete = !slots_.image_in(FlashSlot::a).empty();
  unsigned flags = flags_ & ~unsigned{module_flag::has_image | module_flag::is_confirmed};
  flags |= is_complete ? module_flag::has_image : 0U;
  flags |= is_complete && slots_.is_confirmed(FlashSlot::a) ? module_flag::is_confirmed : 0U;
  flags_ = static_cast<std::uint8_t>(flags);
}

void Bootloader::start_network(Microseconds now, std::uint8_t node) {
  node_ = node;
  ports_.can.set_node(node);
  sdo_.reset();
  sdo_.set_node(node);
  lss_.reset();
  if (node != 0) {
    send(canopen::encode(canopen::Heartbeat{node, canopen::NmtState::boot_up}));
    heartbeat_at_ = now + heartbeat_period_us;
  }
}

void Bootloader::receive(Microseconds now, const CanFrame& frame) {
  now_ = now;
  std::optional<CanFrame> answer;
  bool is_for_this_module = false;
  if (frame.identifier == broadcast::host_identifier && !is_downloading_ && downloaded_ == 0) {
    answer = receiver_.receive(now, frame);
    if (receiver_.take_leave_request()) {
      leave(now);
    }
  } else if (node_ != 0 && frame.identifier == canopen::identifier::sdo_request + node_) {
    answer = sdo_.receive(now, frame);
    is_for_this_module = true;
  } else if (frame.identifier == canopen::identifier::lss_request) {
    receive_lss(now, frame);
    is_for_this_module = lss_.state() != canopen::lss::State::waiting;
  } else if (frame.identifier == canopen::identifier::nmt) {
    receive_network_command(now, frame);
  }
  if (answer) {
    send(*answer);
  }
  if (answer || is_for_this_module || receiver_.state() == ReceiverState::receiving) {
    idle_at_ = now + idle_timeout_us;
  }
}

void Bootloader::receive_lss(Microseconds now, const CanFrame& frame) {
  if (const auto answer = lss_.serve(frame, address_, node_, ports_.settings)) {
    send(*answer);
  }
  if (node_ == 0 && lss_.pending_node() != 0 && lss_.state() == canopen::lss::State::waiting) {
    start_network(now, lss_.pending_node());
  }
}

void Bootloader::receive_network_command(Microseconds now, const CanFrame& frame) {
  const auto request = canopen::decode_nmt(frame);
  const bool is_for_this_node = node_ != 0 && request && (request->node == 0 || request->node == node_);
  if (is_for_this_node && (request->command == canopen::NmtCommand::reset_node ||
                           request->command == canopen::NmtCommand::reset_communication)) {
    leave(now);
  }
}

void Bootloader::leave(Microseconds now) {
  constexpr Microseconds sending_time_us = 100'000;
  leave_at_ = leaves_ ? leave_at_ : now + sending_time_us;
  leaves_ = true;
}

void Bootloader::transmitted(Microseconds now, const CanFrame& /*frame*/) {
  queue_.sent();
  while (sdo_.has_segment() && queue_.size() == 0) {
    send(sdo_.next_segment(now));
  }
}

void Bootloader::bus_was_lost() {
  queue_.clear();
  receiver_.bus_was_lost();
}

void Bootloader::poll(Microseconds now) {
  if (now >= sdo_.next_deadline()) {
    if (const auto frame = sdo_.poll(now)) {
      send(*frame);
    }
  }
  if (now >= heartbeat_at_) {
    heartbeat_at_ = now + heartbeat_period_us;
    static_cast<void>(
        queue_.push_newest(canopen::encode(canopen::Heartbeat{node_, canopen::NmtState::pre_operational})));
  }
  now_ = now;
  if (receiver_.has_install_request()) {
    install_broadcast();
    if (ends_line_) {
      leave(now);
    }
  } else if (downloaded_ != 0 &&
             queue_.size() == 0) {  // the answer goes first: while the flash is written nothing is sent
    static_cast<void>(write_image(ports_.buffer.first(downloaded_)));  // close_write() has checked the image
    downloaded_ = 0;
  }
  if (now >= idle_at_) {
    idle_at_ = now + idle_timeout_us;
    if (slots_.may_start()) {
      leave(now);
    }
  }
  if (now >= leave_at_) {
    leave_at_ = never;
    queue_.clear();  // no node acknowledges the frames
  }
}

Microseconds Bootloader::next_deadline() const {
  const bool installs = receiver_.has_install_request() || (downloaded_ != 0 && queue_.size() == 0);
  return installs ? 0 : std::min({sdo_.next_deadline(), heartbeat_at_, idle_at_, leave_at_});
}

void Bootloader::install_broadcast() {
  // The image is checked before the flash is erased.
  const auto key = image::decode_key(receiver_.image());
  const image::Error error = key ? check_key(*key) : slots_.check(receiver_.image());
  if (error != image::Error::none) {
    status_ = status_of(error);
    receiver_.set_state(ReceiverState::refused, static_cast<std::uint8_t>(error));
    return;
  }
  if (!ports_.flash.is_supplied()) {
    status_ = object::status_other_error;
    receiver_.set_state(ReceiverState::refused, broadcast::refused_supply);
    return;
  }
  if (key) {
    receiver_.set_state(slots_.trust().append({*key, {}}) ? ReceiverState::installed : ReceiverState::failed);
    return;
  }
  const InstallResult result = write_image(receiver_.image());
  receiver_.set_state(status_ == 0 ? ReceiverState::installed : ReceiverState::failed,
                      static_cast<std::uint8_t>(result));
}

/// Whether a key may become the first one of the module.
image::Error Bootloader::check_key(const image::PublicKey& key) const {
  if (slots_.trust().read().key) {
    return image::Error::has_key;
  }
  if (now_ >= key_until_) {
    return image::Error::key_too_late;
  }
  if (slots_.trust().is_full()) {
    return image::Error::no_room_for_key;
  }
  return image::may_be_trusted(key) ? image::Error::none : image::Error::unusable_key;
}

/// Writes an image that was checked.
InstallResult Bootloader::write_image(std::span<const std::uint8_t> image) {
  const InstallResult result = slots_.install(image);
  look_at_slot();
  const bool is_installed = result == InstallResult::ok || result == InstallResult::already_there;
  status_ = is_installed ? 0 : object::status_write_error;
  return result;
}

AbortCode Bootloader::find(Address address, Entry& entry) {
  AbortCode code = AbortCode::no_such_object;
  for (const Entry& known : object::entries) {
    if (known.address == address) {
      entry = known;
      return AbortCode::none;
    }
    if (known.address.index == address.index) {
      code = AbortCode::no_such_sub_index;
    }
  }
  return code;
}

AbortCode Bootloader::read(const Entry& entry, std::uint32_t& value) {
  value = entry.default_value;
  if (entry.address == canopen::object::heartbeat_period.address) {
    value = heartbeat_period_us / 1'000;
  } else if (entry.address == canopen::object::product.address || entry.address == canopen::object::board_id.address) {
    value = place_.board_id;
  } else if (entry.address == canopen::object::update_key.address) {
    value = trust().key_id;
  } else if (entry.address == canopen::object::serial.address) {
    value = address_.back();
  } else if (entry.address == object::program_identification.address) {
    value = image_header().empty() ? 0 : crc32(image_header());
  } else if (entry.address == object::flash_status.address) {
    value = status_ | (downloaded_ != 0 ? object::status_in_progress : 0);
  }
  return AbortCode::none;
}

AbortCode Bootloader::write(const Entry& entry, std::uint32_t value) {
  if (entry.address != object::program_control.address) {
    return AbortCode::refused_by_application;  // the period of the heartbeat
  }
  if (value == object::control_start || value == object::control_reset) {
    if (downloaded_ != 0) {
      return AbortCode::refused_by_state;
    }
    leave(now_);
  }
  return AbortCode::none;
}

AbortCode Bootloader::open_write(const Entry& /*entry*/, std::optional<std::uint32_t> size) {
  // Broadcast and SDO share the buffer.
  if (receiver_.is_in_use(now_) || downloaded_ != 0) {
    return AbortCode::refused_by_state;
  }
  if (size.value_or(0) > ports_.buffer.size()) {
    return AbortCode::out_of_memory;
  }
  is_downloading_ = true;
  return AbortCode::none;
}

AbortCode Bootloader::write_part(const Entry& /*entry*/, std::uint32_t offset, std::span<const std::uint8_t> part) {
  if (offset > ports_.buffer.size() || part.size() > ports_.buffer.size() - offset) {
    return AbortCode::out_of_memory;
  }
  std::ranges::copy(part, ports_.buffer.begin() + static_cast<std::ptrdiff_t>(offset));
  return AbortCode::none;
}

AbortCode Bootloader::close_write(const Entry& /*entry*/, std::uint32_t size) {
  const image::Error error = slots_.check(ports_.buffer.first(size));
  status_ = status_of(error);
  if (error != image::Error::none) {
    return AbortCode::general_incompatibility;
  }
  is_downloading_ = false;
  downloaded_ = size;
  return AbortCode::none;
}

void Bootloader::cancel_write(const Entry& /*entry*/) { is_downloading_ = false; }

}  // namespace proleg::bootloader
