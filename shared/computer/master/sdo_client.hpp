#pragma once

// The client of expedited SDO transfers (CiA 301, section 7.2.4.3): at most four bytes, one request, one answer. A pool
// of clients works in parallel, each through the list of transfers of one module at a time.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/can/can_port.hpp"
#include "shared/can/transmit_queue.hpp"
#include "shared/canopen/object.hpp"
#include "shared/gait/joint_mask.hpp"

namespace proleg::canopen {

/// What a host asks of a module: to read or to write an entry of its object dictionary.
struct SdoRequest {
  Address address;
  std::uint8_t size = 0;    ///< number of bytes of a write: 1, 2 or 4; 0: a read
  std::uint32_t value = 0;  ///< value of a write

  [[nodiscard]] bool is_read() const { return size == 0; }
  friend bool operator==(const SdoRequest&, const SdoRequest&) = default;
};

/// The client of a single transfer.
class SdoClient {
 public:
  static constexpr Microseconds default_timeout_us = 500'000;

  enum class State : std::uint8_t { idle, waiting, done, aborted };

  /// Begins a read. Returns the request, which must be sent on the bus. The deadline of the answer is now + timeout_us.
  [[nodiscard]] CanFrame read(Microseconds now, std::uint8_t node, Address address,
                              Microseconds timeout_us = default_timeout_us);
  /// Begins a write of `size` bytes: 1, 2 or 4. The deadline is later for objects that need more time
  /// (min_write_timeout_us).
  [[nodiscard]] CanFrame write(Microseconds now, std::uint8_t node, Address address, std::uint8_t size,
                               std::uint32_t value, Microseconds timeout_us = default_timeout_us);

  /// Begins a read or a write.
  [[nodiscard]] CanFrame begin(Microseconds now, std::uint8_t node, const SdoRequest& request,
                               Microseconds timeout_us) {
    return request.is_read() ? read(now, node, request.address, timeout_us)
                             : write(now, node, request.address, request.size, request.value, timeout_us);
  }

  /// Takes any frame from the bus. Returns whether it ended the transfer. The client ignores an answer of another node,
  /// entry or kind of transfer. An answer that is not expedited ends the transfer with `unknown_command`.
  bool receive(const CanFrame& frame);
  /// Ends the transfer with `timeout` if its deadline has passed.
  void poll(Microseconds now);
  /// Time at which poll() must be called; `never` if no transfer is pending.
  [[nodiscard]] Microseconds next_deadline() const { return state_ == State::waiting ? deadline_ : never; }

  [[nodiscard]] State state() const { return state_; }
  /// The value that was read, zero-extended from its size; valid in the state `done`.
  [[nodiscard]] std::uint32_t value() const { return value_; }
  /// The number of bytes that were read, 0 for a write; valid in the state `done`.
  [[nodiscard]] std::uint8_t size() const { return size_; }
  /// The reason of the abort; valid in the state `aborted`.
  [[nodiscard]] AbortCode abort_code() const { return abort_code_; }
  [[nodiscard]] std::uint8_t node() const { return node_; }
  [[nodiscard]] Address address() const { return address_; }

 private:
  CanFrame start(Microseconds now, std::uint8_t node, Address address, Microseconds timeout_us);
  bool finish(State state, AbortCode code);

  State state_ = State::idle;
  bool writing_ = false;
  std::uint8_t size_ = 0;
  std::uint8_t node_ = 0;
  Address address_;
  std::uint32_t value_ = 0;
  AbortCode abort_code_ = AbortCode::none;
  Microseconds deadline_ = 0;
};

/// The source of the transfers, which receives their results. Its functions must not begin new lists; all may cancel.
class SdoWork {
 public:
  /// The transfer at a position in the list of a joint; nothing after the last one.
  [[nodiscard]] virtual std::optional<SdoRequest> request(unsigned joint, std::size_t position) = 0;
  /// Takes the value that was read at a position. False ends the list of the joint.
  [[nodiscard]] virtual bool on_value(unsigned joint, std::size_t position, std::uint32_t value) = 0;
  /// Must be called when a transfer was aborted, which ends the list of the joint.
  virtual void on_abort(unsigned joint, Address address, AbortCode code) = 0;

 protected:
  ~SdoWork() = default;
};

class SdoClientPool {
 public:
  static constexpr std::size_t clients = 8;
  /// Number of places in the transmit queue that the pool leaves free for other frames.
  static constexpr std::size_t reserve = 5;

  /// Cancels the lists in progress and starts those of these joints. timeout_us: of each attempt. pause_us: if above 0,
  /// transfers are made one by one with this pause between them, in which frames with higher identifiers can be sent.
  void begin(JointMask joints, Microseconds timeout_us, Microseconds pause_us);
  /// Sets the number of attempts, at least 1, after which a transfer without an answer has failed. All transfers may be
  /// repeated: their requests are handled in the order in which they are sent, and each sets or reads a value.
  void set_attempts(unsigned attempts) { attempts_ = attempts; }
  void cancel(unsigned joint);
  void cancel_all() { begin({}, 0, 0); }
  [[nodiscard]] bool done() const;

  /// Sends as many requests as the queue has room for. nodes: node id of each joint.
  void send(Microseconds now, std::span<const std::uint8_t> nodes, TransmitQueue& queue, SdoWork& work);
  /// Takes a frame on 0x580 + node.
  void receive(Microseconds now, const CanFrame& frame, SdoWork& work);
  void poll(Microseconds now, SdoWork& work);
  [[nodiscard]] Microseconds next_deadline() const;

 private:
  /// A client and the list that it works through.
  struct Channel {
    SdoClient client;
    bool is_busy = false;
    std::uint8_t joint = 0;
    std::size_t position = 0;
    bool is_read = false;   ///< whether the present transfer is a read
    unsigned attempts = 0;  ///< number of attempts of the present transfer that have failed
  };

  [[nodiscard]] bool assign(Channel& channel, SdoRequest& request, SdoWork& work);
  void finish(Microseconds now, Channel& channel, SdoWork& work);

  std::array<Channel, clients> channels_;
  unsigned attempts_ = 1;
  JointMask waiting_;  ///< joints whose lists have not begun
  Microseconds timeout_us_ = 0;
  Microseconds pause_us_ = 0;
  Microseconds pause_ends_ = 0;  ///< end of the pause; 0: no pause
};

}  // namespace proleg::canopen
