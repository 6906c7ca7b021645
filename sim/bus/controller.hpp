#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/can/can_port.hpp"
#include "sim/bus/fault_confinement.hpp"

namespace proleg::sim {

/// True time, in nanoseconds since the start of the simulation.
using BusTime = std::uint64_t;
/// An event that never comes.
inline constexpr BusTime never_on_bus = ~BusTime{0};

/// What a controller tells its node: at the end of the last bit of end of frame, or of an error frame. All may send,
/// abort and switch controllers on and off; none may advance the bus.
class BusListener {
 public:
  virtual void received(BusTime time, const CanFrame& frame) = 0;
  /// Controller::sent_mailbox() had it.
  virtual void transmitted(BusTime time, const CanFrame& frame) = 0;
  /// An error frame ended. The counters and last_error() of the controller have it; a frame that the controller was
  /// sending (sent_mailbox()) will be sent again, or has left its mailbox if it is sent once only or was withdrawn.
  virtual void error_seen(BusTime /*time*/, bool /*was_sending*/) {}
  /// Controller::error_state() is another one now. Comes after received, transmitted or error_seen.
  virtual void error_state_changed(BusTime /*time*/) {}
  /// The controller has seen the 11 recessive bits that it asked for with Controller::join(), and takes part.
  virtual void joined(BusTime /*time*/) {}
  /// For controllers with watch(true): a frame begins, which the controller may also have lost the arbitration to. Only
  /// here nobody may send, abort or switch.
  virtual void frame_began(BusTime /*time*/) {}

 protected:
  ~BusListener() = default;
};

class Bus;

/// The CAN controller of a node: three transmit mailboxes, as bxCAN has; what is received goes to the listener at once.
///
/// Errors are confined as ISO 11898-1 demands: a frame that meets an error is sent again, in a new arbitration; a node
/// that fails too often becomes error-passive and at last leaves the bus. Simplified: an error is seen by all nodes in
/// one bit (of receivers, none was the first, whose counter would rise by 8 more), there are no overload frames, and
/// the counters change at the end of the error frame.
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
    silent,     ///< hears, but neither sends nor acknowledges
    loop_back,  ///< sends, without need of an acknowledgement; hears and acknowledges nothing
  };

  Controller(Bus& bus, BusListener& listener, std::size_t index) : listener_(&listener), bus_(&bus), index_(index) {}
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  /// Asks for a frame to be sent. False if all mailboxes are full or the controller takes no part in the bus. A mailbox
  /// is free again when the listener hears that its frame was transmitted. Throws std::invalid_argument for a frame
  /// that CAN does not have.
  [[nodiscard]] bool send(const CanFrame& frame) override;
  /// The same with a given mailbox, 0 to 2; false also if that one is not empty.
  [[nodiscard]] bool send(std::size_t mailbox, const CanFrame& frame);
  /// Withdraws all frames whose transmission has not begun (reset of the module). One that is on the wire finishes and
  /// is reported as transmitted, unless it meets an error: then it is not sent again.
  void abort_all();
  /// The same with one mailbox. Whether it is empty now; else its frame is on the wire.
  bool abort(std::size_t mailbox);

  /// Power off: as abort_all(), and nothing is sent, received or reported until power is back. A frame that is on the
  /// wire finishes. (In a real bus it would end in an error frame.)
  void switch_off();
  /// Power on, which is the state after attaching: error counters are 0. The frame that is on the wire at that time is
  /// not heard. Nothing if it is on.
  void switch_on();
  /// Power on as it really goes: takes part after 11 recessive bits, when the listener hears joined(). The error
  /// counters are what they were before, and bus-off is still bus-off. Nothing if it is on.
  void join();
  [[nodiscard]] bool is_on() const { return presence_ == Presence::on; }

  [[nodiscard]] ErrorState error_state() const { return errors_.state(); }
  [[nodiscard]] unsigned transmit_errors() const { return errors_.transmit_errors(); }
  [[nodiscard]] unsigned receive_errors() const { return errors_.receive_errors(); }
  /// None after a frame without an error.
  [[nodiscard]] CanError last_error() const { return last_error_; }
  /// In bus-off: comes back, with counters of 0, after 128 times 11 recessive bits, and reports error_state_changed().
  /// In bus-off all mailboxes are empty and nothing is sent, received or acknowledged. Elsewhere it changes nothing.
  void recover() override;
  /// Counters of 0, at once and without a report: reset of the node. Only while it is off.
  void forget_errors();

  void set_order(Order order);
  void set_role(Role role);
  /// Whether a frame is tried once only: it leaves its mailbox also with an error or, if the controller watches the
  /// bus, a lost arbitration.
  void set_one_shot(bool one_shot) { one_shot_ = one_shot; }
  /// Whether the listener hears frame_began(), also while the controller is off.
  void watch(bool watch);

  [[nodiscard]] std::size_t free_mailboxes() const;
  /// Whether the mailbox, 0 to 2, holds no request, waiting or on the wire.
  [[nodiscard]] bool is_empty(std::size_t mailbox) const { return mailboxes_.at(mailbox).state == MailboxState::empty; }
  /// Mailbox that was, or is, on the wire last.
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
  /// After a change of presence, error state or role.
  void update_part();
  /// The transmission of sent_mailbox_ has failed.
  void take_back();
  [[nodiscard]] bool took_part_since(BusTime time) const { return takes_part_ && part_since_ <= time; }

  // The bus looks at these of every controller with every frame.
  BusListener* listener_;
  Mailbox* candidate_ = nullptr;  ///< takes part in the next arbitration
  std::uint64_t last_sent_ = 0;   ///< number of the transmission that the controller sent last
  BusTime part_since_ = 0;        ///< takes part since
  BusTime suspended_until_ = 0;   ///< may start no frame before
  bool takes_part_ = true;        ///< on and not in bus-off
  bool hears_ = true;             ///< takes part and does not loop back
  bool acknowledges_ = true;      ///< hears and is not silent

  bool one_shot_ = false;
  bool watches_ = false;
  Presence presence_ = Presence::on;
  Role role_ = Role::normal;
  Order order_ = Order::identifier_then_request;
  Bus* bus_;
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
