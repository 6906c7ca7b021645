#pragma once

#include "firmware/module/module_identity.hpp"
#include "firmware/module/ports.hpp"
#include "shared/can/slcan_adapter.hpp"

namespace proleg::firmware {

/// Connects a host on the serial line with the bus and with the module itself, as an slcan adapter (docs/protocol.md).
///
/// What the host sends goes onto the bus behind the module's own frames, one frame at a time. When it has been sent,
/// the module receives it too, as all others do at that instant: a controller does not receive its own frames. The host
/// gets what the controller receives and what the module sends. The module itself never waits for the line.
class Gateway {
 public:
  /// Frames of the host that wait. A host that sends more gets BEL for them.
  static constexpr std::size_t queue_size = 64;
  /// While the robot moves, the host's frames leave the bus free for this time each, so that a host that sends without
  /// end takes less than a third of it. It is the gap that a master leaves for TICK (docs/protocol.md).
  static constexpr Microseconds pause_us = 300;
  /// How often the errors of the bus are reported.
  static constexpr Microseconds error_period_us = 100'000;

  /// What the module allows the line to do now.
  struct Conditions {
    bool has_own_frames = false;  ///< frames of the module wait for a mailbox
    bool is_operational = false;
  };

  Gateway(const ModuleIdentity& identity, const Ports& ports);
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  /// No gateway, until set_role().
  void power_on();
  /// A channel that is open stays open if the role does not change.
  void set_role(bool is_gateway);
  [[nodiscard]] bool is_active() const { return is_active_; }

  /// A frame that the host must see: it was received, or the module has sent it.
  void pass(Microseconds now, const CanFrame& frame);
  /// The controller has sent a frame. Whether it came from the host, so that the module must receive it.
  [[nodiscard]] bool confirm(Microseconds now, const CanFrame& frame);
  /// The controller has dropped its frames, and takes none until bus_back().
  void bus_off();
  void bus_back() { is_bus_off_ = false; }
  /// Received frames were lost.
  void frames_lost() { errors_.add(CanErrorKind::receive_overrun); }

  /// Does what is due for the line. True: it has more to read, and wants to be called again soon.
  bool serve(Microseconds now, const Conditions& conditions);
  /// Later than the `now` of the last serve(), if nothing else was called since.
  [[nodiscard]] Microseconds next_deadline() const;

  [[nodiscard]] const SlcanAdapter::Counters& counters() const { return adapter_.counters(); }
  /// Frames that the host did not get, because it had sent or received too much for the line.
  [[nodiscard]] std::uint32_t frames_not_written() const {
    return counters().frames_dropped + counters().state_frames_dropped;
  }
  /// Lines of the host that were not understood, or damaged.
  [[nodiscard]] std::uint32_t wrong_lines() const { return counters().lines_rejected; }
  /// Frames of the host that did not reach the bus.
  [[nodiscard]] std::uint32_t frames_not_sent() const { return counters().frames_refused + discarded_; }

 private:
  /// The output of the adapter: 20 ms of the line.
  static constexpr std::size_t buffer_size = 2048;
  /// Read at once: less than the program needs for a tick.
  static constexpr std::size_t max_read = 64;

  /// Where the adapter sends the frames of the host.
  class Entrance final : public CanPort {
   public:
    explicit Entrance(Gateway& gateway) : gateway_(gateway) {}
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
  Entrance entrance_{*this};
  SlcanAdapter adapter_;
  std::array<CanFrame, queue_size> queue_{};
  std::size_t first_ = 0;  ///< the oldest frame
  std::size_t size_ = 0;   ///< frames in the queue; the first one may be in a mailbox
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
