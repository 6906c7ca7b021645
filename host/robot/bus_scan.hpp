#pragma once

// Finds the nodes on a bus: listens, reads the device type of every node id, then the identity of those that have
// answered. It only reads, and changes nothing.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "host/robot/sdo_queue.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// A node on the bus.
struct ScannedNode {
  std::uint8_t node = 0;
  bool has_answered = false;               ///< whether the node has answered; otherwise it has only sent by itself
  std::optional<canopen::NmtState> state;  ///< state in its heartbeat; nothing: the node sends no heartbeats
  std::uint32_t device_type = 0;           ///< 0x1000
  std::uint32_t vendor = 0;                ///< 0x1018:1 to 4
  std::uint32_t product = 0;
  std::uint32_t revision = 0;
  std::uint32_t serial = 0;
  std::string name;      ///< 0x1008; empty if it was not read
  std::string hardware;  ///< 0x1009
  std::string software;  ///< 0x100A
  // The members below are for a joint module only.
  bool is_module = false;
  std::uint16_t protocol = 0;          ///< 0x2000:1
  std::uint32_t core_fingerprint = 0;  ///< 0x2000:3
  /// 0x2000:6, the id of the key with which images must be signed, 0: any image. Nothing: its program does not know it.
  std::optional<std::uint32_t> update_key;
  std::optional<std::uint8_t> joint;  ///< 0x2001:1; nothing while the module has no place in a robot (0x2005:6)
  std::uint16_t statusword = 0;       ///< 0x6041
  std::uint8_t error_register = 0;    ///< 0x1001
};

struct BusScanOptions {
  Microseconds listening_us = 250'000;      ///< heartbeats have a period of 100 ms; the scan takes at least this long
  Microseconds answer_timeout_us = 60'000;  ///< timeout of each request
  unsigned attempts = 2;                    ///< attempts of the first request to each node id
  unsigned rounds = 3;            ///< greatest number of times that these are made, on a bus that loses frames
  unsigned further_attempts = 8;  ///< attempts of requests to a node that has answered, or sent by itself
  /// Attempts of the request to modules without a node id, spread over the time that the scan listens: on most buses
  /// no module answers it, so nothing else would show its loss.
  unsigned fresh_attempts = 5;
};

class BusScan final : public BusUser {
 public:
  /// port: must outlive the scan.
  explicit BusScan(CanPort& port, const BusScanOptions& options = {});
  BusScan(const BusScan&) = delete;
  BusScan& operator=(const BusScan&) = delete;

  void start(Microseconds now);
  [[nodiscard]] bool is_done() const { return is_done_; }

  /// The nodes in the order of node ids, complete after the scan has ended.
  [[nodiscard]] std::vector<ScannedNode> nodes() const;
  /// Whether a host, node 127, sends heartbeats, and so drives the robot.
  [[nodiscard]] bool has_host() const { return has_host_; }
  /// Whether modules without a node id answer LSS.
  [[nodiscard]] bool has_fresh_modules() const { return has_fresh_; }
  /// Number of SYNCs that were received, and of frames of any kind.
  [[nodiscard]] unsigned syncs() const { return syncs_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Node ids of modules that have reported, since the start, that another node uses theirs.
  [[nodiscard]] std::vector<std::uint8_t> duplicates() const;

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  struct Seen {
    bool is_heard = false;
    bool is_duplicate = false;
    ScannedNode info;
  };

  void probe(std::uint8_t node);
  void ask(SdoQueue& queue, std::uint8_t node);
  void ask_fresh(Microseconds now);
  void inquire(std::uint8_t node);
  void inquire_texts(std::uint8_t node);
  void read_number(std::uint8_t node, canopen::Address address, const std::function<void(std::uint32_t)>& take);
  void read_text(std::uint8_t node, canopen::Address address, std::string ScannedNode::*field);
  void note_attempts(const SdoResult& result);
  [[nodiscard]] bool probes_again(Microseconds now);
  void finish(Microseconds now);

  CanPort& port_;
  BusScanOptions options_;
  SdoQueue probes_;
  SdoQueue inquiries_;
  std::array<Seen, canopen::host_node> seen_{};  ///< knowledge about each node, by node id
  bool is_started_ = false;
  bool is_done_ = false;
  bool has_host_ = false;
  bool has_fresh_ = false;
  bool has_asked_again_ = false;
  bool is_losing_ = false;  ///< a request was answered only after it was repeated
  unsigned rounds_ = 1;
  bool reads_texts_ = false;
  unsigned syncs_ = 0;
  std::uint64_t frames_ = 0;
  bool has_listened_ = false;
  Microseconds listening_until_ = never;
  unsigned fresh_requests_ = 0;  ///< number of these requests that were sent
  Microseconds fresh_at_ = never;
};

}  // namespace proleg::host
