#pragma once

// SDO transfers of a host with many modules: one at a time with each module, with several modules at the same time.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/computer/master/sdo_transfer.hpp"

namespace proleg::host {

/// Timeout of an answer, and number of attempts, of a host program: with them a command succeeds on a bus that loses
/// one frame in ten, and over a radio.
inline constexpr Microseconds patient_timeout_us = 150'000;
inline constexpr unsigned patient_attempts = 8;

/// Options for values that are read periodically: the next reading replaces a lost one.
[[nodiscard]] inline canopen::SdoTransferOptions periodic_reading_options() {
  canopen::SdoTransferOptions options;
  options.timeout_us = 100'000;
  options.attempts = 2;
  return options;
}

struct SdoResult {
  canopen::AbortCode abort_code = canopen::AbortCode::none;  ///< `timeout`: no answer
  std::vector<std::uint8_t> value;                           ///< value that was read
  unsigned attempts = 0;
  Microseconds elapsed_us = 0;  ///< duration from the first request to the end of the transfer

  [[nodiscard]] bool is_good() const { return abort_code == canopen::AbortCode::none; }
  /// The first bytes as a number, little-endian; 0 without bytes.
  [[nodiscard]] std::uint32_t number() const;
};

class SdoQueue final : public BusUser {
 public:
  /// Greatest number of modules with a transfer at the same time. A request takes 0.13 ms of the bus.
  static constexpr std::size_t max_parallel = 32;
  /// The longest value that a read can return.
  static constexpr std::size_t max_size = 4'096;

  using Done = std::function<void(const SdoResult& result)>;

  /// port: must outlive the queue. options: options of every transfer.
  explicit SdoQueue(CanPort& port, const canopen::SdoTransferOptions& options = {}) : port_(port), options_(options) {}
  SdoQueue(const SdoQueue&) = delete;
  SdoQueue& operator=(const SdoQueue&) = delete;

  /// Adds a read transfer. node: 1 to 126. If a node does not answer, all its transfers that have not begun end with
  /// the same result. `done` is called once, when the transfer ends; it may add further transfers. Transfers with one
  /// node are made in the order of the calls. They begin with the next call of receive(), transmitted() or poll();
  /// until then next_deadline() is the present.
  void read(std::uint8_t node, canopen::Address address, Done done);
  void write(std::uint8_t node, canopen::Address address, std::span<const std::uint8_t> data, Done done);
  /// Adds a write transfer of a number, with the size of its type.
  void write(std::uint8_t node, canopen::Address address, canopen::DataType type, std::uint32_t value, Done done);

  /// Whether all transfers have ended.
  [[nodiscard]] bool is_idle() const { return unfinished_ == 0; }
  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  struct Job {
    canopen::Address address;
    std::optional<std::vector<std::uint8_t>> data;  ///< bytes that are written; nothing: the transfer reads
    Done done;
  };
  struct Channel {
    canopen::SdoTransfer transfer;
    std::vector<std::uint8_t> buffer;
    Job job;
    std::optional<CanFrame> waiting;  ///< frame for which the port had no room
    std::optional<Microseconds> begin;
  };

  void add(std::uint8_t node, Job job);
  void advance(Microseconds now);
  void begin_jobs();
  void send(Microseconds now);
  void finish_ended(Microseconds now);

  CanPort& port_;
  canopen::SdoTransferOptions options_;
  std::array<std::deque<Job>, canopen::host_node> jobs_;  ///< transfers by node
  std::vector<std::unique_ptr<Channel>> channels_;
  std::size_t unfinished_ = 0;
  std::size_t waiting_ = 0;  ///< number of jobs that have not begun
  bool is_new_ = false;      ///< jobs were added since the last advance()
};

}  // namespace proleg::host
