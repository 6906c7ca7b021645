#include "sim/mcu/debug/gdb_server.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace proleg::sim {
namespace {

constexpr int poll_period_ms = 100;  // between two calls of Interrupted

}  // namespace

GdbServer::GdbServer(std::uint16_t port, DebugTarget& target) : listener_(port), commands_(target) {}

bool GdbServer::wait_for_client(const Interrupted& interrupted) {
  while (!connection_) {
    if (interrupted && interrupted()) {
      return false;
    }
    static_cast<void>(wait(listener_, nullptr, false, poll_period_ms).listener && accept_client());
  }
  return true;
}

Resume GdbServer::serve(StopReason reason, const Interrupted& interrupted) {
  commands_.set_stop_reason(reason);
  if (std::exchange(awaits_stop_, false)) {
    send(commands_.stop_reply());
  }
  while (connection_) {
    if (interrupted && interrupted()) {
      return Resume::interrupted;
    }
    // The client must read an answer before it gets the next one, so that the buffer stays small.
    flush();
    if (connection_ && unsent_.empty()) {
      if (const auto input = next_input()) {
        if (const auto resume = handle(*input)) {
          return *resume;
        }
        continue;
      }
    }
    if (connection_) {
      const Ready ready = wait(listener_, &*connection_, !unsent_.empty(), poll_period_ms);
      if (ready.connection && unsent_.empty()) {
        receive();
      }
      static_cast<void>(ready.listener && accept_client());
    }
  }
  return Resume::detach;
}

bool GdbServer::interrupt_requested() {
  if (unanswered_) {
    return true;
  }
  flush();
  Ready ready = wait(listener_, connection_ ? &*connection_ : nullptr, false, 0);
  bool requested = false;
  while (connection_ && !requested) {
    if (auto input = decoder_.next()) {
      if (input->kind == GdbInput::Kind::interrupt) {
        requested = true;
      } else if (input->kind == GdbInput::Kind::accepted || input->kind == GdbInput::Kind::refused) {
        static_cast<void>(handle(*input));
      } else {
        // A client that sends a command while the target runs would wait without end.
        unanswered_ = std::move(input);
        requested = true;
      }
    } else if (std::exchange(ready.connection, false)) {
      receive();
    } else {
      break;
    }
  }
  return (ready.listener && accept_client()) || requested;
}

void GdbServer::send_text(std::string_view text) {
  if (!awaits_stop_ || !unsent_.empty()) {
    return;
  }
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  constexpr std::size_t max_bytes = GdbDecoder::max_packet / 2 - 1;
  send("O" + to_hex(std::span(bytes).first(std::min(bytes.size(), max_bytes))));
}

void GdbServer::finish(std::uint8_t status) {
  if (std::exchange(awaits_stop_, false)) {
    send("W" + to_hex({&status, 1}));
  }
  disconnect();
}

bool GdbServer::accept_client() {
  // A second client is accepted and closed at once: it would wait without an answer otherwise.
  auto connection = listener_.accept();
  if (!connection || connection_) {
    return false;
  }
  connection_.emplace(std::move(*connection));
  return true;
}

void GdbServer::disconnect() {
  connection_.reset();
  decoder_ = {};
  unanswered_.reset();
  unsent_.clear();
  last_packet_.clear();
  acknowledges_ = true;
  awaits_stop_ = false;
  commands_.clear_breakpoints();
}

void GdbServer::receive() {
  std::array<char, 4096> bytes{};
  const std::size_t length = connection_->receive(bytes);
  decoder_.feed({bytes.data(), length});
  if (!connection_->open()) {
    disconnect();
  }
}

void GdbServer::send(std::string_view payload) {
  last_packet_ = gdb_packet(payload);
  unsent_ += last_packet_;
  flush();
}

void GdbServer::flush() {
  while (connection_ && !unsent_.empty()) {
    const std::size_t sent = connection_->send(unsent_);
    unsent_.erase(0, sent);
    if (!connection_->open()) {
      disconnect();
    } else if (sent == 0) {
      return;
    }
  }
}

std::optional<GdbInput> GdbServer::next_input() {
  if (unanswered_) {
    return std::exchange(unanswered_, std::nullopt);
  }
  return decoder_.next();
}

std::optional<Resume> GdbServer::handle(const GdbInput& input) {
  switch (input.kind) {
    case GdbInput::Kind::interrupt:  // The target has stopped already.
    case GdbInput::Kind::accepted:
      break;
    case GdbInput::Kind::refused:
      if (acknowledges_ && unsent_.empty()) {
        unsent_ = last_packet_;
      }
      break;
    case GdbInput::Kind::damaged:
      if (acknowledges_) {
        unsent_ += '-';
      }
      break;
    case GdbInput::Kind::too_long:
      if (acknowledges_) {
        unsent_ += '+';
      }
      send("E16");  // EINVAL; a repetition would not help
      break;
    case GdbInput::Kind::packet:
      if (acknowledges_) {
        unsent_ += '+';
      }
      return handle_packet(input.payload);
  }
  return std::nullopt;
}

std::optional<Resume> GdbServer::handle_packet(const std::string& payload) {
  if (payload == "QStartNoAckMode") {
    send("OK");
    acknowledges_ = !connection_.has_value();
    return std::nullopt;
  }
  const GdbCommands::Answer answer = commands_.answer(payload);
  if (answer.reply) {
    send(*answer.reply);
  } else {
    flush();
  }
  if (answer.resume == Resume::run || answer.resume == Resume::step) {
    awaits_stop_ = connection_.has_value();
  } else if (answer.resume) {
    disconnect();
  }
  return answer.resume;
}

}  // namespace proleg::sim
