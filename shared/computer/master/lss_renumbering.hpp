#pragma once

// Gives modules that have a node id another one (CiA 305): selects each by its LSS address, lets it store the node id,
// and resets all modules, or those that have had one node id in common. They boot with their new node ids. The order is
// the caller's: a module may be listed again, and then has the last node id.

#include <span>

#include "shared/computer/master/lss_exchange.hpp"
#include "shared/computer/master/lss_master.hpp"

namespace proleg::canopen {

/// A module that is to have another node id.
struct RenumberedModule {
  LssAddress address{};
  std::uint8_t node = 0;    ///< its new node id, 1 to 126
  bool is_awaited = true;   ///< after the reset; else its program may not start, and it need not boot
  bool has_stored = false;  ///< result: it has the new node id in its flash
  bool has_booted = false;  ///< result: a module has booted with this node id
};

struct LssRenumberingOptions {
  unsigned attempts = 10;  ///< of each module, and of the reset
  Microseconds answer_timeout_us = 150'000;
  Microseconds silence_us = 60'000;  ///< without an answer: no module is selected
  Microseconds settle_us = 2'000;    ///< after an answer, before the next request
  Microseconds store_timeout_us = storing_time_us;
  Microseconds boot_timeout_us = 400'000;  ///< after the reset
  std::uint8_t reset_node = 0;             ///< the node id, in use until then, that is reset; 0: all
  Microseconds send_timeout_us = 1'000'000;
};

/// A module that is still selected would get the node id of the next one, if the frame that releases it is lost. So
/// before a module is selected, no module may answer as one that is.
/// A state machine with frames and deadlines as inputs and frames as outputs; each of its waits has a timeout.
class LssRenumbering {
 public:
  enum class State : std::uint8_t { idle, working, done, failed };

  /// port: used by this only. modules must outlive this. No drive may have power, and no module be Operational: they
  /// would refuse to store.
  LssRenumbering(CanPort& port, std::span<RenumberedModule> modules, const LssRenumberingOptions& options = {})
      : port_(port),
        modules_(modules),
        options_(options),
        exchange_(port, options.send_timeout_us, options.settle_us) {}
  LssRenumbering(const LssRenumbering&) = delete;
  LssRenumbering& operator=(const LssRenumbering&) = delete;

  void start(Microseconds now);
  void receive(Microseconds now, const CanFrame& frame);
  void transmitted(Microseconds now, const CanFrame& frame) { exchange_.transmitted(now, frame); }
  /// Handles the deadline that has passed; must be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const { return exchange_.deadline(); }

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] LssProblem problem() const { return problem_; }
  /// Of LssProblem: as of LssMaster.
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

  CanPort& port_;
  std::span<RenumberedModule> modules_;
  LssRenumberingOptions options_;
  LssExchange exchange_;
  State state_ = State::idle;
  LssProblem problem_ = LssProblem::none;
  std::uint8_t problem_detail_ = 0;
  Step step_ = Step::release;
  std::size_t position_ = 0;  ///< the module that is renumbered
  std::uint8_t number_ = 0;   ///< of the address
  unsigned releases_ = 0;     ///< sent for this try
  unsigned tries_ = 1;        ///< of this module, or of the reset
};

}  // namespace proleg::canopen
