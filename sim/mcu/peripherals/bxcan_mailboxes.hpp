#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "shared/can/can_frame.hpp"

namespace proleg::sim {

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

}  // namespace proleg::sim
