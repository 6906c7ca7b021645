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

}  // namespace proleg::canopen
