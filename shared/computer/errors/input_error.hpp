#pragma once

#include <stdexcept>
#include <string>

namespace proleg {

/// Input that cannot be used. what() is the one line for the person who wrote it:
///   FILE:LINE: found ..., expected ...
/// FILE is the command-line word when the input came from there; line 0 is left out. Control characters and bytes that
/// are not UTF-8 are replaced, so the message is one printable line whatever the input held.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, int line, const std::string& found, const std::string& expected);
};

}  // namespace proleg
