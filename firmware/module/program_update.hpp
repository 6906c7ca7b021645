#pragma once

#include "firmware/module/module_identity.hpp"
#include "firmware/module/ports.hpp"
#include "shared/broadcast/image_receiver.hpp"

namespace proleg::firmware {

/// Replaces the program (docs/flashing.md): collects an image in RAM while the program runs, then restarts into the
/// bootloader, which installs it. After a start it finds out whether the program is good.
class ProgramUpdate final : private broadcast::ReceiverOwner {
 public:
  /// Run time after which a program is confirmed, if it has received a frame, and another node has acknowledged one of
  /// its own: so it can be replaced.
  static constexpr Microseconds trial_us = 500'000;
  /// Run time of a good start. The bootloader does not start a program again that stops sooner several times in a row.
  static constexpr Microseconds good_start_us = 5'000'000;
  /// Time in which the answer to a request for the bootloader is sent, before the program ends.
  static constexpr Microseconds answer_time_us = 20'000;

  ProgramUpdate(const ModuleIdentity& identity, const Ports& ports);
  ProgramUpdate(const ProgramUpdate&) = delete;
  ProgramUpdate& operator=(const ProgramUpdate&) = delete;

  void power_on(Microseconds now);

  /// Conditions under which a request is handled.
  struct Conditions {
    std::uint8_t node = 0;  ///< node id; 0: none
    /// The servo has no power, the module is not Operational, and the supply is good.
    bool may_restart = false;
    bool is_gateway = false;
    bool has_newer_settings = false;  ///< BoardStore::has_newer()
  };
  /// Handles a frame of the host and returns the answer. An image that is to be installed ends the program.
  [[nodiscard]] std::optional<CanFrame> receive(Microseconds now, const CanFrame& frame, const Conditions& conditions);
  /// Must be called when the controller has sent a frame.
  void transmitted() { has_sent_ = true; }
  /// Must be called when the module has received a frame of another node, or of the host on its line.
  void received() { has_received_ = true; }
  /// Must be called when frames were lost, any number.
  void bus_was_lost() { receiver_.bus_was_lost(); }

  /// Whether the program has a bootloader that waits for its confirmation. Any frame that is received counts for it.
  [[nodiscard]] bool is_on_trial() const { return is_on_trial_; }
  /// Id of the key with which images must be signed; 0: the module takes any image.
  [[nodiscard]] std::uint32_t key_id() const { return port_ == nullptr ? 0 : trust().key_id; }

  void poll(Microseconds now, bool may_restart);
  [[nodiscard]] Microseconds next_deadline() const;

 private:
  // Functions of ReceiverOwner.
  [[nodiscard]] broadcast::ModuleCondition condition() const override;
  [[nodiscard]] std::span<const std::uint8_t> image_header() const override;
  [[nodiscard]] broadcast::TrustSummary trust() const override;

  void install(Microseconds now);

  ProgramPort* const port_;  ///< null: no updates
  broadcast::ImageReceiver receiver_;
  Conditions conditions_;
  bool has_sent_ = false;
  bool has_received_ = false;
  bool is_on_trial_ = false;
  Microseconds started_at_ = 0;
  Microseconds confirm_at_ = never;
  Microseconds good_at_ = never;
  Microseconds enter_at_ = never;
};

}  // namespace proleg::firmware
