#include "firmware/module/device_objects.hpp"

#include "firmware/module/abort_code.hpp"

namespace proleg::firmware {
namespace {

using canopen::AbortCode;
using canopen::NmtState;

/// The row of a declared entry and the entry's place in it; or why there is none.
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
    first = row->first.address;
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

}  // namespace

AbortCode read_object(std::span<const ObjectAccessor> accessors, const Parts& parts, canopen::Address address,
                      std::uint32_t& value) {
  const Found found = find(accessors, parts.joint, address);
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

void DeviceObjects::serve(Microseconds now, const CanFrame& request) {
  now_ = now;
  if (const std::optional<CanFrame> reply = canopen::serve_sdo(parts_.identity.node, request, *this)) {
    parts_.outbox.send(*reply);
  }
}

AbortCode DeviceObjects::read(const canopen::Entry& object, std::uint32_t& value) {
  return read_object(object_accessors(), parts_, object.address, value);
}

AbortCode DeviceObjects::write(const canopen::Entry& object, std::uint32_t value) {
  return write_object(object_accessors(), parts_, object.address, value, now_);
}

}  // namespace proleg::firmware
