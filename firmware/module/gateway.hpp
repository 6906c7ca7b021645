#pragma once

#include "firmware/module/module_identity.hpp"
#include "firmware/module/ports.hpp"
#include "shared/can/slcan_adapter.hpp"

namespace proleg::firmware {

/// Connects a host on the serial line with the bus and with the module itself, as an slcan adapter (docs/protocol.md).
///
/// Frames of the host are sent on the bus after the module's own frames, one at a time. When a frame has been sent, the
/// module receives it at the same time as all others: a controller does not receive its own frames. The host receives
/// the frames that the controller receives and those that the module sends. The module never waits for the line.
class Gateway {
 public:
  /// Greatest number of frames of the host that wait. A host that sends more gets BEL for them.
  static constexpr std::size_t queue_size = 64;
  /// Time for which the bus stays free after each frame of the host while the robot moves, so that a host that always
  /// sends takes less than a third of the bus. It is the gap that a master leaves for TICK (docs/protocol.md).
  static constexpr Microseconds pause_us = 300;
  /// Time between two reports of errors of the bus.
  static constexpr Microseconds error_period_us = 100'000;

  /// Conditions under which the line is served.
  struct Conditions {
    bool has_own_frames = false;  ///< whether frames of the module wait for a mailbox
    bool is_operational = false;
  };

  Gateway(const ModuleIdentity& identity, const Ports& ports);
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  /// Starts without the role of gateway, until set_role().
  void power_on();
  /// Sets the role. A channel that is open stays open if the role does not change.
  void set_role(bool is_gateway);
  [[nodiscard]] bool is_active() const { return is_active_; }

  /// Passes a frame to the host. It was received, or the module has sent it.
  void pass(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller has sent a frame. Returns whether it came from the host, so that the module
  /// must receive it.
  [[nodiscard]] bool confirm(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller has dropped its frames, and takes none until bus_back().
  void bus_off();
  void bus_back() { is_bus_off_ = false; }
  /// Must be called when received frames were lost.
  void frames_lost() { errors_.add(CanErrorKind::receive_overrun); }

  /// Does what is due for the line. True if the line has more to read: call it again soon.
  bool serve(Microseconds now, const Conditions& conditions);
  /// Time of the next serve(). It is later than the `now` of the last one, if nothing else was called since.
  [[nodiscard]] Microseconds next_deadline() const;

  [[nodiscard]] const SlcanAdapter::Counters& counters() const { return adapter_.counters(); }
  /// Number of frames that the host did not get, because it had sent or received too much for the line.
  [[nodiscard]] std::uint32_t frames_not_written() const {
    return counters().frames_dropped + counters().state_frames_dropped;
  }
  /// Number of lines of the host that were not understood, or damaged.
  [[nodiscard]] std::uint32_t wrong_lines() const { return counters().lines_rejected; }
  /// Number of frames of the host that were not sent on the bus.
  [[nodiscard]] std::uint32_t frames_not_sent() const { return counters().frames_refused + discarded_; }

 private:
  /// Size of the adapter's output: 20 ms of the line.
  static constexpr std::size_t buffer_size = 2048;
  /// Greatest number of characters that are read at once: the adapter handles them faster than the program computes a
  /// tick.
  static constexpr std::size_t max_read = 64;

  /// The bus as the adapter sees it: it takes the frames of the host.
  class HostPort final : public CanPort {
   public:
    explicit HostPort(Gateway& gateway) : gateway_(gateway) {}
    [[nodiscard]] bool send(const CanFrame& frame) override { return gateway_.enqueue(frame); }

   private:
    Gateway& gateway_;
  };

  [[nodiscard]] bool enqueue(const CanFrame& frame);
  void discard_frames();
  [[nodiscard]] bool read_line();
  void follow_channel();
  void report_bus(Microseconds now);
  void send_frame(Microseconds now, const Conditions& conditions);
  void write_line();

  CanPort& can_;
  LinePort* line_;
  std::array<char, buffer_size> buffer_{};
  HostPort host_port_{*this};
  SlcanAdapter adapter_;
  std::array<CanFrame, queue_size> queue_{};
  std::size_t first_ = 0;  ///< position of the oldest frame
  std::size_t size_ = 0;   ///< number of frames in the queue; the first one may be in a mailbox
  bool is_in_mailbox_ = false;
  bool is_active_ = false;
  bool was_open_ = false;
  bool is_bus_off_ = false;
  Microseconds pause_end_ = 0;
  Microseconds next_error_report_ = 0;
  CanErrors errors_;
  CanStatus status_;
  std::uint32_t discarded_ = 0;
};

}  // namespace proleg::firmware
