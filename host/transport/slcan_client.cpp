#include "host/transport/slcan_client.hpp"

#include <algorithm>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

constexpr std::size_t sample_length = 40;    // characters in an error
constexpr std::size_t output_ahead = 1'024;  // characters that are prepared before the line takes them
constexpr unsigned max_refusals = 2;
constexpr double microseconds_per_second = 1e6;

bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char character) { return character >= ' ' && character <= '~'; });
}

}  // namespace

void SlcanClient::start(Microseconds now) {
  drop_frames();
  state_ = State::starting;
  error_.clear();
  refusals_ = 0;
  sign_deadline_ = never;
  has_confirmed_frames_ = false;
  has_received_ = false;
  start_deadline_ = now + settings_.start_timeout;
  has_bus_trouble_ = false;
  lines_.reset();
  confirms_with_end_ = false;
  rubbish_.clear();
  output_.clear();
  has_begun_line_ = false;
  begin_round(now);
}

void SlcanClient::begin_round(Microseconds now) {
  drop_output();
  adapter_.clear();
  sample_.clear();
  is_acknowledging_ = false;
  has_proof_ = false;
  begin_step(now, Step::close);
}

void SlcanClient::begin_step(Microseconds now, Step step) {
  step_ = step;
  switch (step) {
    case Step::close:
    case Step::close_again:
      command_ = "C";
      break;
    case Step::version:
      rubbish_.clear();  // the characters before may be the rest of a line
      command_ = "V";
      break;
    case Step::serial_number:
      command_ = "N";
      break;
    case Step::bit_rate:
      command_ = "S8";
      break;
    case Step::time_stamps:
      command_ = "Z0";
      break;
    case Step::open:
      command_ = settings_.is_listen_only ? "L" : "O";
      break;
    case Step::proof:
      step_deadline_ = now + 3 * settings_.answer_timeout;
      return;
  }
  output_ += command_ + slcan_end;
  step_deadline_ = now + settings_.answer_timeout;
}

void SlcanClient::input(Microseconds now, std::string_view characters) {
  for (const char character : characters) {
    if (state_ != State::starting && state_ != State::open) {
      return;
    }
    if (state_ == State::starting && sample_.size() <= sample_length) {
      sample_ += character;
    }
    if (const auto event = lines_.push(character); event != SlcanAdapterLines::Event::none) {
      line_ = lines_.line();
      handle_line(now, event == SlcanAdapterLines::Event::rejected);
    }
  }
}

void SlcanClient::handle_line(Microseconds now, bool ends_with_bel) {
  take_bare_confirmations(now, ends_with_bel);
  if (ends_with_bel) {
    note_malformed();
    handle_answer(now, Answer::rejected);
  } else if (line_.empty() || line_ == "z" || line_ == "Z") {
    confirms_with_end_ = confirms_with_end_ || !pending_.empty();
    handle_answer(now, Answer::accepted);
  } else if (!handle_report(now)) {
    handle_answer(now, Answer::text);
  }
}

/// Takes the confirmations of an adapter that ends them with nothing: each z stands before another answer or a frame.
/// An adapter that confirms with the end of a line can report a frame of this computer as z with the frame.
void SlcanClient::take_bare_confirmations(Microseconds now, bool ends_with_bel) {
  while (state_ == State::open && is_acknowledging_ && !confirms_with_end_ && begins_with_z(line_) &&
         (line_.size() > 1 || ends_with_bel)) {
    if (reports_pending_frame()) {
      return;
    }
    lines_.end_lines_after_z();
    handle_answer(now, Answer::accepted);
    line_.erase(0, 1);
  }
}

/// Whether the line is a report of the frame that was sent first and is not confirmed.
bool SlcanClient::reports_pending_frame() {
  const auto frame = lines_.read_frame(std::string_view(line_).substr(1));
  return frame && !pending_.empty() && *frame == slcan_frame(pending_.front());
}

/// Handles a line that answers no command: a frame, a state, errors.
bool SlcanClient::handle_report(Microseconds now) {
  if (begins_with_z(line_) && lines_.read_frame(std::string_view(line_).substr(1))) {
    if (!confirms_with_end_ && reports_pending_frame()) {
      handle_answer(now, Answer::accepted);
    }
    return true;
  }
  if (const auto frame = lines_.read_frame(line_)) {
    has_proof_ = true;
    if (step_ == Step::proof && state_ == State::starting) {
      become_open(now);
    }
    if (state_ != State::open) {
      return true;
    }
    has_received_ = true;
    rejected_since_ = never;
    if (frame->is_for_protocol()) {
      listener_.received(now, frame->can_frame());
    } else {
      ++statistics_.foreign;
    }
    return true;
  }
  if (const auto status = parse_slcan_status(line_)) {
    if (state_ == State::open || step_ == Step::open) {
      has_bus_trouble_ = status->state != CanState::error_active;
      listener_.status_received(*status);
    }
    return true;
  }
  if (const auto errors = parse_slcan_errors(line_)) {
    if (state_ == State::open) {
      listener_.errors_received(*errors);
    }
    return true;
  }
  return false;
}

void SlcanClient::handle_answer(Microseconds now, Answer answer) {
  if (state_ == State::starting) {
    handle_start_answer(now, answer);
  } else {
    handle_frame_answer(now, answer);
  }
}

void SlcanClient::handle_start_answer(Microseconds now, Answer answer) {
  const bool is_text = answer == Answer::text;
  const bool is_lawicel = is_text && line_.size() > 1 && line_[0] == command_[0] && is_printable(line_);
  switch (step_) {
    case Step::close:
      if (is_text) {
        note_rubbish();
      } else {
        // BEL can be the answer to a line that was begun before.
        begin_step(now, answer == Answer::rejected ? Step::close_again : Step::version);
      }
      return;
    case Step::close_again:
      if (is_text) {
        note_rubbish();
      } else {
        begin_step(now, Step::version);
      }
      return;
    case Step::version:
      if (is_text && (line_ == command_ || !is_printable(line_))) {
        note_rubbish();
        return;
      }
      has_proof_ = true;
      adapter_ = is_text ? line_ : std::string();
      begin_step(now, is_lawicel ? Step::serial_number : Step::bit_rate);
      return;
    case Step::serial_number:
      if (is_text && !is_lawicel) {
        note_rubbish();
        return;
      }
      adapter_ += is_text ? ", " + line_ : std::string();
      begin_step(now, Step::bit_rate);
      return;
    case Step::time_stamps:
      if (is_text && !is_printable(line_)) {
        note_rubbish();
      } else {
        begin_step(now, Step::open);  // an adapter without the command rejects it
      }
      return;
    case Step::bit_rate:
    case Step::open:
    case Step::proof:
      if (is_text) {
        note_rubbish();
      } else if (answer == Answer::rejected) {
        refuse(now);
      } else {
        is_acknowledging_ = true;
        has_proof_ = true;
        if (step_ == Step::bit_rate) {
          begin_step(now, Step::time_stamps);
        } else {
          end_round(now);
        }
      }
      return;
  }
}

void SlcanClient::refuse(Microseconds now) {
  if (++refusals_ < max_refusals) {
    begin_round(now);
    return;
  }
  fail(command_ == "S8" ? "the adapter answers BEL to S8, expected CR: it does not offer 1 Mbit/s"
                        : "the adapter answers BEL to " + command_ + ", expected CR: it does not open its channel",
       TransportProblem::no_bit_rate);
}

void SlcanClient::note_rubbish() {
  if (rubbish_.empty()) {
    rubbish_ = line_ == command_ ? "the line returns what is sent to it (" + command_ + ")"
                                 : "received " + printable_bytes(line_) + " after " + command_;
  }
}

void SlcanClient::note_malformed() {
  if (!line_.empty()) {
    ++statistics_.malformed;
    statistics_.malformed_line = printable_bytes(line_);
  }
}

void SlcanClient::end_round(Microseconds now) {
  if (has_proof_ && rubbish_.empty()) {
    become_open(now);
  } else if (step_ == Step::open) {
    begin_step(now, Step::proof);
  }
}

void SlcanClient::become_open(Microseconds now) {
  state_ = State::open;
  last_answer_ = now;
  rejected_since_ = never;
}

void SlcanClient::poll(Microseconds now) {
  if (state_ == State::open && now >= next_deadline()) {
    if (sign_deadline_ != never) {
      fail("the adapter answers no more; frames without confirmation: " + std::to_string(pending_.size()),
           TransportProblem::no_answer);
    } else {
      ask_for_a_sign(now);
    }
    return;
  }
  if (state_ != State::starting || now < step_deadline_) {
    return;
  }
  if (now >= start_deadline_ && (step_ == Step::proof || step_ == Step::close)) {
    fail(start_failure(),
         rubbish_.empty() && sample_.empty() ? TransportProblem::no_answer : TransportProblem::not_slcan);
    return;
  }
  switch (step_) {
    case Step::close:
    case Step::close_again:
      begin_step(now, Step::version);
      break;
    case Step::version:
    case Step::serial_number:
      begin_step(now, Step::bit_rate);
      break;
    case Step::bit_rate:
      begin_step(now, Step::time_stamps);
      break;
    case Step::time_stamps:
      begin_step(now, Step::open);
      break;
    case Step::open:
      end_round(now);
      break;
    case Step::proof:
      begin_round(now);
      break;
  }
}

Microseconds SlcanClient::next_deadline() const {
  if (state_ == State::starting) {
    return step_deadline_;
  }
  if (state_ != State::open || pending_.empty()) {
    return never;
  }
  if (sign_deadline_ != never) {
    return sign_deadline_;
  }
  return last_answer_ +
         (has_confirmed_frames_ || has_received_ ? settings_.confirmation_timeout : settings_.frame_timeout);
}

std::string SlcanClient::start_failure() const {
  const std::string expected = ", expected slcan: CR, BEL or a line such as t1230";
  if (!rubbish_.empty()) {
    return rubbish_ + expected;
  }
  if (!sample_.empty()) {
    return "received " + printable_bytes(sample_) + expected;
  }
  return "no answer to C, V, S8 and O within " +
         number_text(static_cast<double>(settings_.start_timeout) / microseconds_per_second) +
         " s, and no frame from the bus";
}

void SlcanClient::fail(const std::string& reason, TransportProblem problem) {
  error_ = reason;
  problem_ = problem;
  state_ = State::failed;
  drop_frames();
}

void SlcanClient::drop_frames() {
  statistics_.dropped_out += queue_.size();
  statistics_.unconfirmed += pending_.size();
  queue_.clear();
  pending_.clear();
}

/// Drops output. The rest of a line that was begun stays, since the next line would be added to it.
void SlcanClient::drop_output() { output_.erase(has_begun_line_ ? output_.find(slcan_end) + 1 : 0); }

bool SlcanClient::send(const CanFrame& frame) {
  if (state_ != State::open || settings_.is_listen_only) {
    ++statistics_.dropped_out;
    return false;
  }
  return queue_.push(frame, statistics_.dropped_out);
}

/// Whether a frame may be written now.
bool SlcanClient::has_next_frame() const {
  return state_ == State::open && !queue_.empty() &&
         (!is_acknowledging_ || pending_.size() < settings_.window || queue_.has_stop());
}

void SlcanClient::fill_output(Microseconds now) {
  while (has_next_frame() && (output_.size() < output_ahead || queue_.has_stop())) {
    const CanFrame frame = queue_.front();
    queue_.pop();
    output_ += format_slcan_frame(slcan_frame(frame)).view();
    output_ += slcan_end;
    if (is_acknowledging_) {
      last_answer_ = pending_.empty() ? now : last_answer_;
      pending_.push_back(frame);
    } else {
      ++statistics_.transmitted;
      listener_.transmitted(now, frame);
    }
  }
}

bool SlcanClient::has_output() const { return !output_.empty() || has_next_frame(); }

std::string SlcanClient::take(Microseconds now, std::size_t max_characters) {
  fill_output(now);
  std::string taken = output_.substr(0, max_characters);
  output_.erase(0, taken.size());
  has_begun_line_ = taken.empty() ? has_begun_line_ : taken.back() != slcan_end;
  return taken;
}

void SlcanClient::handle_frame_answer(Microseconds now, Answer answer) {
  if (answer == Answer::text) {
    const bool is_late_answer = std::string_view("VNF").find(line_[0]) != std::string_view::npos;
    if (sign_deadline_ != never) {
      // The adapter has read all lines before V, but answers are lost, or it confirms commands only.
      sign_deadline_ = never;
      is_acknowledging_ = has_confirmed_frames_;
      while (has_confirmed_frames_ && !pending_.empty()) {
        confirm(now);
      }
      statistics_.unconfirmed += pending_.size();
      pending_.clear();
    } else if (!is_late_answer && line_ != adapter_) {
      note_malformed();
    }
    return;
  }
  sign_deadline_ = never;
  last_answer_ = now;
  if (pending_.empty()) {
    return;  // a second answer, or a late answer to a command of the start
  }
  has_confirmed_frames_ = true;
  if (answer == Answer::rejected) {
    pending_.pop_front();
    ++statistics_.refused;
    rejected_since_ = std::min(rejected_since_, now);
    if (!has_bus_trouble_ && now - rejected_since_ >= settings_.rejection_timeout) {
      fail("the adapter has rejected all frames for " +
               number_text(static_cast<double>(settings_.rejection_timeout) / microseconds_per_second) +
               " s: its channel is closed, as after a reset",
           TransportProblem::other);
    }
  } else {
    rejected_since_ = never;
    confirm(now);
  }
}

void SlcanClient::confirm(Microseconds now) {
  const CanFrame frame = pending_.front();
  pending_.pop_front();
  ++statistics_.transmitted;
  listener_.transmitted(now, frame);
}

void SlcanClient::ask_for_a_sign(Microseconds now) {
  output_ += 'V';
  output_ += slcan_end;
  sign_deadline_ = std::max(now, last_answer_ + settings_.frame_timeout) + 2 * settings_.answer_timeout;
}

void SlcanClient::stop() {
  drop_frames();
  drop_output();
  output_ += 'C';
  output_ += slcan_end;
  state_ = State::idle;
  sign_deadline_ = never;
}

}  // namespace proleg::host
