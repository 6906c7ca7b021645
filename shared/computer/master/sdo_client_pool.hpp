#pragma once

// The SDO clients of the master: they work in parallel, each through the list of transfers of one module at a time. The
// values have at most four bytes: one request and one answer of the module.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/can/can_port.hpp"
#include "shared/can/transmit_queue.hpp"
#include "shared/canopen/object.hpp"
#include "shared/computer/durations/durations.hpp"
#include "shared/computer/master/sdo_transfer.hpp"
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

/// Names the transfers of the lists, and receives their results. Its functions must not call begin(); they may call
/// cancel().
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
  /// The joints whose lists have not ended.
  [[nodiscard]] JointMask unfinished() const;

  /// Sends as many requests as the queue has room for. nodes: node id of each joint.
  void send(Microseconds now, std::span<const std::uint8_t> nodes, TransmitQueue& queue, SdoWork& work);
  /// Takes a frame on 0x580 + node.
  void receive(Microseconds now, const CanFrame& frame, SdoWork& work);
  void poll(Microseconds now, SdoWork& work);
  [[nodiscard]] Microseconds next_deadline() const;
  /// How long modules took to answer since begin(), each from the first attempt on [us].
  [[nodiscard]] const Durations& answers_us() const { return answers_us_; }

 private:
  /// A client and the list that it works through.
  struct Channel {
    SdoTransfer transfer;
    std::array<std::uint8_t, 4> bytes{};  ///< value of the present transfer, which `transfer` reads or fills
    bool is_busy = false;
    std::uint8_t joint = 0;
    std::size_t position = 0;
    bool is_read = false;    ///< whether the present transfer is a read
    unsigned attempts = 0;   ///< number of attempts of the present transfer that have failed
    Microseconds begin = 0;  ///< time of the first attempt
  };

  [[nodiscard]] std::optional<SdoRequest> next_request(Channel& channel, SdoWork& work);
  void begin_transfer(Channel& channel, std::uint8_t node, const SdoRequest& request);
  void finish(Microseconds now, Channel& channel, SdoWork& work);

  std::array<Channel, clients> channels_;
  unsigned attempts_ = 1;
  Durations answers_us_;
  JointMask waiting_;  ///< joints whose lists have not begun
  Microseconds timeout_us_ = 0;
  Microseconds pause_us_ = 0;
  Microseconds pause_ends_ = 0;  ///< end of the pause; 0: no pause
};

}  // namespace proleg::canopen
