#pragma once

// A request of an LSS master (CiA 305) and the answers to it.
//
// Several modules may answer a request, one after the other. An exchange therefore ends when no more answers came for a
// while, so that a late one is not taken for the answer to the next request.

#include "shared/can/can_port.hpp"
#include "shared/canopen/lss_frame.hpp"

namespace proleg::canopen {

/// The request by which all modules stop waiting for configuration.
[[nodiscard]] constexpr CanFrame lss_release_request() {
  return lss::make(identifier::lss_request, lss::Service::switch_state_global,
                   static_cast<std::uint8_t>(lss::State::waiting));
}

class LssExchange {
 public:
  /// Frames that are an answer to the request.
  struct Answer {
    std::uint16_t identifier;
    std::uint8_t length;
    std::uint8_t first_byte;
  };
  static constexpr Answer of(lss::Service service) {
    return {identifier::lss_answer, CanFrame::max_length, static_cast<std::uint8_t>(service)};
  }
  static Answer boot_up_of(std::uint8_t node) {
    const CanFrame frame = encode(Heartbeat{node, NmtState::boot_up});
    return {frame.identifier, frame.length, frame.data[0]};
  }

  /// send_timeout_us: for a frame that no node acknowledges. settle_us: time without a frame after an answer.
  LssExchange(CanPort& port, Microseconds send_timeout_us, Microseconds settle_us)
      : port_(port), send_timeout_us_(send_timeout_us), settle_us_(settle_us) {}

  /// Begins an exchange. wait_us: time for an answer, after the request was sent.
  void begin(Microseconds now, const CanFrame& request, const Answer& answer, Microseconds wait_us);
  /// Begins an exchange with a request without an answer: it ends when the request was sent.
  void begin(Microseconds now, const CanFrame& request) { begin(now, request, {}, 0); }
  /// Ends the exchange: frames from now on do not belong to one.
  void cancel() { deadline_ = never; }

  void receive(Microseconds now, const CanFrame& frame);
  void transmitted(Microseconds now, const CanFrame& frame);

  [[nodiscard]] Microseconds deadline() const { return deadline_; }
  [[nodiscard]] bool has_ended(Microseconds now) const { return now >= deadline_; }
  // Result of an exchange that has ended.
  [[nodiscard]] bool is_sent() const { return is_sent_; }
  [[nodiscard]] bool is_answered() const { return is_answered_; }
  /// Time from begin() to the first answer.
  [[nodiscard]] Microseconds answer_delay() const { return answer_delay_; }
  /// The second byte of the answer; of several answers, the first one that is not lss::ok.
  [[nodiscard]] std::uint8_t error() const { return error_; }

 private:
  void hand_over();

  CanPort& port_;
  Microseconds send_timeout_us_;
  Microseconds settle_us_;
  CanFrame request_{};
  Answer answer_{};
  Microseconds wait_us_ = 0;
  Microseconds begun_ = 0;
  Microseconds answer_delay_ = 0;
  Microseconds deadline_ = never;
  bool is_pending_ = false;  ///< the request waits for a mailbox
  bool is_sent_ = false;
  bool is_answered_ = false;
  std::uint8_t error_ = lss::ok;
};

}  // namespace proleg::canopen
