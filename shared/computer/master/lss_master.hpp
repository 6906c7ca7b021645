#pragma once

// The master of the layer setting services (CiA 305): finds modules without a node id by Fastscan, gives each a node id
// and lets it store the id. A state machine with frames and deadlines as inputs and frames as outputs; each of its
// waits has a timeout.

#include <span>

#include "shared/can/can_port.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/lss_frame.hpp"

namespace proleg::canopen {

/// The request after which no module is selected: all are in the LSS state "waiting".
[[nodiscard]] constexpr CanFrame lss_release_request() {
  return lss::make(identifier::lss_request, lss::Service::switch_state_global,
                   static_cast<std::uint8_t>(lss::State::waiting));
}

/// A request of an LSS master and the answers to it. Several modules may answer a request, one after the other. An
/// exchange therefore ends when no more answers came for a while, so that a late one is not taken for the answer to the
/// next request.
class LssExchange {
 public:
  /// Frames that are an answer to the request.
  struct Answer {
    std::uint16_t identifier;
    std::uint8_t length;
    std::uint8_t first_byte;
  };
  static constexpr Answer of(lss::Service service) {
    return {identifier::lss_answer, CanFrame::max_length, static_cast<std::uint8_t>(service)};
  }
  static Answer boot_up_of(std::uint8_t node) {
    const CanFrame frame = encode(Heartbeat{node, NmtState::boot_up});
    return {frame.identifier, frame.length, frame.data[0]};
  }

  /// send_timeout_us: for a frame that no node acknowledges. settle_us: time without a frame after an answer.
  LssExchange(CanPort& port, Microseconds send_timeout_us, Microseconds settle_us)
      : port_(port), send_timeout_us_(send_timeout_us), settle_us_(settle_us) {}

  /// Begins an exchange. wait_us: time for an answer, after the request was sent.
  void begin(Microseconds now, const CanFrame& request, const Answer& answer, Microseconds wait_us);
  /// Begins an exchange with a request without an answer: it ends when the request was sent.
  void begin(Microseconds now, const CanFrame& request) { begin(now, request, {}, 0); }
  /// Ends the exchange: frames from now on do not belong to one.
  void cancel() { deadline_ = never; }
  /// Cancels, and sends the request that leaves no module selected: one that stays selected would be configured with
  /// the next one. If this frame is lost, the next start of a service releases the module.
  void cancel_and_release();

  void receive(Microseconds now, const CanFrame& frame);
  void transmitted(Microseconds now, const CanFrame& frame);

  [[nodiscard]] Microseconds deadline() const { return deadline_; }
  [[nodiscard]] bool has_ended(Microseconds now) const { return now >= deadline_; }
  // Result of an exchange that has ended.
  [[nodiscard]] bool is_sent() const { return is_sent_; }
  [[nodiscard]] bool is_answered() const { return is_answered_; }
  /// Time from begin() to the first answer.
  [[nodiscard]] Microseconds answer_delay() const { return answer_delay_; }
  /// The second byte of the answer; of several answers, the first one that is not lss::ok.
  [[nodiscard]] std::uint8_t error() const { return error_; }

 private:
  void hand_over();

  CanPort& port_;
  Microseconds send_timeout_us_;
  Microseconds settle_us_;
  CanFrame request_{};
  Answer answer_{};
  Microseconds wait_us_ = 0;
  Microseconds begun_ = 0;
  Microseconds answer_delay_ = 0;
  Microseconds deadline_ = never;
  bool is_pending_ = false;  ///< the request waits for a mailbox
  bool is_sent_ = false;
  bool is_answered_ = false;
  std::uint8_t error_ = lss::ok;
};

/// A module that needs a node id.
struct LssModule {
  std::uint8_t node = 0;     ///< the node id that it will have, 1 to 126
  std::uint32_t serial = 0;  ///< serial number that the module must have (0x1018:4); 0: any that no other entry names
  bool has_booted = false;   ///< result: a module was found, and has booted with the node id
  LssAddress address{};      ///< result: the address of that module
};

struct LssMasterOptions {
  /// Numbers that most modules have. They are tried first, with one frame instead of 33. 0: not known.
  LssAddress usual{object::vendor.default_value, 0, object::revision.default_value, 0};
  bool stores = true;  ///< whether the modules store the node id
  /// Number of times that a request is sent without an answer; more for a connection that loses frames.
  unsigned attempts = 1;
  Microseconds answer_timeout_us = 10'000;
  /// Time for the answer to the first request, 'is there a module?'. If its answer takes long, as over a radio, the
  /// master waits for further answers three times as long, and at least answer_timeout_us.
  Microseconds first_answer_timeout_us = 10'000;
  Microseconds settle_us = 2'000;  ///< time without an answer before the next request
  Microseconds store_timeout_us = storing_time_us;
  Microseconds boot_timeout_us = 100'000;
  Microseconds send_timeout_us = 1'000'000;  ///< timeout of a frame that no node acknowledges
};

enum class LssProblem : std::uint8_t {
  none,
  not_sent,     ///< no node acknowledges: no other node is on the bus, or all have another bit rate
  scan_failed,  ///< a module answered at first, and then no more; detail: number of the address that was asked for, 0
                ///< to 3
  unexpected_module,  ///< found() is not in the list, or all entries are used
  no_answer,          ///< the module that was found does not answer 'configure node id' or 'store'; detail: the service
  node_refused,       ///< the module has refused the node id; detail: error code
  store_refused,      ///< the module has refused to store; detail: error code; 255: it does not write its flash in its
                      ///< present state
  not_released,       ///< only from LssRenumbering: another module stays selected
  no_boot_up,         ///< the module does not boot; detail: the node id
};
/// A short phrase that describes the problem, for people.
[[nodiscard]] std::string_view describe(LssProblem problem);

class LssMaster {
 public:
  enum class State : std::uint8_t { idle, working, done, failed };
  /// Greatest number of scans, if a module leaves the bus meanwhile.
  static constexpr unsigned max_scans = 3;

  /// port: must be used by this master only. modules: must outlive the master.
  LssMaster(CanPort& port, std::span<LssModule> modules, const LssMasterOptions& options = {})
      : modules_(modules), options_(options), exchange_(port, options.send_timeout_us, options.settle_us) {}
  LssMaster(const LssMaster&) = delete;
  LssMaster& operator=(const LssMaster&) = delete;

  /// Starts. The master is done when no module without a node id answers. Modules that were not found have no
  /// `has_booted`.
  void start(Microseconds now);

  void receive(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller has sent a frame of the master.
  void transmitted(Microseconds now, const CanFrame& frame);
  /// Handles timeouts. Must be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const { return exchange_.deadline(); }

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] LssProblem problem() const { return problem_; }
  [[nodiscard]] std::uint8_t problem_detail() const { return problem_detail_; }
  /// The address of the module that was found last.
  [[nodiscard]] const LssAddress& found() const { return address_; }
  /// Number of modules that have booted with their node id.
  [[nodiscard]] unsigned assigned() const { return assigned_; }

 private:
  /// The request that was sent last, or the event that the master waits for.
  enum class Step : std::uint8_t {
    release_all,  ///< at the start: release modules that another master has selected
    begin,        ///< ask whether there is a module without a node id
    guess,        ///< ask for a usual number as a whole
    bit,          ///< ask whether the next lower bit is 0
    verify,       ///< ask for the number that the bits have given
    configure,
    store,
    release,  ///< release the module that was configured: it boots
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

  std::span<LssModule> modules_;
  LssMasterOptions options_;

  State state_ = State::idle;
  LssProblem problem_ = LssProblem::none;
  std::uint8_t problem_detail_ = 0;
  Step step_ = Step::release_all;
  Microseconds answer_time_us_ = 0;  ///< time for answers on this connection
  unsigned tries_ = 0;               ///< number of times that the present request was sent
  std::uint8_t sub_ = 0;             ///< position of the number that is scanned
  std::uint8_t bit_ = 0;
  std::uint32_t number_ = 0;
  unsigned scans_ = 0;
  unsigned assigned_ = 0;
  LssAddress address_{};
  LssModule* module_ = nullptr;  ///< the module that is configured
  LssExchange exchange_;
};

}  // namespace proleg::canopen
