#include "host/robot/silent_modules.hpp"

#include <algorithm>
#include <limits>

#include "shared/canopen/declared_objects.hpp"

namespace proleg::host {
namespace {

namespace lss = canopen::lss;
using lss::Service;

constexpr std::uint32_t highest = std::numeric_limits<std::uint32_t>::max();
constexpr unsigned first_attempts = 2;  // at a range of which nothing is known: a frame may be lost
/// At a range that has answered, while neither of its halves answers: each is asked once in an attempt. Also at the
/// selection of a module that is found.
constexpr unsigned further_attempts = 16;

/// The service at a position, from 0, in a sequence of services that begins with the first one.
constexpr Service numbered(Service first, unsigned position) {
  return static_cast<Service>(static_cast<unsigned>(first) + position);
}

CanFrame request(Service first, unsigned position, std::uint32_t word) {
  return lss::make_word(canopen::identifier::lss_request, numbered(first, position), word);
}

}  // namespace

void SilentModules::start(Microseconds now, std::uint32_t vendor, std::vector<std::uint32_t> products,
                          std::vector<std::uint32_t> known) {
  vendor_ = vendor;
  end_ = now + options_.longest_us;
  std::ranges::sort(known);
  for (const std::uint32_t product : products) {
    std::uint32_t low = 0;
    bool reaches_end = false;
    for (const std::uint32_t serial : known) {
      if (serial > low) {
        ranges_.push_back({product, low, serial - 1, first_attempts, false});
      }
      reaches_end = serial == highest;
      low = serial + (reaches_end ? 0U : 1U);
    }
    if (!reaches_end) {
      ranges_.push_back({product, low, highest, first_attempts, false});
    }
  }
  proceed(now);
}

void SilentModules::proceed(Microseconds now) {
  while (!ranges_.empty() && ranges_.front().is_split) {
    end_split();
  }
  if (ranges_.empty() || found_.size() >= options_.max_modules || now >= end_) {
    step_ = Step::done;
    return;
  }
  const Range& range = ranges_.front();
  // The request finds modules of any revision.
  ask(now, Step::identify,
      {request(Service::identify_vendor, 0, vendor_), request(Service::identify_vendor, 1, range.product),
       request(Service::identify_vendor, 2, 0), request(Service::identify_vendor, 3, highest),
       request(Service::identify_vendor, 4, range.low), request(Service::identify_vendor, 5, range.high)});
}

void SilentModules::ask(Microseconds now, Step step, std::initializer_list<CanFrame> frames) {
  step_ = step;
  outgoing_ = frames;
  unsent_ = static_cast<unsigned>(frames.size());
  is_answered_ = false;
  deadline_ = now + options_.send_timeout_us;
  send();
}

void SilentModules::send() {
  while (!outgoing_.empty() && port_.send(outgoing_.front())) {
    outgoing_.pop_front();
  }
}

void SilentModules::transmitted(Microseconds now, const CanFrame& frame) {
  send();
  if (step_ == Step::idle || is_done() || frame.identifier != canopen::identifier::lss_request || unsent_ == 0) {
    return;
  }
  if (--unsent_ == 0) {
    deadline_ = now + (is_answered_ ? options_.settle_us : options_.answer_timeout_us);
  }
}

void SilentModules::receive(Microseconds now, const CanFrame& frame) {
  if (frame.identifier != canopen::identifier::lss_answer || frame.length != 8) {
    return;
  }
  const Service expected = step_ == Step::identify  ? Service::identified
                           : step_ == Step::select  ? Service::selected
                           : step_ == Step::inquire ? Service::inquire_node_id
                                                    : Service::switch_state_global;
  if (lss::service_of(frame) != expected) {
    return;
  }
  is_answered_ = true;
  answer_ = frame.data[1];
  if (unsent_ == 0) {
    deadline_ = now + options_.settle_us;
  }
}

void SilentModules::poll(Microseconds now) {
  send();
  if (step_ == Step::idle || is_done() || now < deadline_) {
    return;
  }
  if (unsent_ != 0) {
    step_ = Step::done;  // the bus accepts no frames
    return;
  }
  conclude(now);
}

void SilentModules::conclude(Microseconds now) {
  switch (step_) {
    case Step::identify:
      conclude_range(now);
      return;
    case Step::select:
      if (is_answered_) {
        ask(now, Step::inquire, {lss::make(canopen::identifier::lss_request, Service::inquire_node_id)});
        return;
      }
      break;
    case Step::inquire:
      if (is_answered_) {
        selections_ = 0;
        found_.back().node_id = answer_ == lss::no_node_id ? std::nullopt : std::optional<std::uint8_t>(answer_);
      }
      break;
    default:
      if (selections_ != 0 && selections_ < further_attempts) {
        select(now);
        return;
      }
      if (selections_ != 0) {
        selections_ = 0;
        found_.pop_back();  // the module was switched off meanwhile
      }
      proceed(now);
      return;
  }
  ask(now, Step::release,
      {lss::make(canopen::identifier::lss_request, Service::switch_state_global,
                 static_cast<std::uint8_t>(lss::State::waiting))});
}

void SilentModules::conclude_range(Microseconds now) {
  Range& range = ranges_.front();
  if (!is_answered_ && --range.attempts > 0) {
    proceed(now);
    return;
  }
  const Range asked = range;
  ranges_.pop_front();
  if (!is_answered_) {
    proceed(now);
    return;
  }
  if (const auto parent = std::ranges::find(ranges_, true, &Range::is_split); parent != ranges_.end()) {
    parent->attempts = 0;  // the halves of the parent need no further requests
  }
  if (asked.low < asked.high) {
    split({asked.product, asked.low, asked.high, further_attempts, true});
    proceed(now);
    return;
  }
  found_.push_back({asked.low, std::nullopt, asked.product});
  select(now);
}

/// Splits a range into halves. The range itself stays behind its halves, until one of them has answered.
void SilentModules::split(Range range) {
  const std::uint32_t middle = range.low + (range.high - range.low) / 2;
  ranges_.push_front(range);
  ranges_.push_front({range.product, middle + 1, range.high, 1, false});
  ranges_.push_front({range.product, range.low, middle, 1, false});
}

/// Ends a split after requests for both halves.
void SilentModules::end_split() {
  Range range = ranges_.front();
  ranges_.pop_front();
  if (range.attempts > 1) {
    --range.attempts;
    split(range);
  }
}

void SilentModules::select(Microseconds now) {
  ++selections_;
  // All modules of this vendor have the revision of the dictionary.
  ask(now, Step::select,
      {request(Service::select_vendor, 0, vendor_), request(Service::select_vendor, 1, found_.back().product),
       request(Service::select_vendor, 2, canopen::object::revision.default_value),
       request(Service::select_vendor, 3, found_.back().serial)});
}

}  // namespace proleg::host
