#pragma once

namespace proleg::host {

/// A connection of a browser or program, for as long as one of its handlers exists.
class Connection {
 public:
  virtual ~Connection() = default;
  /// Sends what there is to send, if nothing is on its way.
  virtual void pump() {}
  /// Ends in an orderly way, if the other end lets it.
  virtual void end() = 0;
  virtual void end_by_force() = 0;
};

}  // namespace proleg::host
