#include "shared/computer/master/sdo_client.hpp"

#include <algorithm>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/sdo_frame.hpp"

namespace proleg::canopen {

CanFrame SdoClient::read(Microseconds now, std::uint8_t node, Address address, Microseconds timeout_us) {
  writing_ = false;
  CanFrame request = start(now, node, address, timeout_us);
  request.data[0] = sdo::request_upload;
  return request;
}

CanFrame SdoClient::write(Microseconds now, std::uint8_t node, Address address, std::uint8_t size, std::uint32_t value,
                          Microseconds timeout_us) {
  writing_ = true;
  CanFrame request = start(now, node, address, std::max(timeout_us, min_write_timeout_us(address)));
  request.data[0] = sdo::with_size(sdo::request_download, size);
  write_little_endian(request.data, 4, size, value);
  return request;
}

CanFrame SdoClient::start(Microseconds now, std::uint8_t node, Address address, Microseconds timeout_us) {
  state_ = State::waiting;
  node_ = node;
  address_ = address;
  value_ = 0;
  size_ = 0;
  abort_code_ = AbortCode::none;
  deadline_ = now + timeout_us;
  return sdo::make(static_cast<std::uint16_t>(identifier::sdo_request + node), 0, address);
}

bool SdoClient::receive(const CanFrame& frame) {
  if (state_ != State::waiting || frame.identifier != identifier::sdo_answer + node_ || frame.length != 8 ||
      sdo::address(frame) != address_) {
    return false;
  }
  const std::uint8_t command = frame.data[0];
  if (command == sdo::abort) {
    return finish(State::aborted, static_cast<AbortCode>(sdo::data(frame)));
  }
  if (writing_) {
    return command == sdo::answer_download && finish(State::done, AbortCode::none);
  }
  if (sdo::specifier(frame) != sdo::answer_upload) {
    return false;
  }
  if ((command & sdo::expedited) == 0) {
    return finish(State::aborted, AbortCode::unknown_command);
  }
  const std::uint8_t indicated = sdo::indicated_size(command);
  size_ = indicated != 0 ? indicated : std::uint8_t{4};
  value_ = sdo::data(frame, size_);
  return finish(State::done, AbortCode::none);
}

void SdoClient::poll(Microseconds now) {
  if (state_ == State::waiting && now >= deadline_) {
    finish(State::aborted, AbortCode::timeout);
  }
}

bool SdoClient::finish(State state, AbortCode code) {
  state_ = state;
  abort_code_ = code;
  return true;
}

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

/// Finds the channel's next request: that of the present joint, or of the next joint if the present list is done.
bool SdoClientPool::assign(Channel& channel, SdoRequest& request, SdoWork& work) {
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
    if (const std::optional<SdoRequest> next = work.request(channel.joint, channel.position)) {
      request = *next;
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
    SdoRequest request;
    if (queue.size() + reserve >= TransmitQueue::capacity || !assign(channel, request, work)) {
      continue;
    }
    channel.is_read = request.is_read();
    static_cast<void>(queue.push(channel.client.begin(now, nodes[channel.joint], request, timeout_us_)));  // has room
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
        channel.client = {};  // send() begins the request again
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
