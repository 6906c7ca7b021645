#pragma once

// The CAN controller of a node, with its fault confinement (ISO 11898-1:2003, clause 13; Bosch CAN 2.0, part B,
// section 8).

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/can/can_port.hpp"

namespace proleg::sim {

enum class ErrorState : std::uint8_t {
  active,   ///< signals errors with a dominant flag
  passive,  ///< a counter is above 127: signals recessively, and waits 8 bits after each of its frames
  bus_off,  ///< the transmit error counter is above 255: takes no part in the bus
};

/// The last error, with the numbers of bxCAN's ESR.LEC (RM0090, 32.9.2).
enum class CanError : std::uint8_t {
  none = 0,
  stuff = 1,
  form = 2,
  acknowledgement = 3,
  bit_recessive = 4,  ///< recessive sent, dominant seen
  bit_dominant = 5,   ///< dominant sent, recessive seen
  crc = 6,
};

/// The two counters of a node and what follows from them.
class ErrorCounters {
 public:
  /// 0 to 255; 256 and more is bus-off, after which both stay until reset().
  [[nodiscard]] unsigned transmit_errors() const { return transmit_; }
  /// 0 to 135. ISO does not define the count above 128; like bxCAN this one stops above 127.
  [[nodiscard]] unsigned receive_errors() const { return receive_; }
  [[nodiscard]] ErrorState state() const;

  /// Rule c: an error while transmitting: +8.
  void transmitter_error();
  /// Rule a: an error while receiving: +1.
  void receiver_error();
  /// Rule g: a frame was transmitted: -1, not below 0.
  void transmitted();
  /// Rule h: a frame was received: -1, not below 0; a counter above 127 becomes 127 (ISO: 119 to 127).
  void received();
  /// Sets both counters to 0, as after power-on and after bus-off.
  void reset() { transmit_ = receive_ = 0; }

 private:
  unsigned transmit_ = 0;
  unsigned receive_ = 0;
};

/// True time, in nanoseconds since the start of the simulation.
using BusTime = std::uint64_t;
/// The time of an event that never happens.
inline constexpr BusTime never_on_bus = ~BusTime{0};

/// What a controller reports to its node, at the end of the last bit of end of frame or of an error frame. All
/// functions may send, abort and switch controllers on and off; none may advance the bus.
class BusListener {
 public:
  virtual void received(BusTime time, const CanFrame& frame) = 0;
  /// The frame was in Controller::sent_mailbox().
  virtual void transmitted(BusTime time, const CanFrame& frame) = 0;
  /// An error frame ended. The counters and last_error() of the controller include it. A frame that the controller was
  /// sending (sent_mailbox()) will be sent again, or has left its mailbox if it is one-shot or was withdrawn.
  virtual void error_seen(BusTime /*time*/, bool /*was_sending*/) {}
  /// Controller::error_state() has changed. Called after received, transmitted or error_seen.
  virtual void error_state_changed(BusTime /*time*/) {}
  /// After Controller::join(): the controller has seen 11 recessive bits and takes part.
  virtual void joined(BusTime /*time*/) {}
  /// For controllers with watch(true): a frame begins; the controller may have lost the arbitration to it. This
  /// function alone may not send, abort or switch.
  virtual void frame_began(BusTime /*time*/) {}

 protected:
  ~BusListener() = default;
};

class Controller;

/// What a controller uses of its bus.
class ControllerBus {
 public:
  /// The time up to which the bus has been simulated.
  [[nodiscard]] virtual BusTime now() const = 0;
  /// A controller has a frame to send, or has none any more.
  virtual void candidates_changed(bool had_one, bool has_one) = 0;
  /// A controller waits for sequences of 11 recessive bits; then the bus lets it join or leave bus-off.
  virtual void begin_wait(Controller& controller, unsigned sequences) = 0;
  virtual void end_wait(const Controller& controller) = 0;
  /// The frame on the wire, if there is one, ends here with an error.
  virtual void destroy_frame() = 0;
  /// From now on error counters may differ from 0.
  virtual void begin_counting() = 0;
  /// Calls the listeners of all controllers whose error state has changed.
  virtual void report_states() = 0;
  virtual void watch_changed(bool watched, bool watches) = 0;

 protected:
  ~ControllerBus() = default;
};

/// The CAN controller of a node: three transmit mailboxes, as bxCAN has; received frames go to the listener at once.
///
/// Errors are confined as ISO 11898-1 demands: a frame that meets an error is sent again, in a new arbitration; a node
/// that fails too often becomes error-passive and at last leaves the bus. Simplified: all nodes see an error in the
/// same bit (so no receiver is the first, whose counter would rise by 8 more), there are no overload frames, and the
/// counters change at the end of the error frame.
class Controller final : public CanPort {
 public:
  static constexpr std::size_t mailbox_count = 3;

  /// Which of its mailboxes a controller sends first.
  enum class Order : std::uint8_t {
    identifier_then_request,  ///< the lowest identifier, equal ones in the order of the requests
    identifier_then_mailbox,  ///< equal ones by the number of the mailbox (bxCAN with TXFP = 0)
    request,                  ///< in the order of the requests (bxCAN with TXFP = 1)
  };
  enum class Role : std::uint8_t {
    normal,
    silent,     ///< receives, but neither sends nor acknowledges
    loop_back,  ///< sends and needs no acknowledgement; receives and acknowledges nothing
  };

  Controller(ControllerBus& bus, BusListener& listener, std::size_t index)
      : listener_(&listener), bus_(&bus), index_(index) {}
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  /// Requests that a frame is sent. False if all mailboxes are full or the controller takes no part in the bus. A
  /// mailbox is free again when the listener's transmitted() is called. Throws std::invalid_argument for a frame that
  /// CAN does not have.
  [[nodiscard]] bool send(const CanFrame& frame) override;
  /// Requests that a mailbox, 0 to 2, sends a frame. False if it is not empty or the controller is not on the bus.
  [[nodiscard]] bool send(std::size_t mailbox, const CanFrame& frame);
  /// Withdraws all frames whose transmission has not begun (reset of the module). One that is on the wire finishes and
  /// is reported as transmitted, unless it meets an error: then it is not sent again.
  void abort_all();
  /// Withdraws the frame of a mailbox. True if the mailbox is empty now; else its frame is on the wire.
  bool abort(std::size_t mailbox);

  /// Power off: as abort_all(), and nothing is sent, received or reported until power is back. A frame that is on the
  /// wire finishes. (In a real bus it would end in an error frame.)
  void switch_off();
  /// Power on, which is the state after attaching: error counters are 0. The controller does not receive the frame that
  /// is on the wire at that time. No effect if it is on.
  void switch_on();
  /// Power on as on a real bus: takes part after 11 recessive bits, when the listener's joined() is called. The error
  /// counters and bus-off remain as they were. No effect if it is on.
  void join();
  [[nodiscard]] bool is_on() const { return presence_ == Presence::on; }

  [[nodiscard]] ErrorState error_state() const { return errors_.state(); }
  [[nodiscard]] unsigned transmit_errors() const { return errors_.transmit_errors(); }
  [[nodiscard]] unsigned receive_errors() const { return errors_.receive_errors(); }
  /// CanError::none after a frame without an error.
  [[nodiscard]] CanError last_error() const { return last_error_; }
  /// Disconnects the node's wires from the bus, or connects them again. A frame on the wire that it sends is destroyed.
  /// A disconnected node keeps its frames and gets no acknowledgement for them, so it comes back error-passive if it
  /// had any. (Simplified: it does not disturb the frame on the wire when it is connected.)
  void unplug();
  void plug_in();
  /// In bus-off: returns to the bus, with counters of 0, after 128 times 11 recessive bits, and calls
  /// error_state_changed(). In bus-off all mailboxes are empty, and the controller sends, receives and acknowledges
  /// nothing. In other states recover() has no effect.
  void recover() override;
  /// Reset of the node: sets the error counters to 0, at once and without a report. Only while it is off.
  void reset_errors();

  void set_order(Order order);
  void set_role(Role role);
  /// Whether a frame is tried once only: it also leaves its mailbox after an error or, if the controller watches the
  /// bus, after a lost arbitration.
  void set_one_shot(bool one_shot) { one_shot_ = one_shot; }
  /// Whether the listener's frame_began() is called, also while the controller is off.
  void watch(bool watch);

  [[nodiscard]] std::size_t free_mailboxes() const;
  /// Whether the mailbox, 0 to 2, holds no request, waiting or on the wire.
  [[nodiscard]] bool is_empty(std::size_t mailbox) const { return mailboxes_.at(mailbox).state == MailboxState::empty; }
  /// The last mailbox that was on the wire, or is now.
  [[nodiscard]] std::size_t sent_mailbox() const { return sent_mailbox_; }
  [[nodiscard]] bool is_sending() const;
  /// For frame_began(): mailbox that lost the arbitration to this frame; mailbox_count if none did.
  [[nodiscard]] std::size_t outbid_mailbox() const { return outbid_mailbox_; }
  /// Position in the order of attachment, from 0.
  [[nodiscard]] std::size_t index() const { return index_; }

 private:
  friend class Bus;

  enum class MailboxState : std::uint8_t { empty, pending, on_wire, withdrawn_on_wire };
  struct Mailbox {
    CanFrame frame;
    unsigned bits = 0;          ///< frame_bits()
    std::uint64_t request = 0;  ///< counts up
    MailboxState state = MailboxState::empty;
  };
  enum class Presence : std::uint8_t { off, joining, on };

  [[nodiscard]] bool precedes(const Mailbox& left, const Mailbox& right) const;
  void choose_candidate();
  /// Updates the controller's part after a change of presence, error state or role.
  void update_part();
  /// The transmission of sent_mailbox_ has failed.
  void take_back();
  /// Whether it takes requests: on and not in bus-off.
  [[nodiscard]] bool accepts_requests() const {
    return presence_ == Presence::on && error_state() != ErrorState::bus_off;
  }
  [[nodiscard]] bool took_part_since(BusTime time) const { return takes_part_ && part_since_ <= time; }

  // The bus reads these of every controller with every frame.
  BusListener* listener_;
  Mailbox* candidate_ = nullptr;  ///< takes part in the next arbitration
  std::uint64_t last_sent_ = 0;   ///< number of the transmission that the controller sent last
  BusTime part_since_ = 0;        ///< when it began to take part
  BusTime suspended_until_ = 0;   ///< it may not start a frame before this
  bool takes_part_ = true;        ///< on, plugged in and not in bus-off
  bool receives_ = true;          ///< takes part and does not loop back
  bool acknowledges_ = true;      ///< receives and is not silent

  bool one_shot_ = false;
  bool watches_ = false;
  bool plugged_in_ = true;
  Presence presence_ = Presence::on;
  Role role_ = Role::normal;
  Order order_ = Order::identifier_then_request;
  ControllerBus* bus_;
  std::size_t index_;
  std::array<Mailbox, mailbox_count> mailboxes_;
  std::uint64_t requests_ = 0;
  std::size_t sent_mailbox_ = 0;
  std::size_t outbid_mailbox_ = mailbox_count;
  ErrorCounters errors_;
  CanError last_error_ = CanError::none;
  ErrorState reported_state_ = ErrorState::active;
};

}  // namespace proleg::sim
