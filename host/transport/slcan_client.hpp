#pragma once

#include <deque>
#include <string>
#include <string_view>

#include "host/transport/frame_queue.hpp"
#include "host/transport/slcan_adapter_lines.hpp"
#include "host/transport/transport.hpp"
#include "shared/can/slcan.hpp"

namespace proleg::host {

/// Receives the reports of an slcan adapter.
class SlcanClientListener {
 public:
  virtual void received(Microseconds time, const CanFrame& frame) = 0;
  /// The adapter took a frame of send(): it confirmed the frame, or the line took it if the adapter confirms nothing.
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
/// adapter is there. So start() sends C, V, N, S8, Z0 and O, each when the one before was answered or its time is over
/// (some adapters lose all but one command of a packet), and begins again, because some adapters need two seconds
/// after the line was opened. A channel with an acknowledging adapter carries `window` frames that are not confirmed
/// yet; frames that end motion (frame_queue.hpp) do not wait for confirmations, which may be cut off.
class SlcanClient {
 public:
  struct Settings {
    Microseconds answer_timeout = 300'000;   ///< duration of the wait for the answer to one command
    Microseconds start_timeout = 4'000'000;  ///< duration of all attempts to open the channel
    /// V is sent after this duration without an answer, while frames wait for one. Without an answer to V the channel
    /// is lost.
    Microseconds frame_timeout = 1'000'000;
    /// The same if frames have been confirmed or received, so that the bus carries frames: on a bad line confirmations
    /// are lost, and fill the window.
    Microseconds confirmation_timeout = 200'000;
    /// The channel is lost after this duration in which the adapter rejects all frames and receives none, unless it
    /// has reported that its controller is in trouble. An adapter that was reset has a closed channel.
    Microseconds rejection_timeout = 500'000;
    std::size_t window = 32;
    bool is_listen_only = false;
  };
  enum class State : std::uint8_t {
    idle,      ///< before start() and after stop()
    starting,  ///< commands are under way
    open,
    failed,  ///< the channel cannot be opened or was lost; error() says why
  };

  SlcanClient(SlcanClientListener& listener, const Settings& settings) : listener_(listener), settings_(settings) {}

  /// Starts on a new line: nothing from an earlier line is left, except counters.
  void start(Microseconds now);
  /// Receives characters from the adapter.
  void input(Microseconds now, std::string_view characters);
  /// To be called when next_deadline() has come.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;
  /// Sends a frame. Returns false if the channel is not open or the queue is full.
  [[nodiscard]] bool send(const CanFrame& frame);
  /// Returns at most this many characters for the adapter. May call transmitted().
  [[nodiscard]] std::string take(Microseconds now, std::size_t max_characters);
  [[nodiscard]] bool has_output() const;
  /// Closes the channel: only the command C is left to be taken.
  void stop();

  [[nodiscard]] State state() const { return state_; }
  /// One line about the failure: what was received and what was expected.
  [[nodiscard]] const std::string& error() const { return error_; }
  [[nodiscard]] TransportProblem problem() const { return problem_; }
  /// The answers to V and N, for example "V1013, NA123"; empty if there were none.
  [[nodiscard]] const std::string& adapter() const { return adapter_; }
  [[nodiscard]] bool is_acknowledging() const { return is_acknowledging_; }
  /// All numbers except received and connections, which the listener counts.
  [[nodiscard]] const Statistics& statistics() const { return statistics_; }

 private:
  enum class Step : std::uint8_t { close, close_again, version, serial_number, bit_rate, time_stamps, open, proof };
  enum class Answer : std::uint8_t { accepted, rejected, text };

  void begin_round(Microseconds now);
  void begin_step(Microseconds now, Step step);
  void handle_line(Microseconds now, bool ends_with_bel);
  void take_bare_confirmations(Microseconds now, bool ends_with_bel);
  [[nodiscard]] bool reports_pending_frame();
  [[nodiscard]] bool handle_report(Microseconds now);
  void handle_answer(Microseconds now, Answer answer);
  void handle_start_answer(Microseconds now, Answer answer);
  void refuse(Microseconds now);
  void note_rubbish();
  void note_malformed();
  void end_round(Microseconds now);
  void become_open(Microseconds now);
  void handle_frame_answer(Microseconds now, Answer answer);
  void confirm(Microseconds now);
  void ask_for_a_sign(Microseconds now);
  [[nodiscard]] bool has_next_frame() const;
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

  SlcanAdapterLines lines_;
  std::string line_;  ///< the last line, or what is left of it
  std::string output_;
  bool has_begun_line_ = false;  ///< a part of an output line was taken
  FrameQueue queue_;
  std::deque<CanFrame> pending_;  ///< frames that are written and not confirmed

  Microseconds start_deadline_ = 0;
  Microseconds step_deadline_ = 0;
  Microseconds last_answer_ = 0;        ///< time of the last answer, or when a frame was written while none was pending
  Microseconds sign_deadline_ = never;  ///< deadline of the answer to V while the channel is open
  std::string command_;                 ///< last command of the start
  std::string sample_;                  ///< the first characters of this round, for an error
  std::string rubbish_;                 ///< the first line that is no answer, and the command before it
  bool is_acknowledging_ = false;
  bool has_confirmed_frames_ = false;
  bool has_received_ = false;       ///< a frame from the bus
  bool confirms_with_end_ = false;  ///< a frame was confirmed with CR, or with z and CR
  bool has_proof_ = false;          ///< something in this round shows that slcan is spoken
  unsigned refusals_ = 0;
  Microseconds rejected_since_ = never;  ///< when the first one of the frames was rejected that all were
  bool has_bus_trouble_ = false;         ///< the adapter has reported another state than error active
};

}  // namespace proleg::host
