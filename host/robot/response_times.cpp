#include "host/robot/response_times.hpp"

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/sdo_frame.hpp"
#include "shared/computer/master/change_plan.hpp"

namespace proleg::host {
namespace {

/// The transaction that an SDO request opens.
std::optional<std::uint16_t> opened_transaction(const CanFrame& frame) {
  namespace sdo = canopen::sdo;
  const bool opens = canopen::identifier::base_of(frame.identifier) == canopen::identifier::sdo_request &&
                     frame.length == CanFrame::max_length && sdo::specifier(frame) == sdo::request_download &&
                     sdo::address(frame) == canopen::object::transaction.address;
  return opens ? std::optional(static_cast<std::uint16_t>(sdo::data(frame, 2))) : std::nullopt;
}

}  // namespace

std::optional<std::size_t> ChangeTimes::change_of(std::uint16_t transaction) const {
  // Changes that were dropped have no COMMIT; earlier ones are committed again for a module that has restarted.
  constexpr std::size_t most_dropped = 1'000;
  for (std::size_t change = next_; change < next_ + most_dropped; ++change) {
    if (canopen::ChangePlan::transaction(change) == transaction) {
      return change;
    }
  }
  return std::nullopt;
}

void ChangeTimes::accepted(std::size_t change, Microseconds now, std::uint32_t tick) { waiting_[change] = {now, tick}; }

void ChangeTimes::requested(Microseconds now, const CanFrame& frame) {
  if (const auto transaction = opened_transaction(frame)) {
    if (const auto change = change_of(*transaction)) {
      waiting_.try_emplace(*change, Waiting{now, std::nullopt});
    }
    return;
  }
  const auto commit = canopen::decode_commit(frame);
  const auto change = commit ? change_of(commit->transaction) : std::nullopt;
  if (!change) {
    return;
  }
  if (const auto found = waiting_.find(*change); found != waiting_.end()) {
    acknowledged_us_.add(now - found->second.begin);
    if (found->second.tick && commit->tick >= *found->second.tick) {
      ticks_to_effect_.add(commit->tick - *found->second.tick);
    }
  }
  next_ = *change + 1;
  waiting_.erase(waiting_.begin(), waiting_.lower_bound(next_));
}

void AnswerTimes::requested(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  const std::uint8_t node = identifier::node_of(frame.identifier);
  if (identifier::base_of(frame.identifier) != identifier::sdo_request || node >= waiting_.size()) {
    return;
  }
  std::optional<Request>& waiting = waiting_.at(node);
  if (frame.length > 0 && frame.data[0] == canopen::sdo::abort) {
    waiting.reset();  // the old request has no answer
  } else if (!waiting || waiting->frame != frame) {
    waiting = Request{now, frame};
  }
}

void AnswerTimes::receive(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  const std::uint8_t node = identifier::node_of(frame.identifier);
  if (identifier::base_of(frame.identifier) != identifier::sdo_answer || node >= waiting_.size()) {
    return;
  }
  if (std::optional<Request>& waiting = waiting_.at(node)) {
    microseconds_.add(now - waiting->time);
    waiting.reset();
  }
}

}  // namespace proleg::host
