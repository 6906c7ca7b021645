#include "host/robot/sdo_queue.hpp"

#include <algorithm>
#include <utility>

namespace proleg::host {

std::uint32_t SdoResult::number() const {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(value.size(), 4); ++i) {
    number |= std::uint32_t{value[i]} << (8 * i);
  }
  return number;
}

void SdoQueue::read(std::uint8_t node, canopen::Address address, Done done) {
  add(node, {address, std::nullopt, std::move(done)});
}

void SdoQueue::write(std::uint8_t node, canopen::Address address, std::span<const std::uint8_t> data, Done done) {
  add(node, {address, std::vector<std::uint8_t>(data.begin(), data.end()), std::move(done)});
}

void SdoQueue::write(std::uint8_t node, canopen::Address address, canopen::DataType type, std::uint32_t value,
                     Done done) {
  std::array<std::uint8_t, 4> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes.at(i) = static_cast<std::uint8_t>(value >> (8 * i));
  }
  write(node, address, std::span(bytes).first(canopen::size_of(type)), std::move(done));
}

void SdoQueue::add(std::uint8_t node, Job job) {
  jobs_.at(node).push_back(std::move(job));
  ++unfinished_;
  ++waiting_;
  is_new_ = true;
}

void SdoQueue::receive(Microseconds now, const CanFrame& frame) {
  for (const auto& channel : channels_) {
    channel->transfer.receive(now, frame);
  }
  advance(now);
}

void SdoQueue::transmitted(Microseconds now, const CanFrame& /*frame*/) { advance(now); }

void SdoQueue::poll(Microseconds now) {
  for (const auto& channel : channels_) {
    if (channel->transfer.next_deadline() <= now) {
      channel->transfer.poll(now);
    }
  }
  advance(now);
}

Microseconds SdoQueue::next_deadline() const {
  if (is_new_) {
    return 0;
  }
  Microseconds next = never;
  for (const auto& channel : channels_) {
    next = std::min(next, channel->transfer.next_deadline());
  }
  return next;
}

void SdoQueue::advance(Microseconds now) {
  // A transfer that ends makes room for the next one.
  for (bool changes = true; changes;) {
    is_new_ = false;
    begin_jobs();
    send(now);
    const std::size_t before = unfinished_;
    finish_ended(now);
    changes = unfinished_ != before || is_new_;
  }
}

void SdoQueue::begin_jobs() {
  for (std::uint8_t node = 1; waiting_ > 0 && channels_.size() < max_parallel && node < jobs_.size(); ++node) {
    const bool is_busy =
        std::ranges::any_of(channels_, [node](const auto& channel) { return channel->transfer.node() == node; });
    if (is_busy || jobs_.at(node).empty()) {
      continue;
    }
    auto channel = std::make_unique<Channel>();
    channel->job = std::move(jobs_.at(node).front());
    jobs_.at(node).pop_front();
    --waiting_;
    if (channel->job.data) {
      channel->transfer.download(node, channel->job.address, *channel->job.data, options_);
    } else {
      channel->buffer.resize(max_size);
      channel->transfer.upload(node, channel->job.address, channel->buffer, options_);
    }
    channels_.push_back(std::move(channel));
  }
}

void SdoQueue::send(Microseconds now) {
  bool has_room = true;
  for (const auto& channel : channels_) {
    // A transfer that has ended may have a last frame, so frames are taken from all transfers, also if the port has no
    // room.
    for (;;) {
      if (!channel->waiting) {
        channel->waiting = channel->transfer.next_frame(now);
      }
      if (!channel->waiting || !has_room) {
        break;
      }
      has_room = port_.send(*channel->waiting);
      if (has_room) {
        channel->begin = channel->begin.value_or(now);
        channel->waiting.reset();
      }
    }
  }
}

void SdoQueue::finish_ended(Microseconds now) {
  using State = canopen::SdoTransfer::State;
  std::vector<std::unique_ptr<Channel>> ended;
  std::erase_if(channels_, [&ended](std::unique_ptr<Channel>& channel) {
    const State state = channel->transfer.state();
    const bool is_over = state == State::aborted || (state == State::done && !channel->waiting);
    if (!is_over) {
      return false;
    }
    ended.push_back(std::move(channel));
    return true;
  });
  for (const auto& channel : ended) {
    SdoResult result;
    result.attempts = channel->transfer.attempts();
    result.elapsed_us = now - channel->begin.value_or(now);
    if (channel->transfer.state() == State::aborted) {
      result.abort_code = channel->transfer.abort_code();
    } else if (!channel->job.data) {
      result.value.assign(channel->buffer.begin(), channel->buffer.begin() + channel->transfer.size());
    }
    std::deque<Job> given_up;
    if (result.abort_code == canopen::AbortCode::timeout) {
      given_up.swap(jobs_.at(channel->transfer.node()));
      waiting_ -= given_up.size();
    }
    given_up.push_front(std::move(channel->job));
    unfinished_ -= given_up.size();
    for (const Job& job : given_up) {
      if (job.done) {
        job.done(result);
      }
    }
  }
}

}  // namespace proleg::host
