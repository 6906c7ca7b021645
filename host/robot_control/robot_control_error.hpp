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

/// The robot's file is wrong: it names a plug-in that cannot be loaded, or parameters that the plug-in rejects. what()
/// begins with FILE:LINE. As an InputError, it is bad input for a program.
class RobotFileError : public RobotControlError {
 public:
  using RobotControlError::RobotControlError;
};

}  // namespace proleg::host
