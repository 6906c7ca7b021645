#include "shared/computer/master/sdo_client_pool.hpp"

#include <algorithm>

namespace proleg::canopen {

void SdoClientPool::begin(JointMask joints, Microseconds timeout_us, Microseconds pause_us) {
  channels_ = {};
  waiting_ = joints;
  timeout_us_ = timeout_us;
  pause_us_ = pause_us;
  pause_ends_ = 0;
}

void SdoClientPool::cancel(unsigned joint) {
  waiting_.erase(joint);
  for (Channel& channel : channels_) {
    if (channel.is_busy && channel.joint == joint) {
      channel = {};
    }
  }
}

bool SdoClientPool::done() const {
  for (const Channel& channel : channels_) {
    if (channel.is_busy) {
      return false;
    }
  }
  return waiting_.empty();
}

/// Finds the channel's next step: that of the present joint, or of the next joint if the present list is done.
bool SdoClientPool::assign(Channel& channel, SdoStep& step, SdoWork& work) {
  for (;;) {
    if (!channel.is_busy) {
      if (waiting_.empty()) {
        return false;
      }
      channel = {};
      channel.is_busy = true;
      channel.joint = static_cast<std::uint8_t>(waiting_.front());
      waiting_.erase(channel.joint);
    }
    if (const std::optional<SdoStep> next = work.step(channel.joint, channel.position)) {
      step = *next;
      return true;
    }
    channel.is_busy = false;
  }
}

void SdoClientPool::send(Microseconds now, std::span<const std::uint8_t> nodes, TransmitQueue& queue, SdoWork& work) {
  if (now < pause_ends_) {
    return;
  }
  pause_ends_ = 0;
  // If there are pauses, only one client works.
  for (Channel& channel : std::span(channels_).first(pause_us_ == 0 ? clients : 1)) {
    if (channel.client.state() == SdoClient::State::waiting) {
      continue;
    }
    SdoStep step;
    if (queue.size() + reserve >= TransmitQueue::capacity || !assign(channel, step, work)) {
      continue;
    }
    channel.is_read = !step.is_write;
    const std::uint8_t node = nodes[channel.joint];
    const CanFrame request = step.is_write
                                 ? channel.client.write(now, node, step.address, step.size, step.value, timeout_us_)
                                 : channel.client.read(now, node, step.address, timeout_us_);
    static_cast<void>(queue.push(request));  // the queue has room
  }
}

void SdoClientPool::receive(Microseconds now, const CanFrame& frame, SdoWork& work) {
  for (Channel& channel : channels_) {
    if (channel.client.receive(frame)) {
      finish(now, channel, work);
      return;
    }
  }
}

void SdoClientPool::poll(Microseconds now, SdoWork& work) {
  for (Channel& channel : channels_) {
    if (channel.client.next_deadline() <= now) {
      channel.client.poll(now);
      if (++channel.attempts < attempts_) {
        channel.client = {};  // send() begins the step again
        pause_ends_ = pause_us_ == 0 ? 0 : now + pause_us_;
      } else {
        finish(now, channel, work);
      }
    }
  }
}

void SdoClientPool::finish(Microseconds now, Channel& channel, SdoWork& work) {
  pause_ends_ = pause_us_ == 0 ? 0 : now + pause_us_;
  const SdoClient client = channel.client;
  const std::size_t position = channel.position++;
  channel.attempts = 0;
  if (client.state() == SdoClient::State::aborted) {
    channel.is_busy = false;
    work.on_abort(channel.joint, client.address(), client.abort_code());
  } else if (channel.is_read && !work.on_value(channel.joint, position, client.value())) {
    channel.is_busy = false;
  }
}

Microseconds SdoClientPool::next_deadline() const {
  Microseconds next = pause_ends_ == 0 ? never : pause_ends_;
  for (const Channel& channel : channels_) {
    next = std::min(next, channel.client.next_deadline());
  }
  return next;
}

}  // namespace proleg::canopen
