#pragma once

// The master of the layer setting services (CiA 305): finds modules without a node id by Fastscan, gives each a node id
// and lets it store the id. A state machine with frames and deadlines as inputs and frames as outputs; each of its
// waits has a timeout.

#include <span>

#include "shared/can/can_port.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/lss_frame.hpp"
#include "shared/computer/master/lss_exchange.hpp"

namespace proleg::canopen {

/// A module that is to have a node id.
struct LssModule {
  std::uint8_t node = 0;     ///< the node id that it will have, 1 to 126
  std::uint32_t serial = 0;  ///< that the module must have (0x1018:4); 0: any that no other entry names
  bool has_booted = false;   ///< result: a module was found, and has booted with the node id
  LssAddress address{};      ///< result: of that module
};

struct LssMasterOptions {
  /// Numbers that most modules have: they are tried first, a frame instead of 33. 0: not known.
  LssAddress usual{object::vendor.default_value, 0, object::revision.default_value, 0};
  bool stores = true;     ///< the modules keep the node id
  unsigned attempts = 1;  ///< of each request, if there is no answer; more for a connection that loses frames
  Microseconds answer_timeout_us = 10'000;
  /// Of the first request, 'is there a module?'. If its answer takes long, as over a radio, the master waits for
  /// further answers three times as long, and at least answer_timeout_us.
  Microseconds first_answer_timeout_us = 10'000;
  Microseconds settle_us = 2'000;  ///< without an answer before the next request
  Microseconds store_timeout_us = storing_time_us;
  Microseconds boot_timeout_us = 100'000;
  Microseconds send_timeout_us = 1'000'000;  ///< of a frame that no node acknowledges
};

enum class LssProblem : std::uint8_t {
  none,
  not_sent,           ///< no node acknowledges: no other is on the bus, or all have another bit rate
  scan_failed,        ///< a module answered, then not; detail: the number of the address that was asked for, 0 to 3
  unexpected_module,  ///< found() is not in the list, or the list is used up
  no_answer,          ///< of the module that was found, to 'configure node id' or 'store'; detail: the service
  node_refused,       ///< detail: error code
  store_refused,      ///< detail: error code; 255: the module does not write its flash in its present state
  not_released,       ///< of LssRenumbering: another module stays selected
  no_boot_up,         ///< the module does not boot; detail: the node id
};
/// One short phrase for people.
[[nodiscard]] std::string_view describe(LssProblem problem);

class LssMaster {
 public:
  enum class State : std::uint8_t { idle, working, done, failed };
  /// A scan is repeated so often, if a module leaves meanwhile.
  static constexpr unsigned max_scans = 3;

  /// port: used by this master only. modules must outlive the master.
  LssMaster(CanPort& port, std::span<LssModule> modules, const LssMasterOptions& options = {})
      : port_(port),
        modules_(modules),
        options_(options),
        exchange_(port, options.send_timeout_us, options.settle_us) {}
  LssMaster(const LssMaster&) = delete;
  LssMaster& operator=(const LssMaster&) = delete;

  /// Done when no module without a node id answers. Then modules that were not found have no `has_booted`.
  void start(Microseconds now);

  void receive(Microseconds now, const CanFrame& frame);
  /// The controller has sent a frame of the master.
  void transmitted(Microseconds now, const CanFrame& frame);
  /// Handles the deadline that has passed; must be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const { return exchange_.deadline(); }

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] LssProblem problem() const { return problem_; }
  [[nodiscard]] std::uint8_t problem_detail() const { return problem_detail_; }
  /// The address of the module that was found last.
  [[nodiscard]] const LssAddress& found() const { return address_; }
  /// Modules that have booted with their node id.
  [[nodiscard]] unsigned assigned() const { return assigned_; }

 private:
  /// The request that was sent last, or what is waited for.
  enum class Step : std::uint8_t {
    release_all,  ///< at the start: modules that another master has selected
    begin,        ///< is there a module without a node id?
    guess,        ///< a usual number as a whole
    bit,          ///< is the next lower bit 0?
    verify,       ///< the number that the bits have given
    configure,
    store,
    release,  ///< of the module that was configured: it boots
  };

  void send(Microseconds now, Step step);
  void exchange(Microseconds now);
  [[nodiscard]] CanFrame request() const;
  [[nodiscard]] unsigned attempts() const;
  void conclude(Microseconds now);
  void scan_number(Microseconds now);
  void finish_number(Microseconds now);
  void repeat_scan(Microseconds now);
  void assign(Microseconds now);
  void finish(Microseconds now, lss::Service service, LssProblem refused, Step next);
  [[nodiscard]] LssModule* find_entry() const;
  void fail(LssProblem problem, std::uint8_t detail = 0);

  CanPort& port_;
  std::span<LssModule> modules_;
  LssMasterOptions options_;

  State state_ = State::idle;
  LssProblem problem_ = LssProblem::none;
  std::uint8_t problem_detail_ = 0;
  Step step_ = Step::release_all;
  Microseconds patience_us_ = 0;  ///< for the answers of this connection
  unsigned tries_ = 0;            ///< of the present request
  std::uint8_t sub_ = 0;          ///< the number that is scanned
  std::uint8_t bit_ = 0;
  std::uint32_t number_ = 0;
  unsigned scans_ = 0;
  unsigned assigned_ = 0;
  LssAddress address_{};
  LssModule* module_ = nullptr;  ///< the one that is configured
  LssExchange exchange_;
};

}  // namespace proleg::canopen
