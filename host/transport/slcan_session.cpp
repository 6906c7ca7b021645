#include "host/transport/slcan_session.hpp"

#include <utility>

namespace proleg::host {

SlcanSession::SlcanSession(boost::asio::io_context& context, Descriptor descriptor,
                           const SlcanAdapter::Settings& settings, Functions functions)
    : functions_(std::move(functions)),
      adapter_(buffer_, *this, settings),
      stream_(context, std::move(descriptor), false, *this) {}

void SlcanSession::received(Microseconds time, const CanFrame& frame) {
  adapter_.received(time, frame);
  flush();
}

void SlcanSession::status_changed(const CanStatus& status) {
  adapter_.status_changed(status);
  flush();
}

void SlcanSession::errors_occurred(CanErrors errors) {
  adapter_.errors_occurred(errors);
  flush();
}

std::size_t SlcanSession::read_room() {
  const std::size_t room = adapter_.input_room();
  is_waiting_ = room == 0;
  return room;
}

void SlcanSession::read(std::string_view bytes) {
  adapter_.input(bytes);
  flush();
}

std::string SlcanSession::take_output(std::size_t max_bytes) {
  std::string output(max_bytes, '\0');
  output.resize(adapter_.take(output));
  if (is_waiting_ && adapter_.input_room() > 0) {
    is_waiting_ = false;
    stream_.resume();
  }
  return output;
}

void SlcanSession::ended(int error) {
  // A copy is called, because the function may destroy the session.
  const auto function = functions_.ended;
  function(error);
}

void SlcanSession::flush() {
  if (adapter_.has_output()) {
    stream_.flush();
  }
}

}  // namespace proleg::host
