#pragma once

#include <stdexcept>
#include <string>

namespace proleg {

/// Input that cannot be used. what() is one line for the person who wrote it:
///   FILE:LINE: found ..., expected ...
/// For input on the command line, FILE is the option or the argument, and the line is 0, which the message omits.
/// Control characters and bytes that are not UTF-8 are replaced, so the message is always one printable line.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, int line, const std::string& found, const std::string& expected);
};

}  // namespace proleg
