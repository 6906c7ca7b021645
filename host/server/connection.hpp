#pragma once

namespace proleg::host {

/// A connection of a browser or program. It exists as long as one of its handlers.
class Connection {
 public:
  virtual ~Connection() = default;
  /// Sends the pending output, if nothing is being sent.
  virtual void pump() {}
  /// Ends the connection in an orderly way, if the other end permits it.
  virtual void end() = 0;
  virtual void end_by_force() = 0;
};

}  // namespace proleg::host
