#include "shared/canopen/object.hpp"

namespace proleg::canopen {

std::string_view describe(AbortCode code) {
  switch (code) {
    case AbortCode::none:
      return "ok";
    case AbortCode::toggle_not_alternated:
      return "toggle bit not alternated";
    case AbortCode::timeout:
      return "no answer";
    case AbortCode::unknown_command:
      return "kind of transfer not supported";
    case AbortCode::invalid_block_size:
      return "invalid block size";
    case AbortCode::invalid_sequence_number:
      return "invalid sequence number";
    case AbortCode::crc_error:
      return "checksum differs";
    case AbortCode::out_of_memory:
      return "out of memory";
    case AbortCode::unsupported_access:
      return "access not supported";
    case AbortCode::write_only:
      return "object is write-only";
    case AbortCode::read_only:
      return "object is read-only";
    case AbortCode::no_such_object:
      return "no such object";
    case AbortCode::not_mappable:
      return "object cannot be mapped to a PDO";
    case AbortCode::pdo_too_long:
      return "mapped objects exceed the length of the PDO";
    case AbortCode::general_incompatibility:
      return "parameters are incompatible";
    case AbortCode::internal_incompatibility:
      return "incompatible inside the device";
    case AbortCode::hardware_error:
      return "access failed because of a hardware error";
    case AbortCode::wrong_length:
      return "wrong length";
    case AbortCode::too_long:
      return "value is too long";
    case AbortCode::too_short:
      return "value is too short";
    case AbortCode::no_such_sub_index:
      return "no such sub-index";
    case AbortCode::out_of_range:
      return "value out of range";
    case AbortCode::above_maximum:
      return "value above the maximum";
    case AbortCode::below_minimum:
      return "value below the minimum";
    case AbortCode::maximum_below_minimum:
      return "maximum is below the minimum";
    case AbortCode::no_connection:
      return "no SDO connection is free";
    case AbortCode::general_error:
      return "general error";
    case AbortCode::refused_by_application:
      return "refused by the application";
    case AbortCode::refused_by_local_control:
      return "refused because of local control";
    case AbortCode::refused_by_state:
      return "refused in the present state of the device";
    case AbortCode::no_dictionary:
      return "no object dictionary";
    case AbortCode::no_data:
      return "no data available";
  }
  return "unknown abort code";
}

}  // namespace proleg::canopen
