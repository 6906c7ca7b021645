#pragma once

// The adapter's side of slcan: what a USB-to-CAN adapter does between its serial line and its controller. Modules that
// serve as an adapter and the simulated bus use it. docs/adapters.md describes the commands for users.

#include <span>

#include "shared/can/can_port.hpp"
#include "shared/can/slcan.hpp"

namespace proleg {

class SlcanAdapter {
 public:
  struct Settings {
    std::uint16_t version = 0x1010;                         ///< answer to V: two digits each for hardware and software
    std::array<char, 4> serial_number{'0', '0', '0', '0'};  ///< answer to N: letters and digits
    /// Only the state frames (0x181 to 0x1FF, 0x281 to 0x2FF) after every n-th SYNC pass, so that a slow line carries
    /// complete sets of them. 0 and 1: all pass. All pass while there is no SYNC, too.
    std::uint8_t state_frame_divisor = 1;
  };

  /// Counters, which wrap at 2^32.
  struct Counters {
    std::uint32_t frames_sent = 0;      ///< lines whose frame was passed to the bus
    std::uint32_t frames_refused = 0;   ///< lines with a frame that was not sent: channel closed, listen only, no room,
                                        ///< or a frame that Proleg does not use
    std::uint32_t lines_rejected = 0;   ///< other lines from the host that were wrong or not understood
    std::uint32_t frames_received = 0;  ///< frames from the bus that were written for the host
    std::uint32_t state_frames_thinned = 0;
    std::uint32_t state_frames_dropped = 0;  ///< state frames for which the output had no room
    std::uint32_t frames_dropped = 0;        ///< other frames and error reports for which it had no room
    std::uint32_t answers_dropped = 0;       ///< answers for which it had no room; see input_room()
  };

  /// The size of the smallest output buffer.
  static constexpr std::size_t min_buffer = 256;

  /// buffer: holds the output, at least min_buffer characters. State frames fill at most three quarters of it, other
  /// frames all but 64 characters; the rest is for answers. bus: receives the frames of the host.
  SlcanAdapter(std::span<char> buffer, CanPort& bus, const Settings& settings)
      : buffer_(buffer), bus_(bus), settings_(settings) {}
  SlcanAdapter(std::span<char> buffer, CanPort& bus) : SlcanAdapter(buffer, bus, Settings()) {}

  /// Takes characters from the host. Executes each complete line at once.
  void input(std::string_view characters);
  /// Number of characters that can be taken without the loss of an answer. A caller that can make its host wait reads
  /// no more than this.
  [[nodiscard]] std::size_t input_room() const { return (buffer_.size() - size_) / max_answer_growth; }

  /// Takes a frame from the bus, also of the node itself, but not one that came from this host. now: time for its
  /// stamp.
  void received(Microseconds now, const CanFrame& frame);
  /// Takes the error state of the controller, whenever it changes. The host receives it also when it opens the channel.
  void status_changed(const CanStatus& status);
  /// Takes the errors on the bus since the last call. To be called rarely, for example ten times a second.
  void errors_occurred(CanErrors errors);

  /// Moves output into `characters` and returns the number of characters.
  std::size_t take(std::span<char> characters);
  [[nodiscard]] bool has_output() const { return size_ > 0; }

  /// Whether the channel is open: the host receives frames and can send some, unless it only listens.
  [[nodiscard]] bool is_open() const { return mode_ != Mode::closed; }
  [[nodiscard]] bool is_listen_only() const { return mode_ == Mode::listen_only; }
  /// Returns to the state after power-on, for a new host on the line. Counters go on.
  void reset();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class Mode : std::uint8_t { closed, normal, listen_only };
  /// Importance of a line: it decides how many characters must stay free after it.
  enum class Importance : std::uint8_t { state_frame, frame, answer };

  static constexpr std::size_t answer_reserve = 64;
  static constexpr std::size_t max_answer_growth = 3;  ///< "V\r" is answered by "V1010\r"

  void execute(std::string_view line);
  /// The answer to a line; nothing if the answer is BEL.
  [[nodiscard]] std::optional<SlcanText> answer(std::string_view line);
  [[nodiscard]] std::optional<SlcanText> answer_frame(std::string_view line);
  [[nodiscard]] std::optional<SlcanText> open(Mode mode);
  [[nodiscard]] std::optional<SlcanText> rejected();
  [[nodiscard]] SlcanText status_flags();
  void write_pending_status();
  [[nodiscard]] bool write(std::string_view line, char end, Importance importance);

  std::span<char> buffer_;
  CanPort& bus_;
  const Settings settings_;
  SlcanLineReader reader_;
  Counters counters_;
  CanStatus status_;
  std::size_t first_ = 0;  ///< position of the oldest character of the output
  std::size_t size_ = 0;
  std::uint8_t syncs_ = 0;  ///< number of SYNCs, modulo the divisor
  std::uint8_t flags_ = 0;  ///< what command F reports: gathered since the last F
  Mode mode_ = Mode::closed;
  bool has_timestamps_ = false;
  bool status_is_pending_ = false;  ///< the host has not received the latest status
};

}  // namespace proleg
