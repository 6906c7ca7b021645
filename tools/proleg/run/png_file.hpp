#pragma once

#include <string>

namespace proleg::tools {

/// An SVG picture as PNG, two pixels for each of its own, made by librsvg's rsvg-convert if it is installed. Throws
/// BadInput that names the Debian package if it is not, and std::runtime_error if it fails.
[[nodiscard]] std::string png_of(const std::string& svg);

}  // namespace proleg::tools
