#pragma once

#include <stdexcept>

namespace proleg::sim {

/// A file that cannot be written or read although the request was right: a full disk, a read-only folder, a device
/// error. what() is one line: the path and what happened.
class RecordError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace proleg::sim
