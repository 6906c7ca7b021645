#include "shared/master/sdo_crew.hpp"

namespace proleg::canopen {

void SdoCrew::begin(JointSet joints, Microseconds time_out_us, Microseconds pause_us) {
  clerks_ = {};
  waiting_ = joints;
  time_out_us_ = time_out_us;
  pause_us_ = pause_us;
  pause_ends_ = 0;
}

void SdoCrew::cancel(unsigned joint) {
  waiting_ &= ~set_of(joint);
  for (Clerk& clerk : clerks_) {
    if (clerk.busy && clerk.joint == joint) {
      clerk = {};
    }
  }
}

bool SdoCrew::done() const {
  for (const Clerk& clerk : clerks_) {
    if (clerk.busy) {
      return false;
    }
  }
  return waiting_ == 0;
}

/// Finds the clerk's next step, in the list of the next joint if that of the present one is done.
bool SdoCrew::assign(Clerk& clerk, SdoStep& step, SdoWork& work) {
  for (;;) {
    if (!clerk.busy) {
      if (waiting_ == 0) {
        return false;
      }
      clerk = {};
      clerk.busy = true;
      clerk.joint = static_cast<std::uint8_t>(first_of(waiting_));
      waiting_ &= ~set_of(clerk.joint);
    }
    if (const std::optional<SdoStep> next = work.step(clerk.joint, clerk.position)) {
      step = *next;
      return true;
    }
    clerk.busy = false;
  }
}

void SdoCrew::send(Microseconds now, std::span<const std::uint8_t> nodes, TransmitQueue& queue, SdoWork& work) {
  if (now < pause_ends_) {
    return;
  }
  pause_ends_ = 0;
  // With pauses one client does all the work.
  for (Clerk& clerk : std::span(clerks_).first(pause_us_ == 0 ? clients : 1)) {
    if (clerk.client.state() == SdoClient::State::waiting) {
      continue;
    }
    SdoStep step;
    if (queue.size() + reserve >= TransmitQueue::capacity || !assign(clerk, step, work)) {
      continue;
    }
    clerk.reads = !step.writes;
    const std::uint8_t node = nodes[clerk.joint];
    const CanFrame request = step.writes
                                 ? clerk.client.write(now, node, step.address, step.size, step.value, time_out_us_)
                                 : clerk.client.read(now, node, step.address, time_out_us_);
    static_cast<void>(queue.push(request));  // there is room
  }
}

void SdoCrew::receive(Microseconds now, const CanFrame& frame, SdoWork& work) {
  for (Clerk& clerk : clerks_) {
    if (clerk.client.receive(frame)) {
      finish(now, clerk, work);
      return;
    }
  }
}

void SdoCrew::poll(Microseconds now, SdoWork& work) {
  for (Clerk& clerk : clerks_) {
    if (clerk.client.next_deadline() <= now) {
      clerk.client.poll(now);
      finish(now, clerk, work);
    }
  }
}

void SdoCrew::finish(Microseconds now, Clerk& clerk, SdoWork& work) {
  pause_ends_ = pause_us_ == 0 ? 0 : now + pause_us_;
  const SdoClient client = clerk.client;
  const std::size_t position = clerk.position++;
  if (client.state() == SdoClient::State::aborted) {
    clerk.busy = false;
    work.aborted(clerk.joint, client.address(), client.abort_code());
  } else if (clerk.reads && !work.take(clerk.joint, position, client.value())) {
    clerk.busy = false;
  }
}

Microseconds SdoCrew::next_deadline() const {
  Microseconds next = pause_ends_ == 0 ? never : pause_ends_;
  for (const Clerk& clerk : clerks_) {
    const Microseconds deadline = clerk.client.next_deadline();
    next = deadline < next ? deadline : next;
  }
  return next;
}

}  // namespace proleg::canopen
