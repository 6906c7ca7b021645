#pragma once

#include "firmware/module/network_node.hpp"

namespace proleg::firmware {

/// Errors that last.
enum class Fault : std::uint8_t {
  identifier_collision,
  sync_lost,
  heartbeat_lost,
  foreign_configuration,
  over_current,
  bus_off,
};

/// Sends EMCY and keeps the error register (CiA 301, section 7.2.7). Stopped modules keep silent.
class Emergencies {
 public:
  Emergencies(const Board& board, const NetworkNode& network, Outbox& outbox)
      : board_(board), network_(network), outbox_(outbox) {}

  void reset() { faults_ = 0; }

  /// Something that happened and is over.
  void report(canopen::EmergencyCode code, std::uint32_t detail);
  /// Something that lasts.
  void raise(Fault fault, std::uint32_t detail);
  /// It is over: EMCY `none`, with its code as the detail. Nothing happens if it was not raised.
  void clear(Fault fault);
  [[nodiscard]] bool is_raised(Fault fault) const { return (faults_ & bit(fault)) != 0; }

  /// Object 0x1001.
  [[nodiscard]] std::uint8_t error_register() const;

 private:
  [[nodiscard]] static std::uint8_t bit(Fault fault) {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(fault));
  }

  const Board& board_;
  const NetworkNode& network_;
  Outbox& outbox_;
  std::uint8_t faults_ = 0;
};

}  // namespace proleg::firmware
