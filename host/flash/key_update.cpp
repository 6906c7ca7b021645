#include "host/flash/key_update.hpp"

#include "host/flash/robot_update.hpp"

namespace proleg::host {
namespace {

using broadcast::ImageSender;
using broadcast::ReceiverState;

std::vector<broadcast::Target> targets_of(std::span<const std::uint32_t> serials) {
  std::vector<broadcast::Target> targets;
  for (const std::uint32_t serial : serials) {
    targets.push_back({serial, {}, false});
  }
  return targets;
}

broadcast::SenderOptions options_of(std::uint8_t session) {
  broadcast::SenderOptions options;
  options.session = session;
  return options;
}

}  // namespace

KeyUpdate::KeyUpdate(CanPort& port, const image::PublicKey& key, std::span<const std::uint32_t> serials,
                     std::uint8_t session)
    : port_(port),
      message_(image::encode_key(key)),
      session_(session),
      targets_(targets_of(serials)),
      sender_(port, message_, targets_, options_of(session)) {}

void KeyUpdate::start(Microseconds now) {
  sender_.start(now);
  follow(now);
}

void KeyUpdate::receive(Microseconds now, const CanFrame& frame) {
  if (!is_done_) {
    sender_.receive(now, frame);
    follow(now);
  }
}

void KeyUpdate::transmitted(Microseconds now, const CanFrame& frame) {
  if (!is_done_ && frame.identifier == broadcast::host_identifier) {
    sender_.transmitted(now);
    follow(now);
  }
}

void KeyUpdate::poll(Microseconds now) {
  if (!is_done_) {
    sender_.poll(now);
    follow(now);
  }
}

void KeyUpdate::follow(Microseconds now) {
  if (sender_.state() == ImageSender::State::complete) {
    sender_.install(now);
  }
  if (sender_.state() == ImageSender::State::done) {
    is_done_ = true;
    constexpr unsigned repetitions = 4;  // nothing answers it
    for (unsigned i = 0; i < repetitions; ++i) {
      static_cast<void>(port_.send(broadcast::leave_frame(session_)));
    }
  }
}

std::string key_failure(const broadcast::Target& target) {
  switch (target.status.state) {
    case ReceiverState::installed:
      return target.is_lost ? "answers no more" : "";
    case ReceiverState::refused:
      return describe(UpdateOutcome::refused, target.status.error);
    case ReceiverState::failed:
      return "its flash has failed";
    default:
      return target.is_lost ? "answers no more" : "another host flashes it";
  }
}

}  // namespace proleg::host
