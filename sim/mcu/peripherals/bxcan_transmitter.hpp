#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "shared/can/can_frame.hpp"
#include "sim/bus/controller.hpp"

namespace proleg::sim {

/// The requests of the program to bxCAN, in their order. A chip computes ahead of the bus: a request is pending until
/// the bus has reached its true time.
class BxCanRequests {
 public:
  enum class Kind : std::uint8_t { transmit, abort, control };
  struct Request {
    BusTime time;
    Kind kind;
    std::uint32_t value;  ///< number of the mailbox, or value of MCR
  };

  /// Adds a request. A request that is earlier than the last pending one is due together with that one.
  void add(BusTime time, Kind kind, std::uint32_t value);
  /// Puts a request that was taken back to the front, due at another time. Later requests wait for it.
  void postpone(const Request& request, BusTime time);
  /// Takes the next request if it is due.
  [[nodiscard]] std::optional<Request> take_due(BusTime now);
  void clear() { pending_.clear(); }

  [[nodiscard]] bool empty() const { return pending_.empty(); }
  /// True time of the next request; never_on_bus if none is pending.
  [[nodiscard]] BusTime next_time() const { return empty() ? never_on_bus : pending_.front().time; }

 private:
  std::deque<Request> pending_;
};

/// The three transmit mailboxes of bxCAN as registers (RM0090, 32.7.1 and 32.9: TSR, TIxR to TDHxR), and the progress
/// of each request: a pending one is submitted when the bus has reached its time, and handed over while the controller
/// has it.
class BxCanMailboxes {
 public:
  static constexpr std::size_t count = 3;

  /// Bits of mailbox 0 in TSR.
  enum Outcome : std::uint32_t { rqcp = 1U << 0U, txok = 1U << 1U, alst = 1U << 2U, terr = 1U << 3U };

  struct Mailbox {
    std::uint32_t identifier = 0;  ///< TIxR without TXRQ
    std::uint32_t length = 0;      ///< TDTxR
    std::uint32_t low = 0;         ///< TDLxR
    std::uint32_t high = 0;        ///< TDHxR
    std::uint64_t request = 0;     ///< number of the request, counts up
    bool is_pending = false;       ///< TXRQ; TME is its opposite
    bool is_submitted = false;
    bool is_handed_over = false;
    bool abort_requested = false;
    std::uint32_t outcome = 0;
  };
  [[nodiscard]] Mailbox& operator[](std::size_t number) { return mailboxes_.at(number); }
  [[nodiscard]] const Mailbox& operator[](std::size_t number) const { return mailboxes_.at(number); }

  /// Value of a mailbox's register: TIxR, TDTxR, TDLxR, TDHxR are words 0 to 3.
  [[nodiscard]] std::uint32_t read(std::size_t number, std::uint32_t word) const;
  /// Writes a register. Returns the reason if the write is rejected; then no register has changed. TXRQ sets
  /// is_pending.
  [[nodiscard]] std::optional<std::string> write(std::size_t number, std::uint32_t word, std::uint32_t value);

  /// Register TSR. by_request: MCR.TXFP.
  [[nodiscard]] std::uint32_t status(bool by_request) const;
  /// Clears outcomes; returns the mailboxes whose abort is newly requested, as bits.
  [[nodiscard]] std::uint32_t write_status(std::uint32_t value);

  /// Empties a mailbox, and shows the outcome of its request in TSR.
  void complete(std::size_t number, std::uint32_t outcome);
  /// To be called when the controller has dropped all requests that were handed over.
  void take_back();
  [[nodiscard]] bool any_completed() const;

  /// Pending mailbox that goes first; nothing if none is pending.
  [[nodiscard]] std::optional<std::size_t> first(bool by_request) const;
  /// Oldest request that is submitted and not handed over.
  [[nodiscard]] std::optional<std::size_t> next_to_hand_over() const;
  [[nodiscard]] CanFrame frame(std::size_t number) const;

 private:
  [[nodiscard]] bool precedes(std::size_t left, std::size_t right, bool by_request) const;

  std::array<Mailbox, count> mailboxes_{};
  std::uint64_t requests_ = 0;
};

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
