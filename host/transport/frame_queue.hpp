#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "shared/can/can_frame.hpp"

namespace proleg::host {

/// Whether a frame takes motion or power from joints: NMT other than start, and a controlword (0x6040, by RPDO1 or SDO)
/// with which a drive makes a quick stop or loses its power (CiA 402, table 27).
[[nodiscard]] bool ends_motion(const CanFrame& frame);

/// Frames that wait for a line or a controller. Those that end motion come first, in their order; then the others, in
/// theirs. An older command that would start the joint again after them is dropped.
class FrameQueue {
 public:
  static constexpr std::size_t max_others = 1'024;
  static constexpr std::size_t max_stops = 256;  ///< two for each node

  /// False if the queue is full; other frames take no room from those that end motion. Adds the frames that are
  /// dropped, this one among them, to `dropped`.
  [[nodiscard]] bool push(const CanFrame& frame, std::uint64_t& dropped);
  [[nodiscard]] bool empty() const { return stops_.empty() && others_.empty(); }
  [[nodiscard]] std::size_t size() const { return stops_.size() + others_.size(); }
  /// Whether front() ends motion.
  [[nodiscard]] bool has_stop() const { return !stops_.empty(); }
  /// The next frame; the queue must not be empty.
  [[nodiscard]] const CanFrame& front() const { return stops_.empty() ? others_.front() : stops_.front(); }
  void pop() { (stops_.empty() ? others_ : stops_).pop_front(); }
  void clear() {
    stops_.clear();
    others_.clear();
  }

 private:
  std::deque<CanFrame> stops_;
  std::deque<CanFrame> others_;
};

}  // namespace proleg::host
