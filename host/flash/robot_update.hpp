#pragma once

// Transfers an image to some modules of a robot at once, and follows each module until it runs the image: transfer by
// broadcast, installation by the bootloaders, restart, confirmation. A step is reported as done only if the running
// program reports it.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/flash/module_program.hpp"
#include "host/robot/bus_user.hpp"
#include "shared/broadcast/image_sender.hpp"

namespace proleg::host {

enum class UpdateOutcome : std::uint8_t {
  pending,
  runs,              ///< the module runs the image, confirmed
  vanished,          ///< the module does not answer any more
  belongs_to_other,  ///< another host flashes the module
  refused,  ///< the module refuses the image: detail is an image::Error, or broadcast::refused_busy or refused_supply
  flash_failed,      ///< the flash of the module does not work correctly
  not_transferred,   ///< the module runs the old program, and has not received the whole image
  old_program_runs,  ///< the new program was not installed, or has failed its trial
  not_confirmed,     ///< the new program runs on trial, and was not confirmed in time
  starts_badly,      ///< the bootloader does not start the new program any more
};

/// Describes an outcome for a person, without a full stop.
[[nodiscard]] std::string describe(UpdateOutcome outcome, std::uint8_t detail);

struct UpdatedModule {
  std::uint32_t serial = 0;
  UpdateOutcome outcome = UpdateOutcome::pending;
  std::uint8_t detail = 0;
  bool has_image = false;  ///< the module has reported that it received the whole image
  ModuleProgram program;   ///< last report of the module
};

struct UpdateOptions {
  std::uint8_t session = 1;  ///< 1 to 255, random
  /// The host reaches the bus through the serial line of the module, which ends for a few seconds. There is one module.
  bool through_its_line = false;
  Microseconds install_timeout_us = 15'000'000;
  Microseconds restart_timeout_us = 20'000'000;  ///< duration from the restart to the confirmation: several trials
  /// Greatest number of transfers to a module. Another one follows if the module has found the image damaged: the
  /// host's image is good, so it was changed on the way.
  unsigned attempts = 3;
};

class RobotUpdate final : public BusUser, private CanPort {
 public:
  enum class Step : std::uint8_t { transfer, installation, restart, done };

  /// image: the bytes of an image file. port and image must outlive this.
  RobotUpdate(CanPort& port, std::span<const std::uint8_t> image, const std::vector<std::uint32_t>& serials,
              const UpdateOptions& options);
  RobotUpdate(const RobotUpdate&) = delete;
  RobotUpdate& operator=(const RobotUpdate&) = delete;

  void start(Microseconds now);
  [[nodiscard]] Step step() const { return step_; }
  [[nodiscard]] bool is_done() const { return step_ == Step::done; }
  [[nodiscard]] const std::vector<UpdatedModule>& modules() const { return modules_; }
  /// Progress of the transfer, 0 to 1.
  [[nodiscard]] double progress() const;
  /// The duration of the transfers, the installations or the restart.
  [[nodiscard]] Microseconds duration(Step step) const { return durations_[static_cast<std::size_t>(step)]; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  /// Greatest number of frames that the transport has not confirmed: more would wait in its queue, and requests behind
  /// them.
  static constexpr unsigned max_unconfirmed = 64;
  /// A confirmation that takes longer is lost.
  static constexpr Microseconds longest_confirmation_us = 250'000;
  /// Greatest time by which the host is ahead of the bus: some adapters confirm frames that still wait for the bus,
  /// and drop those for which they have no room.
  static constexpr Microseconds longest_lead_us = 8'000;
  static constexpr unsigned leave_repetitions = 4;

  [[nodiscard]] bool send(const CanFrame& frame) override;  ///< sends frames of the sender
  void prepare_attempt(const std::vector<std::uint32_t>& serials);
  void send_again(Microseconds now, const std::vector<std::uint32_t>& serials);
  void follow_sender(Microseconds now);
  void take_results();
  /// The serial numbers of modules that have found the image damaged.
  [[nodiscard]] std::vector<std::uint32_t> damaged() const;
  void enter(Microseconds now, Step step);
  void send_leave(Microseconds now);
  void look(Microseconds now);
  void take_answers(Microseconds now);
  void take_answer(UpdatedModule& module, const ModuleProgram& program);
  [[nodiscard]] bool any_pending() const;

  CanPort& port_;
  std::span<const std::uint8_t> image_;
  const image::Header header_;
  const UpdateOptions options_;
  std::vector<UpdatedModule> modules_;
  std::uint8_t session_;  ///< session of the present attempt; earlier attempts had the numbers before it
  unsigned attempts_ = 0;
  std::vector<broadcast::Target> targets_;  ///< targets of the present attempt
  std::optional<broadcast::ImageSender> sender_;
  std::unique_ptr<ModuleQuery> query_;

  Step step_ = Step::transfer;
  Microseconds now_ = 0;
  Microseconds step_began_at_ = 0;
  std::array<Microseconds, 4> durations_{};
  unsigned unconfirmed_ = 0;
  Microseconds confirmation_ends_ = never;
  Microseconds bus_is_free_at_ = 0;  ///< time at which the bus has carried the frames of the sender and received ones
  Microseconds resume_at_ = never;   ///< time until which frames wait, because of longest_lead_us
  Microseconds look_at_ = never;
  Microseconds restart_ends_ = never;
  bool is_last_look_ = false;  ///< the query began after that time
};

}  // namespace proleg::host
