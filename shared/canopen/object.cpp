#include "shared/canopen/object.hpp"

namespace proleg::canopen {

std::string_view describe(AbortCode code) {
  switch (code) {
    case AbortCode::none:
      return "ok";
    case AbortCode::timeout:
      return "no answer";
    case AbortCode::unknown_command:
      return "kind of transfer not supported";
    case AbortCode::out_of_memory:
      return "out of memory";
    case AbortCode::unsupported_access:
      return "access not supported";
    case AbortCode::read_only:
      return "object is read-only";
    case AbortCode::no_such_object:
      return "no such object";
    case AbortCode::general_incompatibility:
      return "parameters are incompatible";
    case AbortCode::wrong_length:
      return "wrong length";
    case AbortCode::no_such_sub_index:
      return "no such sub-index";
    case AbortCode::out_of_range:
      return "value out of range";
    case AbortCode::above_maximum:
      return "value above the maximum";
    case AbortCode::below_minimum:
      return "value below the minimum";
    case AbortCode::general_error:
      return "general error";
    case AbortCode::refused_by_application:
      return "refused by the application";
    case AbortCode::refused_by_state:
      return "refused in the present state of the device";
  }
  return "unknown abort code";
}

}  // namespace proleg::canopen
