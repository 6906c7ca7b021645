#pragma once

#include <stdexcept>
#include <string>

#include "shared/computer/text/text.hpp"

namespace proleg::host {

/// A robot or its plug-in failed. what(): one line, with what to do.
class RobotControlError : public std::runtime_error {
 public:
  explicit RobotControlError(const std::string& text) : std::runtime_error(one_line(text)) {}
};

}  // namespace proleg::host
