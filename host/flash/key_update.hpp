#pragma once

// Gives modules their first key, over the bus (shared/image/image_trust.hpp). It goes the way of an image: into RAM,
// and after a restart to the bootloader, which keeps it.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "shared/broadcast/image_sender.hpp"
#include "shared/image/image_trust.hpp"

namespace proleg::host {

class KeyUpdate final : public BusUser {
 public:
  /// session: 1 to 255, random. port must outlive this.
  KeyUpdate(CanPort& port, const image::PublicKey& key, std::span<const std::uint32_t> serials, std::uint8_t session);
  KeyUpdate(const KeyUpdate&) = delete;
  KeyUpdate& operator=(const KeyUpdate&) = delete;

  void start(Microseconds now);
  /// Whether each module has answered or is lost, and was asked to start its program.
  [[nodiscard]] bool is_done() const { return is_done_; }
  /// The results, in the order of the serial numbers.
  [[nodiscard]] const std::vector<broadcast::Target>& targets() const { return targets_; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override { return is_done_ ? never : sender_.next_deadline(); }

 private:
  void follow(Microseconds now);

  CanPort& port_;
  const std::array<std::uint8_t, image::key_message_size> message_;
  const std::uint8_t session_;
  std::vector<broadcast::Target> targets_;
  broadcast::ImageSender sender_;
  bool is_done_ = false;
};

/// What became of a module, for a person, without a full stop; empty: it has kept the key.
[[nodiscard]] std::string key_failure(const broadcast::Target& target);

}  // namespace proleg::host
