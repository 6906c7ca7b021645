#pragma once

// For the subcommands that use a bus: how they find and open it, and how they read and write objects of modules.

#include <array>
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/robot/bus_connection.hpp"
#include "host/robot/bus_scan.hpp"
#include "host/robot/object_word.hpp"
#include "host/robot/sdo_queue.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

/// The addresses of the CAN interfaces and serial adapters of this computer, whatever is behind them.
[[nodiscard]] std::vector<std::string> present_buses();

/// The address of the only adapter of this computer that has joint modules behind it: CAN interfaces that are up, and
/// serial adapters. Throws std::runtime_error, which names what was looked at, if there is none, or more than one.
[[nodiscard]] std::string find_bus();

struct BusOptions {
  std::optional<std::string> bus;  ///< --bus

  /// The address in use: --bus, else the environment variable PROLEG_BUS, else `auto`.
  [[nodiscard]] std::string address() const;
};

/// The shortest servo period of real servos: a pulse of 2.5 ms and a pause of 0.5 ms.
inline constexpr std::uint32_t min_real_servo_period_us = 3'000;

/// Whether real servos can be at the bus: at any but sim:FILE. Nothing tells virtual modules behind a line from real
/// ones.
[[nodiscard]] bool can_have_real_servos(const std::string& address);

/// Adds --bus.
void add_bus_option(CommandLine& command_line, BusOptions& options);

/// The bus of a subcommand, open as long as this object.
class BusAccess {
 public:
  /// Throws InputError for a bad address, TransportError if it cannot be reached.
  explicit BusAccess(const BusOptions& options);
  /// A bus of the caller's own.
  explicit BusAccess(const host::BusConnection::Open& open);
  ~BusAccess();
  BusAccess(const BusAccess&) = delete;
  BusAccess& operator=(const BusAccess&) = delete;

  [[nodiscard]] host::BusConnection& connection();
  /// In which the transport runs; of a bus of the caller's own it does nothing.
  [[nodiscard]] boost::asio::io_context& context();
  /// Waits until `done`; throws std::runtime_error if that takes longer than the time, the connection is lost, or the
  /// user interrupts. what: what was waited for, for the message.
  void wait_for(const std::string& what, Microseconds at_most, const std::function<bool()>& done);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Listens until a host would have sent heartbeats. Throws std::runtime_error if one drives the robot: then nothing may
/// be changed.
void require_no_host(BusAccess& bus);

/// Scans the bus; throws std::runtime_error if the connection is lost or interrupted.
void scan(BusAccess& bus, host::BusScan& scan);

/// Options of SDO transfers that a user waits for: they survive a bus that loses one frame in ten.
[[nodiscard]] canopen::SdoTransferOptions patient_transfers();

/// The modules that a NODE argument names; for `all` those that a scan finds. Throws std::runtime_error if there is
/// none.
[[nodiscard]] std::vector<std::uint8_t> nodes_of(BusAccess& bus, const std::string& word);

/// Waits until all transfers of a queue have ended.
void finish(BusAccess& bus, host::SdoQueue& queue);

/// "node 3: no answer to a request for OBJECT; CAUSE", or "node 3: OBJECT: the abort code in words". cause: what is
/// known about the bus.
[[nodiscard]] std::string failure_text(std::uint8_t node, const std::string& object, canopen::AbortCode code,
                                       const std::string& cause);

/// Shows other hosts, while it exists and is active, that a host works on this robot: then they change nothing.
class HostPresence final : public host::BusUser {
 public:
  explicit HostPresence(host::BusConnection& bus) : bus_(bus), attachment_(bus, *this) {}

  /// A master sends heartbeats itself.
  void set_active(bool is_active) { is_active_ = is_active; }

  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override { return is_active_ ? next_ : never; }

 private:
  host::BusConnection& bus_;
  host::BusAttachment attachment_;
  bool is_active_ = true;
  Microseconds next_ = 0;
};

/// The algorithms in the slots of modules, as far as words need them.
class AlgorithmTable {
 public:
  /// Which object a word is for a module. Throws InputError if its algorithm has no such parameter.
  [[nodiscard]] canopen::Object object(std::uint8_t node, const host::ObjectWord& word) const;

 private:
  friend AlgorithmTable read_algorithms(BusAccess&, host::SdoQueue&, std::span<const std::uint8_t>,
                                        std::span<const host::ObjectWord>);
  std::map<std::uint8_t, std::array<std::uint8_t, max_slots>> ids_;  ///< by node
};

/// Reads them, if a word is the name of a parameter. Throws std::runtime_error if a module does not answer.
[[nodiscard]] AlgorithmTable read_algorithms(BusAccess& bus, host::SdoQueue& queue, std::span<const std::uint8_t> nodes,
                                             std::span<const host::ObjectWord> words);

/// The number that travelled, sign-extended.
[[nodiscard]] std::int64_t raw_number(const canopen::Object& object, const host::SdoResult& result);

}  // namespace proleg::tools
