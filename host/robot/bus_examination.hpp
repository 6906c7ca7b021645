#pragma once

// Collects the facts about a bus and the robot on it from which faults are found. It listens first; then it sends
// requests, like BusScan. It only reads, and disturbs no robot that moves.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "host/robot/bus_observations.hpp"
#include "host/robot/bus_scan.hpp"
#include "host/robot/bus_user.hpp"
#include "host/robot/sdo_queue.hpp"
#include "host/robot/silent_modules.hpp"

namespace proleg::host {

struct BusExaminationOptions {
  Microseconds listening_us = 1'000'000;
  /// Shortest time from the last boot-up to the end, in which a module may boot again.
  Microseconds after_boot_up_us = 1'500'000;
  Microseconds longest_listening_us = 4'000'000;
  /// Time after which a request that is not on the bus shows that no node acknowledges, or that the bus has no room.
  Microseconds send_timeout_us = 1'500'000;
  Microseconds longest_asking_us = 30'000'000;
};

class BusExamination final : public BusUser {
 public:
  using ReadOwnEnd = std::function<OwnEnd()>;

  /// port: must outlive the examination. read_own_end: returns the state of the port, and its numbers since it was
  /// opened.
  BusExamination(CanPort& port, ReadOwnEnd read_own_end, const BusExaminationOptions& options = {});
  BusExamination(const BusExamination&) = delete;
  BusExamination& operator=(const BusExamination&) = delete;

  void start(Microseconds now);
  [[nodiscard]] bool is_done() const { return step_ == Step::done; }
  /// The observations, complete after the examination has ended.
  [[nodiscard]] const BusObservations& observations() const { return observations_; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  enum class Step : std::uint8_t { idle, listening, scanning, reading, searching, done };

  void listen(const CanFrame& frame);
  void note_sync(std::uint8_t counter);
  void note_node(Microseconds now, const CanFrame& frame);
  [[nodiscard]] OwnEnd watch_own_end();
  void proceed(Microseconds now);
  void end_listening(Microseconds now);
  void read_details(Microseconds now);
  void search(Microseconds now);
  void finish(bool is_complete);
  [[nodiscard]] bool is_given_up(Microseconds now) const;

  ReadOwnEnd read_own_end_;
  BusExaminationOptions options_;
  BusScan scan_;
  SdoQueue readings_;
  SilentModules silent_;
  Step step_ = Step::idle;
  BusObservations observations_;
  std::array<ObservedNode, canopen::host_node> nodes_{};  ///< nodes by node id; those from which no frame came are 0
  std::optional<std::uint8_t> sync_counter_;
  std::vector<double> bits_;  ///< bits of the frames, by identifier
  OwnEnd first_;              ///< own end at the start
  CanState last_controller_state_ = CanState::error_active;
  std::uint64_t transmitted_ = 0;
  Microseconds started_ = 0;
  Microseconds listening_until_ = never;
  Microseconds asked_ = 0;
};

}  // namespace proleg::host
