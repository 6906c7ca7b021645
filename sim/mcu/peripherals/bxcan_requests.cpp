#include "sim/mcu/peripherals/bxcan_requests.hpp"

#include <algorithm>

namespace proleg::sim {

void BxCanRequests::add(BusTime time, Kind kind, std::uint32_t value) {
  pending_.push_back({empty() ? time : std::max(time, pending_.back().time), kind, value});
}

void BxCanRequests::postpone(const Request& request, BusTime time) {
  pending_.push_front({time, request.kind, request.value});
}

std::optional<BxCanRequests::Request> BxCanRequests::take_due(BusTime now) {
  if (empty() || pending_.front().time > now) {
    return std::nullopt;
  }
  const Request request = pending_.front();
  pending_.pop_front();
  return request;
}

}  // namespace proleg::sim
