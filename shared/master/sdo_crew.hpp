#pragma once

// Several SDO clients that work through a list of transfers for each of many modules, so that the answer of one is not
// awaited before the next is asked.

#include <array>
#include <span>

#include "shared/can/transmit_queue.hpp"
#include "shared/master/joint_set.hpp"
#include "shared/master/sdo_client.hpp"

namespace proleg::canopen {

struct SdoStep {
  bool writes = false;
  Address address;
  std::uint8_t size = 0;    ///< of a write: 1, 2 or 4 bytes
  std::uint32_t value = 0;  ///< of a write
};

/// What is to be done, and what becomes of it. None of these may begin new work; all may cancel.
class SdoWork {
 public:
  /// The transfer at a position in the list of a joint; nothing behind the last one.
  [[nodiscard]] virtual std::optional<SdoStep> step(unsigned joint, std::size_t position) = 0;
  /// The value that was read at a position. False ends the list of the joint.
  [[nodiscard]] virtual bool take(unsigned joint, std::size_t position, std::uint32_t value) = 0;
  /// A transfer was aborted; nothing more is done for the joint.
  virtual void aborted(unsigned joint, Address address, AbortCode code) = 0;

 protected:
  ~SdoWork() = default;
};

class SdoCrew {
 public:
  static constexpr std::size_t clients = 8;
  /// Frames that a queue has room for when the crew sends nothing more: for others.
  static constexpr std::size_t reserve = 5;

  /// Starts the lists of these joints; those before are cancelled. pause_us: if above 0, transfers are made one by one
  /// with so long a pause between them, in which frames with higher identifiers get onto the bus.
  void begin(JointSet joints, Microseconds time_out_us, Microseconds pause_us);
  void cancel(unsigned joint);
  void cancel_all() { begin(0, 0, 0); }
  [[nodiscard]] bool done() const;

  /// Sends what there is room for. nodes: of each joint.
  void send(Microseconds now, std::span<const std::uint8_t> nodes, TransmitQueue& queue, SdoWork& work);
  /// A frame on 0x580 + node.
  void receive(Microseconds now, const CanFrame& frame, SdoWork& work);
  void poll(Microseconds now, SdoWork& work);
  [[nodiscard]] Microseconds next_deadline() const;

 private:
  struct Clerk {
    SdoClient client;
    bool busy = false;
    std::uint8_t joint = 0;
    std::size_t position = 0;
    bool reads = false;
  };

  [[nodiscard]] bool assign(Clerk& clerk, SdoStep& step, SdoWork& work);
  void finish(Microseconds now, Clerk& clerk, SdoWork& work);

  std::array<Clerk, clients> clerks_;
  JointSet waiting_ = 0;
  Microseconds time_out_us_ = 0;
  Microseconds pause_us_ = 0;
  Microseconds pause_ends_ = 0;  ///< 0: none
};

}  // namespace proleg::canopen
