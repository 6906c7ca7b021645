#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace proleg::sim {

/// A mesh that cannot be used. The caller adds where it is named.
class MeshError : public std::runtime_error {
 public:
  MeshError(std::string found_text, std::string expected_text)
      : std::runtime_error(found_text), found(std::move(found_text)), expected(std::move(expected_text)) {}

  std::string found;
  std::string expected;
};

}  // namespace proleg::sim
