#pragma once

// Reads the settings of a CAN interface of Linux from the kernel. Changes nothing.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "shared/can/can_port.hpp"

namespace proleg::host {

struct CanInterface {
  std::string kind;  ///< "can", "vcan", "slcan", ...; empty: the kernel does not report it
  bool is_can = false;
  bool is_up = false;
  std::optional<std::uint32_t> queue_length;  ///< frames that wait for the controller at most (txqueuelen)
  // The members below exist only for an interface with a controller.
  std::optional<std::uint32_t> bit_rate;    ///< bit/s; nothing while no bit rate is set
  std::optional<std::uint32_t> restart_ms;  ///< pause before the return from bus-off; 0: it does not return
  bool is_listen_only = false;
  std::optional<CanState> state;  ///< nothing while the interface is down
  std::uint16_t transmit_errors = 0;
  std::uint16_t receive_errors = 0;

  friend bool operator==(const CanInterface&, const CanInterface&) = default;
};

/// The settings of an interface; nothing if there is no such interface, or if the kernel cannot be asked.
[[nodiscard]] std::optional<CanInterface> read_can_interface(const std::string& name);

/// Reads an answer of the kernel: a message RTM_NEWLINK (rtnetlink(7)) with its header. Returns nothing for another
/// message or one that is too short. Damaged attributes are left out.
[[nodiscard]] std::optional<CanInterface> parse_link_message(std::span<const std::byte> message);

}  // namespace proleg::host
