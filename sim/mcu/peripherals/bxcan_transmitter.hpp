#pragma once

#include <cstddef>

#include "sim/bus/controller.hpp"
#include "sim/mcu/peripherals/bxcan_mailboxes.hpp"

namespace proleg::sim {

/// The transmit mailboxes of bxCAN on a controller of the simulated bus: hands over what is submitted, withdraws it,
/// and notes how each transmission ended.
class BxCanTransmitter {
 public:
  explicit BxCanTransmitter(Controller& controller) : controller_(&controller) {}

  [[nodiscard]] BxCanMailboxes& mailboxes() { return mailboxes_; }
  [[nodiscard]] const BxCanMailboxes& mailboxes() const { return mailboxes_; }
  void reset() { mailboxes_ = {}; }

  // Requests of the program, at bus time.
  void submit(std::size_t mailbox);
  void abort(std::size_t mailbox);
  /// Gives the controller the submitted requests, oldest first, as far as it accepts them.
  void hand_over();
  /// The controller has emptied its mailboxes: hand_over() gives it the requests again.
  void take_back() { mailboxes_.take_back(); }

  // Reports of the controller.
  void transmitted();
  /// An error frame has ended the controller's transmission. one_shot: MCR.NART.
  void failed(bool one_shot);
  /// A request that is tried once only has lost the arbitration.
  void lost_arbitration();

 private:
  Controller* controller_;
  BxCanMailboxes mailboxes_;
};

}  // namespace proleg::sim
