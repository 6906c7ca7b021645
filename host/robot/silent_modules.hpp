#pragma once

// Finds modules that are on the bus but answer no SDO: Stopped ones, as after a collision of node ids. All modules
// serve LSS (CiA 305) in every state: 'identify remote slave' finds those whose serial number is not among the known
// ones, by halving the range of serial numbers. The node id is read from each. Nothing is changed. A bus that loses
// one frame in ten makes the search longer.

#include <cstdint>
#include <deque>
#include <vector>

#include "host/robot/bus_observations.hpp"
#include "host/robot/bus_user.hpp"
#include "shared/canopen/lss_frame.hpp"

namespace proleg::host {

struct SilentModulesOptions {
  Microseconds answer_timeout_us = 30'000;
  Microseconds settle_us = 3'000;  ///< pause after an answer, because several modules answer one request
  Microseconds send_timeout_us = 500'000;
  Microseconds longest_us = 15'000'000;  ///< duration of the whole search
  std::size_t max_modules = 8;           ///< number of modules that are searched for
};

/// Searches a bus without another host, whose LSS master would receive the answers.
class SilentModules final : public BusUser {
 public:
  /// port: must outlive this.
  explicit SilentModules(CanPort& port, const SilentModulesOptions& options = {}) : port_(port), options_(options) {}
  SilentModules(const SilentModules&) = delete;
  SilentModules& operator=(const SilentModules&) = delete;

  /// Starts the search. vendor, products: identity of the modules that are searched for. known: serial numbers of
  /// modules that are left out.
  void start(Microseconds now, std::uint32_t vendor, std::vector<std::uint32_t> products,
             std::vector<std::uint32_t> known);
  [[nodiscard]] bool is_done() const { return step_ == Step::done; }
  [[nodiscard]] const std::vector<SilentModule>& found() const { return found_; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override { return is_done() ? never : deadline_; }

 private:
  enum class Step : std::uint8_t { idle, identify, select, inquire, release, done };
  struct Range {
    std::uint32_t product;
    std::uint32_t low;
    std::uint32_t high;
    unsigned attempts;
    bool is_split;  ///< the range has answered, and its halves are examined before it
  };

  void proceed(Microseconds now);
  void ask(Microseconds now, Step step, std::initializer_list<CanFrame> frames);
  void send();
  void conclude(Microseconds now);
  void conclude_range(Microseconds now);
  void split(Range range);
  void end_split();
  void select(Microseconds now);

  CanPort& port_;
  SilentModulesOptions options_;
  std::uint32_t vendor_ = 0;
  std::deque<Range> ranges_;  ///< ranges to be examined; the request for the first one is under way
  Step step_ = Step::idle;
  std::deque<CanFrame> outgoing_;
  unsigned unsent_ = 0;  ///< number of frames of the request that were not on the bus yet
  bool is_answered_ = false;
  std::uint8_t answer_ = 0;  ///< first byte of data of the answer
  Microseconds end_ = never;
  Microseconds deadline_ = never;
  std::vector<SilentModule> found_;
  unsigned selections_ = 0;  ///< number of selections of the last module, until it has answered with its node id
};

}  // namespace proleg::host
