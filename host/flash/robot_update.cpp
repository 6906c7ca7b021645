#include "host/flash/robot_update.hpp"

#include <algorithm>

#include "host/robot/frame_load.hpp"

namespace proleg::host {
namespace {

namespace flag = broadcast::module_flag;
using broadcast::ImageSender;
using broadcast::ReceiverState;

std::uint8_t after(std::uint8_t session) { return session == 0xFF ? 1 : static_cast<std::uint8_t>(session + 1U); }

Microseconds duration_of(const CanFrame& frame) {
  return static_cast<Microseconds>(average_bits(frame) * 1e6 / bus_bit_rate);
}

/// Whether an error shows that the image was changed on the way: the host's image cannot have it.
bool is_damage(std::uint8_t detail) {
  switch (static_cast<image::Error>(detail)) {
    case image::Error::not_an_image:
    case image::Error::unknown_format:
    case image::Error::damaged_header:
    case image::Error::wrong_length:
    case image::Error::damaged_body:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::string describe(UpdateOutcome outcome, std::uint8_t detail) {
  switch (outcome) {
    case UpdateOutcome::pending:
      return "not done yet";
    case UpdateOutcome::runs:
      return "runs the image";
    case UpdateOutcome::vanished:
      return "answers no more";
    case UpdateOutcome::belongs_to_other:
      return "another host flashes it";
    case UpdateOutcome::refused:
      return "has refused the image: " +
             (detail == broadcast::refused_busy     ? "its servo has power, it is Operational, or its supply is too low"
              : detail == broadcast::refused_supply ? "its supply voltage is too low to write the flash"
              : detail == broadcast::refused_size   ? "it has no room for so many bytes"
                                                    : std::string(image::describe(static_cast<image::Error>(detail))));
    case UpdateOutcome::flash_failed:
      return "its flash has failed; at its next start it restores the program before";
    case UpdateOutcome::not_transferred:
      return "runs the program before: it did not get the whole image; the same command again completes it";
    case UpdateOutcome::old_program_runs:
      return "runs the program before: the new one was not installed, or did not start well";
    case UpdateOutcome::not_confirmed:
      return "runs the image on trial, and was not confirmed in time";
    case UpdateOutcome::starts_badly:
      return "its bootloader answers, the program does not start";
  }
  return "unknown";
}

RobotUpdate::RobotUpdate(CanPort& port, std::span<const std::uint8_t> image, const std::vector<std::uint32_t>& serials,
                         const UpdateOptions& options)
    : port_(port), image_(image), header_(image::decode(image).header), options_(options), session_(options.session) {
  for (const std::uint32_t serial : serials) {
    modules_.push_back({serial, UpdateOutcome::pending, 0, false, {}});
  }
  prepare_attempt(serials);
}

void RobotUpdate::prepare_attempt(const std::vector<std::uint32_t>& serials) {
  ++attempts_;
  sender_.reset();
  targets_.clear();
  for (const std::uint32_t serial : serials) {
    targets_.push_back({serial, {}, false});
  }
  broadcast::SenderOptions options;
  options.session = session_;
  options.install_timeout_us = options_.install_timeout_us;
  sender_.emplace(static_cast<CanPort&>(*this), image_, targets_, options);
}

void RobotUpdate::start(Microseconds now) {
  now_ = now;
  step_began_at_ = now;
  sender_->start(now);
  follow_sender(now);
}

/// Sends the image again in a session of its own, because the modules that have installed it wait for the end of
/// theirs.
void RobotUpdate::send_again(Microseconds now, const std::vector<std::uint32_t>& serials) {
  enter(now, Step::transfer);
  for (UpdatedModule& module : modules_) {
    if (std::ranges::find(serials, module.serial) != serials.end()) {
      module.outcome = UpdateOutcome::pending;
      module.has_image = false;
    }
  }
  session_ = after(session_);
  prepare_attempt(serials);
  sender_->start(now);
  follow_sender(now);
}

double RobotUpdate::progress() const {
  const double all = static_cast<double>(broadcast::blocks_of(image_.size())) * broadcast::block_symbols;
  return step_ == Step::transfer ? std::min(1.0, sender_->symbols_sent() / std::max(all, 1.0)) : 1.0;
}

bool RobotUpdate::send(const CanFrame& frame) {
  if (bus_is_free_at_ > now_ + longest_lead_us) {
    resume_at_ = bus_is_free_at_ - longest_lead_us / 2;
    return false;
  }
  if (unconfirmed_ >= max_unconfirmed || !port_.send(frame)) {
    return false;
  }
  bus_is_free_at_ = std::max(bus_is_free_at_, now_) + duration_of(frame);
  ++unconfirmed_;
  confirmation_ends_ = now_ + longest_confirmation_us;
  return true;
}

void RobotUpdate::transmitted(Microseconds now, const CanFrame& frame) {
  now_ = now;
  if (query_) {
    query_->transmitted(now, frame);
  }
  if (frame.identifier != broadcast::host_identifier || step_ > Step::installation) {
    return;
  }
  unconfirmed_ -= unconfirmed_ == 0 ? 0U : 1U;
  confirmation_ends_ = unconfirmed_ == 0 ? never : now + longest_confirmation_us;
  sender_->transmitted(now);
  follow_sender(now);
}

void RobotUpdate::receive(Microseconds now, const CanFrame& frame) {
  now_ = now;
  bus_is_free_at_ = std::max(bus_is_free_at_, now) + duration_of(frame);
  if (query_) {
    query_->receive(now, frame);
    take_answers(now);
  } else if (step_ <= Step::installation) {
    sender_->receive(now, frame);
    follow_sender(now);
  }
}

void RobotUpdate::poll(Microseconds now) {
  now_ = now;
  if (step_ <= Step::installation) {
    if (now >= confirmation_ends_) {
      unconfirmed_ = 0;
      confirmation_ends_ = never;
      resume_at_ = now;
    }
    if (now >= resume_at_) {
      resume_at_ = never;
      sender_->transmitted(now);
    }
    sender_->poll(now);
    follow_sender(now);
  } else if (query_) {
    query_->poll(now);
    take_answers(now);
  } else if (now >= look_at_) {
    look(now);
  }
}

Microseconds RobotUpdate::next_deadline() const {
  switch (step_) {
    case Step::done:
      return never;
    case Step::restart:
      return query_ ? query_->next_deadline() : look_at_;
    default:
      return std::min({sender_->next_deadline(), confirmation_ends_, resume_at_});
  }
}

void RobotUpdate::follow_sender(Microseconds now) {
  if (step_ == Step::transfer && sender_->state() == ImageSender::State::complete) {
    enter(now, Step::installation);
    sender_->install(now);
  }
  if (sender_->state() == ImageSender::State::done) {
    if (step_ == Step::transfer) {
      enter(now, Step::installation);
    }
    take_results();
    const std::vector<std::uint32_t> again = damaged();
    if (again.empty() || attempts_ >= options_.attempts) {
      enter(now, Step::restart);
    } else {
      send_again(now, again);
    }
  }
}

std::vector<std::uint32_t> RobotUpdate::damaged() const {
  std::vector<std::uint32_t> serials;
  for (const UpdatedModule& module : modules_) {
    if (module.outcome == UpdateOutcome::refused && is_damage(module.detail)) {
      serials.push_back(module.serial);
    }
  }
  return serials;
}

void RobotUpdate::take_results() {
  for (const broadcast::Target& target : targets_) {
    const broadcast::StatusAnswer& status = target.status;
    UpdatedModule& module = *std::ranges::find(modules_, target.serial, &UpdatedModule::serial);
    module.detail = status.error;
    module.has_image = status.session == session_ && status.state >= ReceiverState::complete;
    if (status.session != 0 && status.session != session_) {
      module.outcome = UpdateOutcome::belongs_to_other;
    } else if (status.state == ReceiverState::refused) {
      module.outcome = UpdateOutcome::refused;
    } else if (status.state == ReceiverState::failed) {
      module.outcome = UpdateOutcome::flash_failed;
    }
    // A module that does not answer may be restarting; the code below finds out.
  }
}

void RobotUpdate::enter(Microseconds now, Step step) {
  constexpr Microseconds restart_time_us = 100'000;
  durations_.at(static_cast<std::size_t>(step_)) += now - step_began_at_;
  step_began_at_ = now;
  step_ = step;
  if (step == Step::restart) {
    send_leave(now);
    look_at_ = now + restart_time_us;
    restart_ends_ = now + options_.restart_timeout_us;
    if (!any_pending()) {
      enter(now, Step::done);
    }
  }
}

/// Sends the frame that ends the sessions several times, because it has no answer and may be lost.
void RobotUpdate::send_leave(Microseconds /*now*/) {
  std::uint8_t session = options_.session;
  for (unsigned attempt = 0; attempt < attempts_; ++attempt, session = after(session)) {
    for (unsigned i = 0; i < leave_repetitions; ++i) {
      static_cast<void>(port_.send(broadcast::leave_frame(session)));
    }
  }
}

bool RobotUpdate::any_pending() const {
  return std::ranges::any_of(modules_,
                             [](const UpdatedModule& module) { return module.outcome == UpdateOutcome::pending; });
}

void RobotUpdate::look(Microseconds now) {
  std::vector<std::uint32_t> serials;
  for (const UpdatedModule& module : modules_) {
    if (module.outcome == UpdateOutcome::pending) {
      serials.push_back(module.serial);
    }
  }
  // A module that restarts answers nothing; the last look decides.
  constexpr unsigned attempts_before_the_end = 3;
  is_last_look_ = now >= restart_ends_;
  query_ = std::make_unique<ModuleQuery>(
      port_, is_last_look_ ? ModuleQueryOptions() : ModuleQueryOptions{.attempts = attempts_before_the_end});
  query_->start(now, serials);
}

void RobotUpdate::take_answers(Microseconds now) {
  if (!query_->is_done()) {
    return;
  }
  bool is_still_in_bootloader = false;
  for (const ModuleProgram& program : query_->modules()) {
    for (UpdatedModule& module : modules_) {
      if (module.serial == program.serial && module.outcome == UpdateOutcome::pending) {
        take_answer(module, program);
      }
    }
    is_still_in_bootloader = is_still_in_bootloader || (program.has_answered && !program.is(flag::runs_program));
  }
  query_.reset();
  if (!any_pending()) {
    enter(now, Step::done);
    return;
  }
  constexpr Microseconds pause_us = 50'000;
  look_at_ = now + pause_us;
  if (is_still_in_bootloader) {
    send_leave(now);
  }
}

void RobotUpdate::take_answer(UpdatedModule& module, const ModuleProgram& program) {
  if (program.has_answered) {
    module.program = program;
  }
  const bool is_new = program.image && *program.image == header_;
  const bool runs = program.has_answered && program.is(flag::runs_program);
  if (runs && is_new && program.is(flag::is_confirmed)) {
    module.outcome = UpdateOutcome::runs;
  } else if (runs && program.image && !is_new && !options_.through_its_line) {
    module.outcome = module.has_image ? UpdateOutcome::old_program_runs : UpdateOutcome::not_transferred;
  } else if (is_last_look_) {
    module.outcome = !program.has_answered || program.missing_words != 0 ? UpdateOutcome::vanished
                     : !runs                                             ? UpdateOutcome::starts_badly
                     : is_new                                            ? UpdateOutcome::not_confirmed
                     : module.has_image                                  ? UpdateOutcome::old_program_runs
                                                                         : UpdateOutcome::not_transferred;
  }
}

}  // namespace proleg::host
