#pragma once

// Where a robot will be: the next half minute of a draft, simulated beside everything else.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>

#include "host/server/robot_session.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Simulates the newest scenario that it was given, in a thread of its own with a low priority, and publishes the path
/// as the document `foresight` (docs/page-interface.md): the first seconds as soon as they are known, then the whole. A
/// newer scenario waits until the present computation ends, or has taken a tenth of a second: so a viewer who drags
/// something sees paths all the time. The reduced engine computes it, with the same bits as a simulation with it later;
/// ODE, where that refuses the scenario.
class Foresight {
 public:
  /// output: must outlive this.
  explicit Foresight(host::SessionOutput& output);
  ~Foresight();
  Foresight(const Foresight&) = delete;
  Foresight& operator=(const Foresight&) = delete;

  /// Any thread may call this. revision: of the draft.
  void look_at(std::shared_ptr<const sim::Scenario> scenario, std::uint64_t revision);

 private:
  struct Task {
    std::shared_ptr<const sim::Scenario> scenario;
    std::uint64_t revision = 0;
  };

  void run();
  void compute(const Task& task);
  [[nodiscard]] bool is_outdated(const Task& task) const { return newest_ != task.revision; }

  host::SessionOutput& output_;
  std::mutex mutex_;
  std::condition_variable wake_;
  Task waiting_;  ///< without a scenario: nothing waits
  std::atomic<std::uint64_t> newest_ = 0;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace proleg::tools
