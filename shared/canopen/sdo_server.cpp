#include "shared/canopen/sdo_server.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/sdo_frame.hpp"

namespace proleg::canopen {
namespace {

AbortCode upload(std::uint8_t node, const Entry& object, ObjectAccess& device, std::uint32_t& value) {
  if (const std::optional<std::uint32_t> fixed = fixed_value(object, node)) {
    value = *fixed;
    return AbortCode::none;
  }
  return device.read(object, value);
}

AbortCode download(const CanFrame& request, const Entry& object, ObjectAccess& device) {
  if (object.access == Access::by_pdo) {
    return AbortCode::unsupported_access;
  }
  if (object.access != Access::read_write) {
    return AbortCode::read_only;
  }
  const std::uint8_t size = sdo::indicated_size(request.data[0]);
  if (size != 0 && size != size_of(object.type)) {
    return AbortCode::wrong_length;
  }
  const std::uint32_t value = extend(object.type, sdo::data(request));
  const AbortCode code = check_range(object, value);
  return code == AbortCode::none ? device.write(object, value) : code;
}

/// Initiation of an expedited download: 0x22 without the size, or 0x23, 0x27, 0x2B, 0x2F with it.
bool is_expedited_download(std::uint8_t command) {
  return command == (sdo::request_download | sdo::expedited) ||
         (command & ~0x0CU) == (sdo::request_download | sdo::expedited | sdo::size_indicated);
}

}  // namespace

std::optional<CanFrame> serve_sdo(std::uint8_t node, const CanFrame& request, ObjectAccess& device) {
  if (request.identifier != identifier::sdo_request + node || request.length != 8 ||
      sdo::specifier(request) == sdo::abort) {
    return std::nullopt;
  }
  const auto answer = static_cast<std::uint16_t>(identifier::sdo_answer + node);
  const Address address = sdo::address(request);
  const auto refuse = [&](AbortCode code) {
    return sdo::make(answer, sdo::abort, address, 4, static_cast<std::uint32_t>(code));
  };

  const bool writes = is_expedited_download(request.data[0]);
  if (!writes && request.data[0] != sdo::request_upload) {
    return refuse(AbortCode::unknown_command);
  }
  const std::optional<Entry> object = find_entry(address);
  if (!object) {
    return refuse(index_exists(address.index) ? AbortCode::no_such_sub_index : AbortCode::no_such_object);
  }
  if (writes) {
    const AbortCode code = download(request, *object, device);
    return code == AbortCode::none ? sdo::make(answer, sdo::answer_download, address) : refuse(code);
  }
  std::uint32_t value = 0;
  const AbortCode code = upload(node, *object, device, value);
  if (code != AbortCode::none) {
    return refuse(code);
  }
  const std::uint8_t size = size_of(object->type);
  return sdo::make(answer, sdo::with_size(sdo::answer_upload, size), address, size, value);
}

}  // namespace proleg::canopen
