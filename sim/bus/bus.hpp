#pragma once

// A classical CAN bus (ISO 11898-1) on virtual time: arbitration, exact durations of frames, delivery, errors.
//
// The program that drives the simulation takes turns with the bus:
//
//   const BusTime time = min(bus.next_event(), deadlines of the nodes);
//   bus.advance_to(time);          // calls listeners for frames received and transmitted; they may send
//   ...                            // nodes do what is due at `time`, and may send
//
// The bus is free 3 bits after a frame (interframe space). If frames are requested by then, the arbitration is at that
// instant, else at the instant of the first request. The bus decides it when time moves beyond the instant, so that all
// nodes that request a frame in that instant take part, in any order of calls.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "sim/bus/controller.hpp"
#include "sim/bus/frame_bits.hpp"
#include "sim/bus/recessive_waits.hpp"

namespace proleg::sim {

/// A frame that went over the wire without an error.
struct Transmission {
  BusTime start = 0;  ///< of the start-of-frame bit
  BusTime end = 0;    ///< of the last bit of end of frame: when all nodes have it
  CanFrame frame;
  std::size_t sender = 0;  ///< index of its controller; of the first one if several sent it together
};

/// What went over the bus since the start or the last Bus::start_statistics().
struct BusStatistics {
  std::uint64_t frames = 0;      ///< frames that ended
  BusTime busy = 0;              ///< time taken by frames and error frames with their interframe spaces
  BusTime period = 0;            ///< time over which these were counted
  std::uint64_t losses = 0;      ///< deliveries withheld by the loss rule
  std::uint64_t collisions = 0;  ///< see Bus::on_collision
  std::uint64_t errors = 0;      ///< error frames; what they destroyed is sent again and counts when it succeeds

  /// Share of the time in which the bus was busy, 0 to 1.
  [[nodiscard]] double load() const {
    return period == 0 ? 0.0 : static_cast<double>(busy) / static_cast<double>(period);
  }
};

class Bus final : private ControllerBus {
 public:
  static constexpr std::uint32_t max_bit_rate = 1'000'000;

  /// bit_rate: bit/s, 1 to 1,000,000; else std::invalid_argument.
  explicit Bus(std::uint32_t bit_rate = max_bit_rate);
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Adds a node's controller, switched on. It is valid as long as the bus; the listener must outlive the bus.
  Controller& attach(BusListener& listener);

  /// The controller with an index, which is its position in the order of attachment.
  [[nodiscard]] Controller& controller(std::size_t index) { return *controllers_.at(index); }

  /// The time up to which the bus has been simulated.
  [[nodiscard]] BusTime now() const override { return now_; }

  [[nodiscard]] std::uint32_t bit_rate() const { return static_cast<std::uint32_t>(bit_rate_); }

  /// When the next frame ends or the next node returns to the bus, if no frame is requested or withdrawn before;
  /// `never_on_bus` if neither will happen. If errors are possible, it may be earlier, and then no listener is called.
  [[nodiscard]] BusTime next_event() const;

  /// When the frame or error frame on the wire ends; now() if there is none.
  [[nodiscard]] BusTime busy_until() const { return sending_ ? current_.end : now_; }

  /// No listener is called for a frame before this: the end of the frame on the wire, else of the shortest frame that
  /// could start now.
  [[nodiscard]] BusTime earliest_delivery() const;

  /// Whether a listener may be called before earliest_delivery(): one that watches the begins of frames.
  [[nodiscard]] bool is_watched() const { return watchers_ > 0; }

  /// Until end_sharing() each controller may be used by a thread of its own. A thread may read now() and busy_until(),
  /// switch its controller off, reset its errors and end its watch. The result does not depend on their order.
  void begin_sharing() { is_shared_ = true; }
  void end_sharing();

  /// Lets time pass. Every frame that ends by `time`, inclusive, is reported: to its sender (or senders, in the order
  /// of attachment), then to all other controllers in the order of attachment. A time before now() changes nothing.
  /// Must not be called by a listener: std::logic_error.
  void advance_to(BusTime time);

  /// Whether a frame that was on the bus without an error is withheld from a receiver, given by the index of its
  /// controller. Empty: nothing is lost.
  using LossRule = std::function<bool(const CanFrame& frame, std::size_t receiver)>;
  void set_loss_rule(LossRule rule) { loss_rule_ = std::move(rule); }

  /// How much later than the end of the frame a receiver gets it: its driver is busy. 0: at the end. A receiver that is
  /// off when the frame is due does not get it. Empty: all are prompt.
  using DelayRule = std::function<BusTime(const CanFrame& frame, std::size_t receiver)>;
  void set_delay_rule(DelayRule rule) { delay_rule_ = std::move(rule); }

  /// Holds the wire dominant from now() on, or lets it go. No node can send meanwhile. The senders of a frame on the
  /// wire are in bus-off at once, all others error-passive (ISO 11898-1: after some 300 us; shorter times are not
  /// modelled). After the release the bus is free when 11 bits were recessive.
  void hold_dominant(bool dominant);

  /// Whether a transmission is destroyed: all nodes see its CRC delimiter dominant, a bit error for the sender and a
  /// form error for the receivers. An error frame follows at once: 6 bits of flag, 8 of delimiter, and the interframe
  /// space. The sender tries again. transmission: counts up from 1. Empty: nothing is destroyed.
  ///
  /// A frame without an acknowledgement meets an error in its ACK slot, independently of this rule. All controllers
  /// that receive a frame acknowledge it. Simplified: two controllers that send it together acknowledge each other.
  using ErrorRule = std::function<bool(const CanFrame& frame, std::uint64_t transmission)>;
  void set_error_rule(ErrorRule rule) { error_rule_ = std::move(rule); }

  /// Called for each frame when it ends without an error, before any listener.
  using FrameListener = std::function<void(const Transmission&)>;
  void set_frame_listener(FrameListener listener) { frame_listener_ = std::move(listener); }

  /// Two controllers send one identifier at the same instant. If their frames are equal in every bit they become one
  /// transmission, which both report as sent. If not, that is a fault of the network, and this is called once for
  /// every loser. CollisionRule decides what happens then.
  using CollisionReport = std::function<void(BusTime time, const CanFrame& winner, const CanFrame& loser)>;
  void on_collision(CollisionReport report) { collision_report_ = std::move(report); }

  enum class CollisionRule : std::uint8_t {
    /// The frame that has a dominant bit first wins, the other one is tried again. A real bus does not do this, but all
    /// nodes receive both frames: modules that share a node id detect it (docs/protocol.md) and stop.
    dominant_wins,
    /// As on a real bus: a bit error where the frames differ. All try again together, so they collide again and are in
    /// bus-off after 32 attempts, unless one of them withdraws its frame.
    bit_error,
  };
  void set_collision_rule(CollisionRule rule) { collision_rule_ = rule; }

  [[nodiscard]] BusStatistics statistics() const;
  /// Counts from now().
  void start_statistics();

 private:
  // What controllers use.
  void candidates_changed(bool had_one, bool has_one) override;
  void begin_wait(Controller& controller, unsigned sequences) override { waits_.add(controller, sequences, now_); }
  void end_wait(const Controller& controller) override;
  void destroy_frame() override;
  void begin_counting() override { counting_ = true; }
  void report_states() override;
  void watch_changed(bool watched, bool watches) override;

  /// A frame that a receiver gets after its end.
  struct Delayed {
    BusTime time;
    std::size_t receiver;
    CanFrame frame;
  };

  [[nodiscard]] BusTime next_delivery() const;
  [[nodiscard]] BusTime next_end_of_wait() const;
  /// The next event without delayed deliveries.
  [[nodiscard]] BusTime next_change() const;
  void deliver_delayed(BusTime time);
  void count_dominant_errors();

  /// Held by a thread that changes what controllers share.
  [[nodiscard]] std::unique_lock<std::mutex> lock() const;
  void schedule_arbitration();
  void end_waits(BusTime time);

  [[nodiscard]] BusTime duration(unsigned bits) const { return bits * std::uint64_t{1'000'000'000} / bit_rate_; }
  [[nodiscard]] Controller* winner() const;
  [[nodiscard]] bool competes(const Controller& controller) const {
    return controller.candidate_ != nullptr && controller.suspended_until_ <= arbitration_at_;
  }
  void start(BusTime time);
  /// Whether the transmission that starts meets an error; then it ends with the error frame.
  void predict_error(bool acknowledged, unsigned bits, unsigned collision_bit);
  void notify_watchers(BusTime time);
  void finish();
  void succeed();
  void fail();
  void suspend_passive_senders();
  void report();
  void report_error();
  [[nodiscard]] BusStatistics statistics_since_time_0() const;

  std::uint64_t bit_rate_;
  std::vector<std::unique_ptr<Controller>> controllers_;
  std::size_t candidates_ = 0;  ///< controllers with a frame to send
  BusTime now_ = 0;
  BusTime free_at_ = 0;                    ///< end of the last interframe space, also of the frame on the wire
  BusTime suspended_until_ = 0;            ///< the latest of the controllers'
  BusTime arbitration_at_ = never_on_bus;  ///< while a frame is on the wire: never
  bool sending_ = false;                   ///< a frame is on the wire:
  Transmission current_;
  CanError failure_ = CanError::none;  ///< the error that its senders will see
  std::vector<Controller*> senders_;
  std::uint64_t transmission_ = 0;  ///< number of the current or last one, from 1
  bool reporting_ = false;          ///< listeners are being called
  bool counting_ = false;           ///< an error has occurred, so error counters may differ from 0
  RecessiveWaits waits_;
  std::size_t watchers_ = 0;
  bool is_shared_ = false;             ///< between begin_sharing() and end_sharing()
  bool has_changed_in_share_ = false;  ///< the next arbitration may be another
  mutable std::mutex mutex_;

  bool dominant_ = false;
  std::vector<Delayed> delayed_;  ///< by time, then in the order of the frames

  LossRule loss_rule_;
  DelayRule delay_rule_;
  ErrorRule error_rule_;
  FrameListener frame_listener_;
  CollisionReport collision_report_;
  CollisionRule collision_rule_ = CollisionRule::dominant_wins;
  BusStatistics total_;  ///< since time 0; `busy` with all of the current frame
  BusStatistics mark_;   ///< statistics_since_time_0() at the start of the statistics
};

}  // namespace proleg::sim
