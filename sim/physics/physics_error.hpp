#pragma once

#include <stdexcept>

namespace proleg::sim {

/// The physics engine failed, or its numbers are no longer finite.
class PhysicsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace proleg::sim
