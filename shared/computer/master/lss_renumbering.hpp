#pragma once

// Gives another node id to modules that have one (CiA 305): selects each by its LSS address, lets it store the node id,
// and resets all modules, or those that have had the same node id. They boot with their new node ids. The caller
// decides the order: a module may be listed again, and then has the last node id.

#include <span>

#include "shared/computer/master/lss_master.hpp"

namespace proleg::canopen {

/// A module that gets another node id.
struct RenumberedModule {
  LssAddress address{};
  std::uint8_t node = 0;    ///< its new node id, 1 to 126
  bool is_awaited = true;   ///< whether it must boot after the reset; if its program may not start, it need not
  bool has_stored = false;  ///< result: it has the new node id in its flash
  bool has_booted = false;  ///< result: a module has booted with this node id
};

struct LssRenumberingOptions {
  unsigned attempts = 10;  ///< number of attempts for each module, and for the reset
  Microseconds answer_timeout_us = 150'000;
  Microseconds silence_us = 60'000;  ///< time without an answer after which no module is selected
  Microseconds settle_us = 2'000;    ///< time after an answer before the next request
  Microseconds store_timeout_us = storing_time_us;
  Microseconds boot_timeout_us = 400'000;  ///< time for the boot-up after the reset
  std::uint8_t reset_node = 0;             ///< the node id until then of the modules that are reset; 0: all
  Microseconds send_timeout_us = 1'000'000;
};

/// If the frame that releases a module is lost, the module is still selected and would get the node id of the next one.
/// So before a module is selected, the master makes sure that no module answers as a selected one. The class is a state
/// machine with frames and deadlines as inputs and frames as outputs; each of its waits has a timeout.
class LssRenumbering {
 public:
  enum class State : std::uint8_t { idle, working, done, failed };

  /// port: must be used by this object only. modules: must outlive this object. No drive may have power, and no module
  /// may be Operational: they would refuse to store.
  LssRenumbering(CanPort& port, std::span<RenumberedModule> modules, const LssRenumberingOptions& options = {})
      : modules_(modules), options_(options), exchange_(port, options.send_timeout_us, options.settle_us) {}
  LssRenumbering(const LssRenumbering&) = delete;
  LssRenumbering& operator=(const LssRenumbering&) = delete;

  void start(Microseconds now);
  void receive(Microseconds now, const CanFrame& frame);
  void transmitted(Microseconds now, const CanFrame& frame) { exchange_.transmitted(now, frame); }
  /// Handles timeouts. Must be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const { return exchange_.deadline(); }

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] LssProblem problem() const { return problem_; }
  /// Detail of the problem, as LssProblem describes it.
  [[nodiscard]] std::uint8_t problem_detail() const { return problem_detail_; }
  /// Position of the module that the problem is about.
  [[nodiscard]] std::size_t problem_module() const { return position_; }

 private:
  /// The request that was sent last.
  enum class Step : std::uint8_t { release, probe, select, configure, store, release_all, reset };

  void send(Microseconds now, Step step);
  [[nodiscard]] std::uint8_t node_to_reset() const;
  void select(Microseconds now);
  void conclude(Microseconds now);
  void next_module(Microseconds now);
  void repeat_or_fail(Microseconds now, Step first, LssProblem problem, std::uint8_t detail);
  [[nodiscard]] std::size_t first_missing() const;
  void fail(LssProblem problem, std::uint8_t detail);

  std::span<RenumberedModule> modules_;
  LssRenumberingOptions options_;
  LssExchange exchange_;
  State state_ = State::idle;
  LssProblem problem_ = LssProblem::none;
  std::uint8_t problem_detail_ = 0;
  Step step_ = Step::release;
  std::size_t position_ = 0;  ///< the module that is renumbered
  std::uint8_t number_ = 0;   ///< position of the number in the address
  unsigned releases_ = 0;     ///< number of releases that were sent in this attempt
  unsigned tries_ = 1;        ///< number of attempts for this module, or for the reset
};

}  // namespace proleg::canopen
