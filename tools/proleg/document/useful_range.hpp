#pragma once

#include <cstdint>

#include "shared/gait/declaration.hpp"

namespace proleg::tools {

/// A part of the range of a parameter, in raw steps, within its limits.
struct UsefulRange {
  std::int32_t lower = 0;
  std::int32_t upper = 0;  ///< above lower, if the parameter has more than one value
};

/// The values that most users need: a slider gives them most of its way. They are a matter of use, not of the
/// algorithm, whose declaration has the values that are possible. The name and the unit of the parameter decide; for
/// others it is the whole range.
[[nodiscard]] UsefulRange useful_range(const Parameter& parameter);

}  // namespace proleg::tools
