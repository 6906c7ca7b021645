#pragma once

// Brings an image to some modules of a robot at once, and follows each until it runs: transfer by broadcast,
// installation by the bootloaders, restart, confirmation. Nothing is reported as done that the running program does not
// say of itself.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/flash/module_query.hpp"
#include "host/robot/bus_user.hpp"
#include "shared/broadcast/image_sender.hpp"

namespace proleg::host {

enum class UpdateOutcome : std::uint8_t {
  pending,
  runs,              ///< the image, confirmed
  vanished,          ///< answers no more
  belongs_to_other,  ///< another host flashes it
  refused,           ///< the image: detail is an image::Error, or broadcast::refused_busy
  flash_failed,      ///< the flash does not do what it should
  not_transferred,   ///< runs the program before, without having received the whole image
  old_program_runs,  ///< the new one was not installed, or has failed its trial
  not_confirmed,     ///< it runs on trial, and was not confirmed in time
  starts_badly,      ///< the bootloader has given it up
};

/// For a person, without a full stop.
[[nodiscard]] std::string describe(UpdateOutcome outcome, std::uint8_t detail);

struct UpdatedModule {
  std::uint32_t serial = 0;
  UpdateOutcome outcome = UpdateOutcome::pending;
  std::uint8_t detail = 0;
  bool has_image = false;  ///< it has reported that it received all of it
  ModuleProgram program;   ///< what it said last
};

struct UpdateOptions {
  std::uint8_t session = 1;  ///< 1 to 255, random
  /// The host reaches the bus through the serial line of the module, which ends for a few seconds. There is one module.
  bool through_its_line = false;
  Microseconds install_timeout_us = 15'000'000;
  Microseconds restart_timeout_us = 20'000'000;  ///< from the restart to the confirmation: several trials
  /// Transfers to a module at most, the first one included. Another one follows if the module has found the image
  /// damaged: the host's image is good, so it was changed on the way.
  unsigned attempts = 3;
};

class RobotUpdate final : public BusUser, private CanPort {
 public:
  enum class Step : std::uint8_t { transfer, installation, restart, done };

  /// image: as a file has it. port and image must outlive this.
  RobotUpdate(CanPort& port, std::span<const std::uint8_t> image, const std::vector<std::uint32_t>& serials,
              const UpdateOptions& options);
  RobotUpdate(const RobotUpdate&) = delete;
  RobotUpdate& operator=(const RobotUpdate&) = delete;

  void start(Microseconds now);
  [[nodiscard]] Step step() const { return step_; }
  [[nodiscard]] bool is_done() const { return step_ == Step::done; }
  [[nodiscard]] const std::vector<UpdatedModule>& modules() const { return modules_; }
  /// Of the transfer, 0 to 1.
  [[nodiscard]] double progress() const;
  /// What the transfers, the installations and the restart have taken.
  [[nodiscard]] Microseconds duration(Step step) const { return durations_[static_cast<std::size_t>(step)]; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  /// Frames that the transport has not confirmed: more would wait in its queue, and requests behind them.
  static constexpr unsigned max_unconfirmed = 64;
  /// A confirmation that takes longer is lost.
  static constexpr Microseconds longest_confirmation_us = 250'000;
  /// Some adapters confirm frames that still wait for the bus, and drop those for which they have no room. So the host
  /// is only so far ahead of the bus.
  static constexpr Microseconds longest_lead_us = 8'000;
  static constexpr unsigned leave_repetitions = 4;

  [[nodiscard]] bool send(const CanFrame& frame) override;  ///< of the sender
  void prepare_attempt(const std::vector<std::uint32_t>& serials);
  void send_again(Microseconds now, const std::vector<std::uint32_t>& serials);
  void follow_sender(Microseconds now);
  void take_results();
  /// Modules that have found the image damaged.
  [[nodiscard]] std::vector<std::uint32_t> damaged() const;
  void enter(Microseconds now, Step step);
  void send_leave(Microseconds now);
  void look(Microseconds now);
  void take_answers(Microseconds now);
  void take_answer(UpdatedModule& module, const ModuleProgram& program, bool is_last);
  [[nodiscard]] bool any_pending() const;

  CanPort& port_;
  std::span<const std::uint8_t> image_;
  const image::Header header_;
  const UpdateOptions options_;
  std::vector<UpdatedModule> modules_;
  std::uint8_t session_;  ///< of the present attempt; those before had the numbers before
  unsigned attempts_ = 0;
  std::vector<broadcast::Target> targets_;  ///< of the present attempt
  std::optional<broadcast::ImageSender> sender_;
  std::unique_ptr<ModuleQuery> query_;

  Step step_ = Step::transfer;
  Microseconds now_ = 0;
  Microseconds step_began_at_ = 0;
  std::array<Microseconds, 4> durations_{};
  unsigned unconfirmed_ = 0;
  Microseconds confirmation_ends_ = never;
  Microseconds bus_is_free_at_ = 0;  ///< when it has carried the sender's frames and those that came
  Microseconds resume_at_ = never;   ///< frames wait until then, because of longest_lead_us
  Microseconds look_at_ = never;
  Microseconds restart_ends_ = never;
};

}  // namespace proleg::host
