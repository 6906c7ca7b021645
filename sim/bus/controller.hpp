#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/can/can_port.hpp"

namespace proleg::sim {

/// True time, in nanoseconds since the start of the simulation.
using BusTime = std::uint64_t;
/// An event that never comes.
inline constexpr BusTime never_on_bus = ~BusTime{0};

/// What a controller tells its node, at the end of the last bit of end of frame. Both may send, abort and switch
/// controllers on and off; neither may advance the bus.
class BusListener {
 public:
  virtual void received(BusTime time, const CanFrame& frame) = 0;
  virtual void transmitted(BusTime time, const CanFrame& frame) = 0;

 protected:
  ~BusListener() = default;
};

class Bus;

/// The CAN controller of a node: three transmit mailboxes, as bxCAN has; what is received goes to the listener at once.
/// Of its mailboxes the lowest identifier is sent first, equal ones in the order of the requests. (bxCAN sends equal
/// ones by the number of the mailbox, which is the same for a driver that takes them in turn.)
///
/// This version knows no errors: every frame is sent the first time, also when nobody is there to acknowledge it. Error
/// counters, error frames, retransmission and bus-off belong into Bus::finish, which is where a transmission succeeds.
class Controller final : public CanPort {
 public:
  static constexpr std::size_t mailbox_count = 3;

  Controller(Bus& bus, BusListener& listener, std::size_t index) : bus_(&bus), listener_(&listener), index_(index) {}
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  /// Asks for a frame to be sent. False if all mailboxes are full or the controller is off. A mailbox is free again
  /// when the listener hears that its frame was transmitted. Throws std::invalid_argument for a frame that CAN does not
  /// have.
  [[nodiscard]] bool send(const CanFrame& frame) override;

  /// Withdraws all frames whose transmission has not begun (reset of the module). One that is on the wire finishes, and
  /// is reported as transmitted.
  void abort_all();

  /// Power off: as abort_all(), and nothing is sent, received or reported until power is back. A frame that is on the
  /// wire finishes. (In a real bus it would end in an error frame.)
  void switch_off();
  /// Power on, which is the state after attaching. The frame that is on the wire at that time is not heard.
  void switch_on();
  [[nodiscard]] bool is_on() const { return on_; }

  [[nodiscard]] std::size_t free_mailboxes() const;
  /// Position in the order of attachment, from 0.
  [[nodiscard]] std::size_t index() const { return index_; }

 private:
  friend class Bus;

  enum class MailboxState : std::uint8_t { empty, pending, on_wire };
  struct Mailbox {
    CanFrame frame;
    std::uint64_t request = 0;  ///< counts up
    MailboxState state = MailboxState::empty;
  };

  void choose_candidate();

  Bus* bus_;
  BusListener* listener_;
  std::size_t index_;
  std::array<Mailbox, mailbox_count> mailboxes_;
  std::uint64_t requests_ = 0;
  Mailbox* candidate_ = nullptr;  ///< takes part in the next arbitration
  bool on_ = true;
  BusTime on_since_ = 0;
  std::uint64_t last_sent_ = 0;  ///< number of the transmission that the controller sent last
};

}  // namespace proleg::sim
