#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "host/robot/bus_user.hpp"
#include "shared/can/can_frame.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/computer/durations/durations.hpp"

namespace proleg::host {

/// Measures how long the changes of a run take: until all modules have acknowledged their values, which is when the
/// master sends the first COMMIT; and from then until they take effect. Changes have the numbers of the master.
class ChangeTimes final : public BusUser {
 public:
  /// Notes that a change without a tick of its own was accepted; its time begins now. The time of other changes begins
  /// with the first request that stages them. tick: the present tick.
  void accepted(std::size_t change, Microseconds now, std::uint32_t tick);

  void requested(Microseconds now, const CanFrame& frame) override;
  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}

  /// Durations until all modules have acknowledged a change.
  [[nodiscard]] const Durations& acknowledged_us() const { return acknowledged_us_; }
  /// Ticks from the acceptance of a change without a tick to the tick at which it takes effect.
  [[nodiscard]] const Durations& ticks_to_effect() const { return ticks_to_effect_; }

 private:
  struct Waiting {
    Microseconds begin;
    std::optional<std::uint32_t> tick;  ///< tick at which the change was accepted; nothing: it has a tick of its own
  };
  /// The change of a transaction, among those that are not committed yet.
  [[nodiscard]] std::optional<std::size_t> change_of(std::uint16_t transaction) const;

  std::map<std::size_t, Waiting> waiting_;  ///< changes that are not committed, by number
  std::size_t next_ = 0;                    ///< number of the first change that is neither committed nor dropped
  Durations acknowledged_us_;
  Durations ticks_to_effect_;
};

/// Measures how long modules take to answer SDO requests of this host: from the moment when the transport took the
/// request until the answer was received. A request that is repeated counts from its first time on; one without an
/// answer does not count. It must be attached to the bus before the users that send requests, because it must see an
/// answer before they do.
class AnswerTimes final : public BusUser {
 public:
  void requested(Microseconds now, const CanFrame& frame) override;
  void receive(Microseconds now, const CanFrame& frame) override;

  [[nodiscard]] const Durations& microseconds() const { return microseconds_; }

 private:
  struct Request {
    Microseconds time;
    CanFrame frame;
  };
  std::array<std::optional<Request>, canopen::host_node> waiting_;  ///< requests without an answer, by node
  Durations microseconds_;
};

}  // namespace proleg::host
