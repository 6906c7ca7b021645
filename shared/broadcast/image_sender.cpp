#include "shared/broadcast/image_sender.hpp"

#include <algorithm>

#include "shared/fixed/crc32.hpp"

namespace proleg::broadcast {
namespace {

/// Number of repair symbols for a module that misses this number of symbols. A ninth more replaces the repair symbols
/// that are lost if a tenth of all frames is lost. A few more make it unlikely that another round is needed.
constexpr unsigned repairs_for(unsigned missing) { return missing + missing / 8 + 6; }

}  // namespace

void ImageSender::start(Microseconds now) {
  state_ = State::sending;
  plan_all_symbols();
  enter(now, Step::select);
}

void ImageSender::install(Microseconds now) {
  if (state_ == State::complete) {
    state_ = State::installing;
    install_ends_ = now + options_.install_timeout_us;
    enter(now, Step::install);
  }
}

void ImageSender::enter(Microseconds now, Step step) {
  step_ = step;
  deadline_ = never;
  is_unsent_ = false;
  target_ = 0;
  block_ = 0;
  announced_ = 0;
  symbol_ = 0;
  switch (step) {
    case Step::send:
      next_block();
      pump(now);
      return;
    case Step::begin:
    case Step::install:
      pump(now);
      return;
    case Step::report:
      missing_.fill(0);
      [[fallthrough]];
    case Step::select:
    case Step::status:
      next_target(now);
      return;
    case Step::idle:
      return;
  }
}

/// Passes frames to the controller until it has no room.
void ImageSender::pump(Microseconds now) {
  if (is_unsent_) {
    --attempt_;
    ask(now);
    return;
  }
  while (step_ == Step::begin || step_ == Step::send || step_ == Step::install) {
    const auto frame = next_broadcast();
    if (!frame) {
      const Step finished = step_;
      begins_again_ = false;
      enter(now, finished == Step::begin ? Step::send : finished == Step::send ? Step::report : Step::status);
      return;
    }
    if (!port_.send(*frame)) {
      deadline_ = now + options_.send_timeout_us;
      return;  // transmitted() continues
    }
    if (announced_ < announcements()) {
      ++announced_;
    } else {
      ++symbol_;
      ++symbols_sent_;
    }
  }
}

/// The next frame of this step; nothing at the end of the step.
std::optional<CanFrame> ImageSender::next_broadcast() {
  if (step_ != Step::send) {
    return announced_ == announcements() ? std::nullopt
           : step_ == Step::begin
               ? std::optional(begin_frame(options_.session, static_cast<std::uint32_t>(image_.size())))
               : std::optional(install_frame(options_.session));
  }
  if (block_ < blocks_of(image_.size()) && symbol_ == plans_[block_].end) {
    ++block_;
    next_block();
  }
  if (block_ == blocks_of(image_.size())) {
    return std::nullopt;
  }
  const Plan& plan = plans_[block_];
  const std::span<const std::uint8_t> bytes = block_of(image_, block_);
  if (announced_ < announcements()) {
    return announced_ % 2 == 0 ? block_frame(options_.session, block_, plan.kind)
                               : check_frame(options_.session, block_, crc32(bytes));
  }
  if (plan.kind == BlockKind::repairs) {
    return symbol_frame(symbol_, repair_symbol(bytes, block_, symbol_));
  }
  return symbol_frame(symbol_, symbol_of(bytes, symbol_));
}

/// Goes to the first block, from the present one on, that has something to send, if there is one.
void ImageSender::next_block() {
  while (block_ < blocks_of(image_.size()) && plans_[block_].first == plans_[block_].end) {
    ++block_;
  }
  announced_ = 0;
  symbol_ = block_ < blocks_of(image_.size()) ? plans_[block_].first : 0;
}

void ImageSender::plan_all_symbols() {
  next_repair_.fill(0);
  for (unsigned block = 0; block < blocks_of(image_.size()); ++block) {
    plans_[block] = {BlockKind::symbols, 0, symbols_of(block_of(image_, block).size())};
  }
}

void ImageSender::plan_repairs() {
  for (unsigned block = 0; block < blocks_of(image_.size()); ++block) {
    const unsigned missing = missing_[block];
    const unsigned first = next_repair_[block];
    const unsigned end = first + repairs_for(missing);
    Plan& plan = plans_[block];
    if (missing == 0) {
      plan = {};
    } else if (missing > BlockDecoder::max_missing || end > block_symbols) {
      plan = {BlockKind::symbols, 0, symbols_of(block_of(image_, block).size())};
      next_repair_[block] = 0;
    } else {
      plan = {BlockKind::repairs, first, end};
      next_repair_[block] = static_cast<std::uint16_t>(end);
    }
  }
}

/// Goes to the first module, from the present one on, that must be asked in this step.
void ImageSender::next_target(Microseconds now) {
  const auto is_asked = [this](const Target& target) {
    switch (step_) {
      case Step::select:
        return !target.is_lost;
      case Step::report:
        return !target.is_lost && target.status.state != ReceiverState::complete;
      default:
        return !target.is_lost && target.status.state < ReceiverState::installed;
    }
  };
  while (target_ < targets_.size() && !is_asked(targets_[target_])) {
    ++target_;
  }
  if (target_ == targets_.size()) {
    finish_round(now);
    return;
  }
  attempt_ = 0;
  ask(now);
}

void ImageSender::ask(Microseconds now) {
  const std::uint32_t serial = targets_[target_].serial;
  const CanFrame request = step_ == Step::select   ? select_frame(options_.session, serial)
                           : step_ == Step::report ? report_frame(serial)
                                                   : status_frame(serial);
  is_unsent_ = !port_.send(request);
  ++attempt_;
  constexpr Microseconds least_us = 2'000;
  asked_at_ = attempt_ == 1 ? now : asked_at_;
  const Microseconds timeout = longest_answer_ == 0 ? options_.answer_timeout_us : least_us + 4 * longest_answer_;
  constexpr unsigned most_doublings = 10;
  deadline_ = now + std::min(timeout << std::min(attempt_ - 1, most_doublings), options_.longest_timeout_us);
}

void ImageSender::finish_round(Microseconds now) {
  const auto is_waiting = [](const Target& target) {
    return !target.is_lost && target.status.state < ReceiverState::installed;
  };
  if (std::ranges::all_of(targets_, &Target::is_lost)) {
    end(State::done);
    return;
  }
  switch (step_) {
    case Step::select:
      installs_again_ = false;
      enter(now, Step::begin);
      return;
    case Step::report:
      if (++rounds_ == max_rounds) {
        lose_incomplete();
      }
      if (std::ranges::all_of(targets_, &Target::is_lost)) {
        end(State::done);
      } else if (rounds_ == max_rounds ||
                 std::ranges::all_of(missing_, [](std::uint8_t missing) { return missing == 0; })) {
        end(State::complete);
      } else {
        plan_repairs();
        // A module that has restarted does not belong to the session any more.
        enter(now, begins_again_ ? Step::select : Step::send);
      }
      return;
    default:
      if (std::ranges::any_of(targets_, is_waiting) && now < install_ends_) {
        deadline_ = now + options_.status_period_us;  // the next round begins at this time
      } else {
        end(State::done);
      }
  }
}

void ImageSender::lose_incomplete() {
  for (Target& target : targets_) {
    target.is_lost = target.is_lost || target.status.state < ReceiverState::complete;
  }
}

void ImageSender::lose_all() {
  for (Target& target : targets_) {
    target.is_lost = true;
  }
  end(State::done);
}

void ImageSender::end(State state) {
  step_ = Step::idle;
  deadline_ = never;
  is_unsent_ = false;
  state_ = state;
}

void ImageSender::receive(Microseconds now, const CanFrame& frame) {
  if (target_ >= targets_.size() || is_unsent_) {
    return;
  }
  Target& target = targets_[target_];
  if (step_ == Step::report) {
    if (const auto report = decode_report(frame, target.serial)) {
      on_report(*report);
      on_answer(now);
    }
  } else if (step_ == Step::select || step_ == Step::status) {
    if (const auto status = decode_status(frame, step_ == Step::select ? Code::select : Code::status, target.serial)) {
      target.status = *status;
      target.is_lost = status->session != options_.session;
      installs_again_ = installs_again_ || status->state == ReceiverState::complete;
      on_answer(now);
    }
  }
}

void ImageSender::on_report(const ReportAnswer& report) {
  if (report.blocks == 0) {
    targets_[target_].status.state = ReceiverState::complete;
    return;
  }
  constexpr std::uint8_t all = 0xFF;
  const std::span<std::uint8_t> missing = std::span(missing_).first(blocks_of(image_.size()));
  if (report.blocks == no_image) {
    begins_again_ = true;
    std::ranges::fill(missing, all);
    return;
  }
  const auto needs = [&missing](std::size_t block, std::uint8_t symbols) {
    if (block < missing.size()) {
      missing[block] = std::max(missing[block], symbols);
    }
  };
  if (report.blocks > report.some.size()) {
    for (std::size_t block = 0; block < missing.size(); ++block) {
      needs(block, report.most);
    }
  }
  for (const std::uint8_t block : report.some) {
    const bool needs_all = (block & needs_symbols) != 0 && block != no_block;
    needs(needs_all ? block - needs_symbols : block, needs_all ? all : report.most);
  }
}

void ImageSender::on_answer(Microseconds now) {
  if (attempt_ == 1) {
    longest_answer_ = std::max(longest_answer_, now - asked_at_);
  }
  ++target_;
  next_target(now);
}

void ImageSender::transmitted(Microseconds now) { pump(now); }

void ImageSender::poll(Microseconds now) {
  if (now < deadline_) {
    return;
  }
  if (step_ == Step::begin || step_ == Step::send || step_ == Step::install) {
    lose_all();  // the bus takes no frames
  } else if (step_ == Step::status && target_ == targets_.size()) {
    enter(now, installs_again_ ? Step::install : Step::status);
    installs_again_ = false;
  } else if (attempt_ < options_.attempts || (step_ == Step::status && now < install_ends_)) {
    ask(now);  // a module that writes its flash cannot answer
  } else {
    targets_[target_].is_lost = true;
    ++target_;
    next_target(now);
  }
}

}  // namespace proleg::broadcast
