#include "shared/computer/master/sdo_client_pool.hpp"

#include <algorithm>

#include "shared/fixed/little_endian.hpp"

namespace proleg::canopen {

void SdoClientPool::begin(JointMask joints, Microseconds timeout_us, Microseconds pause_us) {
  channels_ = {};
  answers_us_ = {};
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

JointMask SdoClientPool::unfinished() const {
  JointMask joints = waiting_;
  for (const Channel& channel : channels_) {
    joints |= channel.is_busy ? JointMask::of(channel.joint) : JointMask();
  }
  return joints;
}

/// The next request of a channel: that of the present joint, or of the next joint if the present list is done.
std::optional<SdoRequest> SdoClientPool::next_request(Channel& channel, SdoWork& work) {
  for (;;) {
    if (!channel.is_busy) {
      if (waiting_.empty()) {
        return std::nullopt;
      }
      channel = {};
      channel.is_busy = true;
      channel.joint = static_cast<std::uint8_t>(waiting_.front());
      waiting_.erase(channel.joint);
    }
    if (const std::optional<SdoRequest> request = work.request(channel.joint, channel.position)) {
      return request;
    }
    channel.is_busy = false;
  }
}

/// Begins one attempt. The pool counts the attempts, since it pauses between them.
void SdoClientPool::begin_transfer(Channel& channel, std::uint8_t node, const SdoRequest& request) {
  SdoTransferOptions options;
  options.timeout_us = timeout_us_;
  options.attempts = 1;
  channel.is_read = request.is_read();
  channel.bytes = {};
  if (request.is_read()) {
    channel.transfer.upload(node, request.address, channel.bytes, options);
  } else {
    write_little_endian(channel.bytes, 0, request.size, request.value);
    channel.transfer.download(node, request.address, std::span(channel.bytes).first(request.size), options);
  }
}

void SdoClientPool::send(Microseconds now, std::span<const std::uint8_t> nodes, TransmitQueue& queue, SdoWork& work) {
  if (now < pause_ends_) {
    return;
  }
  pause_ends_ = 0;
  // If there are pauses, only one client works.
  for (Channel& channel : std::span(channels_).first(pause_us_ == 0 ? clients : 1)) {
    if (queue.size() + reserve >= TransmitQueue::capacity) {
      return;
    }
    if (channel.transfer.state() != SdoTransfer::State::running) {
      const std::optional<SdoRequest> request = next_request(channel, work);
      if (!request) {
        continue;
      }
      channel.begin = channel.attempts == 0 ? now : channel.begin;
      begin_transfer(channel, nodes[channel.joint], *request);
    }
    if (const std::optional<CanFrame> frame = channel.transfer.next_frame(now)) {
      static_cast<void>(queue.push(*frame));  // has room
    }
  }
}

void SdoClientPool::receive(Microseconds now, const CanFrame& frame, SdoWork& work) {
  for (Channel& channel : channels_) {
    if (channel.transfer.state() != SdoTransfer::State::running) {
      continue;
    }
    channel.transfer.receive(now, frame);
    if (channel.transfer.state() != SdoTransfer::State::running) {
      finish(now, channel, work);
      return;
    }
  }
}

void SdoClientPool::poll(Microseconds now, SdoWork& work) {
  for (Channel& channel : channels_) {
    if (channel.transfer.next_deadline() > now) {
      continue;
    }
    channel.transfer.poll(now);
    if (++channel.attempts < attempts_) {
      channel.transfer = {};  // send() begins the request again
      pause_ends_ = pause_us_ == 0 ? 0 : now + pause_us_;
    } else {
      finish(now, channel, work);
    }
  }
}

void SdoClientPool::finish(Microseconds now, Channel& channel, SdoWork& work) {
  pause_ends_ = pause_us_ == 0 ? 0 : now + pause_us_;
  const std::size_t position = channel.position++;
  channel.attempts = 0;
  if (channel.transfer.state() != SdoTransfer::State::aborted) {
    answers_us_.add(now - channel.begin);
  }
  // The functions of `work` may cancel the list, so they come last.
  if (channel.transfer.state() == SdoTransfer::State::aborted) {
    const Address address = channel.transfer.address();
    const AbortCode code = channel.transfer.abort_code();
    channel.is_busy = false;
    work.on_abort(channel.joint, address, code);
  } else if (channel.is_read && !work.on_value(channel.joint, position, read_little_endian(channel.bytes, 0, 4))) {
    channel.is_busy = false;
  }
}

Microseconds SdoClientPool::next_deadline() const {
  Microseconds next = pause_ends_ == 0 ? never : pause_ends_;
  for (const Channel& channel : channels_) {
    next = std::min(next, channel.transfer.next_deadline());
  }
  return next;
}

}  // namespace proleg::canopen
