#pragma once

#include <deque>
#include <string>
#include <string_view>

#include "host/transport/transport.hpp"
#include "shared/can/slcan.hpp"

namespace proleg::host {

/// What an slcan adapter reports.
class SlcanClientListener {
 public:
  virtual void received(Microseconds time, const CanFrame& frame) = 0;
  /// As TransportListener::transmitted().
  virtual void transmitted(Microseconds time, const CanFrame& frame) = 0;
  virtual void status_received(const CanStatus& status) = 0;
  virtual void errors_received(CanErrors errors) = 0;

 protected:
  ~SlcanClientListener() = default;
};

/// The computer's side of slcan, without a clock and without the line: characters in, characters out, deadlines.
///
/// Adapters speak three dialects. LAWICEL's CANUSB and our modules answer each command and frame. CANable's slcan
/// firmware answers V only, with some text. Others answer nothing; the first frame from the bus shows that such an
/// adapter is there. So start() sends C, V, N, S8 and O, each when the one before was answered or its time is over
/// (some adapters lose all but one command of a packet), and begins again, because some adapters need two seconds
/// after the line was opened. A channel with an acknowledging adapter carries `window` frames that are not confirmed
/// yet.
class SlcanClient {
 public:
  struct Settings {
    Microseconds answer_timeout = 300'000;   ///< for the answer to one command
    Microseconds start_timeout = 4'000'000;  ///< for all of start()
    Microseconds frame_timeout = 1'000'000;  ///< without an answer while frames wait for one: then V asks for a sign
    std::size_t window = 32;
    std::size_t max_queue = 1'024;  ///< frames that wait for the window
    bool is_listen_only = false;
  };
  enum class State : std::uint8_t {
    idle,      ///< before start() and after stop()
    starting,  ///< commands are under way
    open,
    failed,  ///< error() says why
  };

  SlcanClient(SlcanClientListener& listener, const Settings& settings) : listener_(listener), settings_(settings) {}

  /// Begins with a new line: nothing from an earlier one is left, except counters.
  void start(Microseconds now);
  /// Characters from the adapter.
  void input(Microseconds now, std::string_view characters);
  /// To be called when next_deadline() has come.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;
  /// False if the channel is not open or the queue is full.
  [[nodiscard]] bool send(const CanFrame& frame);
  /// At most this many characters for the adapter. May call transmitted().
  [[nodiscard]] std::string take(Microseconds now, std::size_t max_characters);
  [[nodiscard]] bool has_output() const;
  /// Closes the channel: only the command C is left to be taken.
  void stop();

  [[nodiscard]] State state() const { return state_; }
  /// One line: what was received and what was expected.
  [[nodiscard]] const std::string& error() const { return error_; }
  [[nodiscard]] TransportProblem problem() const { return problem_; }
  /// Answers to V and N, for example "V1013, NA123"; empty if there were none.
  [[nodiscard]] const std::string& adapter() const { return adapter_; }
  [[nodiscard]] bool is_acknowledging() const { return is_acknowledging_; }
  /// All but received and connections; their listener counts them.
  [[nodiscard]] const Statistics& statistics() const { return statistics_; }

 private:
  enum class Step : std::uint8_t { close, close_again, version, serial_number, bit_rate, open, proof };
  enum class Answer : std::uint8_t { accepted, rejected, text };

  void begin_round(Microseconds now);
  void begin_step(Microseconds now, Step step);
  void handle_line(Microseconds now, bool ends_with_bel);
  [[nodiscard]] bool handle_report(Microseconds now);
  void handle_answer(Microseconds now, Answer answer);
  void handle_start_answer(Microseconds now, Answer answer);
  void refuse(Microseconds now);
  void note_rubbish();
  void end_round(Microseconds now);
  void become_open(Microseconds now);
  void handle_frame_answer(Microseconds now, Answer answer);
  void ask_for_a_sign(Microseconds now);
  void fill_output(Microseconds now);
  void drop_frames();
  void drop_output();
  void fail(const std::string& reason, TransportProblem problem);
  [[nodiscard]] std::string start_failure() const;

  SlcanClientListener& listener_;
  const Settings settings_;
  State state_ = State::idle;
  Step step_ = Step::close;
  std::string error_;
  TransportProblem problem_ = TransportProblem::other;
  std::string adapter_;
  Statistics statistics_;

  std::string line_;  ///< received so far
  std::string output_;
  bool has_begun_line_ = false;  ///< a part of a line was taken
  std::deque<CanFrame> queue_;
  std::deque<CanFrame> pending_;  ///< written, not confirmed

  Microseconds start_deadline_ = 0;
  Microseconds step_deadline_ = 0;
  Microseconds last_answer_ = 0;        ///< or when a frame was written although none was pending
  Microseconds sign_deadline_ = never;  ///< of the answer to V while the channel is open
  std::string command_;                 ///< the last one of the start
  std::string sample_;                  ///< the first characters of this round, for an error
  std::string rubbish_;                 ///< the first line that is no answer, and to what
  bool is_acknowledging_ = false;
  bool has_confirmed_frames_ = false;
  bool has_proof_ = false;  ///< something in this round shows that slcan is spoken
  unsigned refusals_ = 0;
};

/// Text with other than printable ASCII characters as \r, \a, \n or \xNN, shortened, and in quotes.
[[nodiscard]] std::string printable_bytes(std::string_view bytes);

}  // namespace proleg::host
