#pragma once

#include <array>
#include <optional>

#include "host/robot/bus_user.hpp"
#include "shared/can/can_frame.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/computer/durations/durations.hpp"

namespace proleg::host {

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
