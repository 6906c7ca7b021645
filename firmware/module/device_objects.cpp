#include "firmware/module/device_objects.hpp"

#include <algorithm>

namespace proleg::firmware {
namespace {

using canopen::AbortCode;
using canopen::NmtState;

/// The row of a declared entry and the entry's position in it, or the reason why it is absent.
struct Found {
  AbortCode code = AbortCode::none;
  const ObjectAccessor* accessor = nullptr;
  Position position;
};

Found find(std::span<const ObjectAccessor> accessors, const JointKernel& joint, canopen::Address address) {
  canopen::Address first = address;
  Position position;
  if (const std::optional<canopen::ValueAddress> value = canopen::value_address(address)) {
    if (!joint.active()) {
      return {AbortCode::refused_by_state, nullptr, {}};
    }
    if (!joint.has_algorithm(value->slot, value->algorithm)) {
      return {abort_code_of(Status::unknown_slot), nullptr, {}};
    }
    first = first_of(value->kind);
    position = {value->number, value->slot};
  } else if (const canopen::EntryRow* row = canopen::find_row(address)) {
    first = row->first;
    position = {static_cast<std::uint16_t>(address.index - first.index),
                static_cast<std::uint16_t>(address.sub - first.sub)};
  }
  for (const ObjectAccessor& accessor : accessors) {
    if (accessor.first() == first) {
      return {AbortCode::none, &accessor, position};
    }
  }
  return {AbortCode::unsupported_access, nullptr, {}};
}

bool is_writable(const Parts& parts, WritableIn state) {
  const bool is_pre_operational = parts.network.state() == NmtState::pre_operational;
  switch (state) {
    case WritableIn::no_state:
      break;
    case WritableIn::any_state:
      return true;
    case WritableIn::configured:
      return parts.joint.active();
    case WritableIn::pre_operational:
      return is_pre_operational;
    case WritableIn::configured_and_pre_operational:
      return parts.joint.active() && is_pre_operational;
    case WritableIn::open_transaction:
      return parts.joint.has_open_transaction();
  }
  return false;
}

/// The start of the software version, which every module of this version has in front of the fingerprint of its core.
/// The compiler computes it, because flash is short.
constexpr ObjectText software_text = [] {
  ObjectText text;
  text.append("protocol ");
  text.append_decimal(canopen::protocol_version >> 8U);
  text.append('.');
  text.append_decimal(canopen::protocol_version & 0xFFU);
  text.append(", core ");
  return text;
}();

}  // namespace

AbortCode abort_code_of(Status status) {
  switch (status) {
    case Status::ok:
      return AbortCode::none;
    case Status::bad_joint_count:
    case Status::bad_local_joints:
    case Status::bad_tick_period:
    case Status::bad_group:
    case Status::too_many_broadcasts:
      return AbortCode::refused_by_application;
    case Status::bad_limits:
      return AbortCode::general_incompatibility;
    case Status::unknown_slot:  // the sub-index is the slot
    case Status::unknown_joint:
      return AbortCode::no_such_sub_index;
    case Status::unknown_parameter:
    case Status::unknown_internal_value:
      return AbortCode::no_such_object;
    case Status::out_of_range:
      return AbortCode::out_of_range;
    case Status::staging_full:
      return AbortCode::out_of_memory;
    case Status::staging_closed:
    case Status::nothing_staged:
    case Status::commit_in_the_past:
      return AbortCode::refused_by_state;
  }
  return AbortCode::general_error;
}

AbortCode read_object(std::span<const ObjectAccessor> accessors, const Parts& parts, canopen::Address address,
                      std::uint32_t& value) {
  Found found = find(accessors, parts.joint, address);
  if (address.index == canopen::object::error_history.index && address.sub > parts.emergencies.history().size()) {
    found.code = AbortCode::no_data;  // CiA 301, 7.5.2.4, demands this code
  }
  if (found.code == AbortCode::none) {
    value = found.accessor->get(parts, found.position);
  }
  return found.code;
}

AbortCode write_object(std::span<const ObjectAccessor> accessors, Parts& parts, canopen::Address address,
                       std::uint32_t value, Microseconds now) {
  const Found found = find(accessors, parts.joint, address);
  if (found.code != AbortCode::none) {
    if (found.code == abort_code_of(Status::unknown_slot)) {
      parts.joint.keep_refusal(Status::unknown_slot);
    }
    return found.code;
  }
  if (found.accessor->set == nullptr) {
    return AbortCode::unsupported_access;
  }
  if (!is_writable(parts, found.accessor->writable_in)) {
    return AbortCode::refused_by_state;
  }
  return found.accessor->set(parts, {found.position, value, now});
}

std::optional<ObjectText> read_text(const ModuleIdentity& identity, canopen::Address address) {
  ObjectText text;
  if (address == canopen::object::device_name.address) {
    text.append(canopen::object::device_name.text);
  } else if (address == canopen::object::hardware_version.address) {
    text.append("board ");
    text.append_decimal(identity.board_id);
    if ((identity.capabilities & canopen::has_no_current_sensor) != 0) {
      text.append(", no current sensor");
    }
  } else if (address == canopen::object::software_version.address) {
    text = software_text;
    text.append_hex(identity.core_fingerprint);
  } else {
    return std::nullopt;
  }
  return text;
}

void DeviceObjects::serve(Microseconds now, const CanFrame& request) {
  now_ = now;
  if (const std::optional<CanFrame> reply = server_.receive(now, request)) {
    parts_.outbox.send(*reply);
  }
  send_segments(now);
}

void DeviceObjects::send_segments(Microseconds now) {
  // One segment in a mailbox and one in the queue keep the bus busy; more would fill the queue.
  while (server_.has_segment() && parts_.outbox.is_empty()) {
    if (!parts_.outbox.send(server_.next_segment(now))) {
      return;
    }
  }
}

void DeviceObjects::poll(Microseconds now) {
  if (const std::optional<CanFrame> frame = server_.poll(now)) {
    parts_.outbox.send(*frame);
  }
}

AbortCode DeviceObjects::read(const canopen::Entry& entry, std::uint32_t& value) {
  return read_object(object_accessors(), parts_, entry.address, value);
}

AbortCode DeviceObjects::write(const canopen::Entry& entry, std::uint32_t value) {
  return write_object(object_accessors(), parts_, entry.address, value, now_);
}

AbortCode DeviceObjects::open_read(const canopen::Entry& entry, std::uint32_t& size) {
  const std::optional<ObjectText> text = read_text(parts_.identity, entry.address);
  if (!text) {
    return AbortCode::unsupported_access;
  }
  size = static_cast<std::uint32_t>(text->characters().size());
  return AbortCode::none;
}

AbortCode DeviceObjects::read_part(const canopen::Entry& entry, std::uint32_t offset, std::span<std::uint8_t> part) {
  const std::optional<ObjectText> text = read_text(parts_.identity, entry.address);
  if (!text) {
    return AbortCode::unsupported_access;
  }
  const std::span<const char> characters = text->characters().subspan(offset, part.size());
  std::copy(characters.begin(), characters.end(), part.begin());
  return AbortCode::none;
}

}  // namespace proleg::firmware
