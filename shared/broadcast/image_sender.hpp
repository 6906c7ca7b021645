#pragma once

// The host's side of a broadcast (transfer_frame.hpp): it sends an image to the bootloaders of some modules and lets
// them install it. First it sends each symbol once. Then the modules report how many symbols they miss, and it sends
// repair symbols, until all modules have the image. It continues without modules that do not answer any more.

#include <array>

#include "shared/broadcast/transfer_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::broadcast {

/// A module that receives the image.
struct Target {
  std::uint32_t serial = 0;  ///< object 0x1018:4
  StatusAnswer status{};     ///< the last status that the module has sent
  bool is_lost = false;      ///< it does not answer, or it belongs to another host's session
};

struct SenderOptions {
  std::uint8_t session = 1;  ///< number of the session, 1 to 255, random
  /// Timeout of an answer before any answer has come; then it is four times the longest time of an answer. It doubles
  /// with each attempt, because frames may be waiting in the transport's queue.
  Microseconds answer_timeout_us = 50'000;
  Microseconds longest_timeout_us = 150'000;
  unsigned attempts = 12;                        ///< number of times that a request is sent without an answer
  Microseconds send_timeout_us = 1'000'000;      ///< time in which the bus must take a frame
  Microseconds install_timeout_us = 15'000'000;  ///< time from the request to the end of all installations
  Microseconds status_period_us = 20'000;        ///< time between two questions while modules install
};

class ImageSender {
 public:
  enum class State : std::uint8_t {
    idle,
    sending,
    complete,  ///< all targets that are not lost have the image
    installing,
    done,  ///< the status of each target has the result
  };

  /// image: 1 byte to max_blocks blocks. image and targets must outlive the sender.
  ImageSender(CanPort& port, std::span<const std::uint8_t> image, std::span<Target> targets,
              const SenderOptions& options)
      : port_(port), image_(image), targets_(targets), options_(options) {}
  ImageSender(const ImageSender&) = delete;
  ImageSender& operator=(const ImageSender&) = delete;

  void start(Microseconds now);
  /// Begins to install the image; only in state `complete`.
  void install(Microseconds now);

  void receive(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller has sent a frame of the sender.
  void transmitted(Microseconds now);
  /// Handles timeouts. Must be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const { return deadline_; }

  [[nodiscard]] State state() const { return state_; }
  /// Number of symbols, repair symbols included, that were sent so far.
  [[nodiscard]] std::uint32_t symbols_sent() const { return symbols_sent_; }

 private:
  /// Number of times that a request without an answer is sent, because it may be lost: with the request that begins a
  /// block, the whole block is lost.
  static constexpr unsigned repetitions = 4;
  /// Greatest number of rounds of symbols. A module that still misses some afterwards is lost.
  static constexpr unsigned max_rounds = 24;

  enum class Step : std::uint8_t { idle, select, begin, send, report, install, status };

  void enter(Microseconds now, Step step);
  void pump(Microseconds now);
  [[nodiscard]] std::optional<CanFrame> next_broadcast();
  /// Number of frames with which this step, or a block of it, begins. A block has a checksum after each frame that
  /// begins it.
  [[nodiscard]] unsigned announcements() const { return step_ == Step::send ? 2 * repetitions : repetitions; }
  void next_block();
  void plan_all_symbols();
  void plan_repairs();
  void ask(Microseconds now);
  void lose_incomplete();
  void lose_all();
  void next_target(Microseconds now);
  void finish_round(Microseconds now);
  void end(State state);
  void on_report(const ReportAnswer& report);
  void on_answer(Microseconds now);

  CanPort& port_;
  std::span<const std::uint8_t> image_;
  std::span<Target> targets_;
  const SenderOptions options_;

  State state_ = State::idle;
  Step step_ = Step::idle;
  Microseconds deadline_ = never;
  Microseconds install_ends_ = never;
  std::uint32_t symbols_sent_ = 0;

  // State of a step that sends requests to one module after the other.
  std::size_t target_ = 0;
  unsigned attempt_ = 0;
  bool is_unsent_ = false;       ///< the request waits for a mailbox
  bool begins_again_ = false;    ///< a module has not received `begin`, or has restarted
  unsigned rounds_ = 0;          ///< number of rounds of symbols
  bool installs_again_ = false;  ///< a module has not received `install`
  Microseconds asked_at_ = 0;
  Microseconds longest_answer_ = 0;  ///< longest time of an answer

  // State of a step that sends symbols of one block after the other.
  unsigned block_ = 0;
  unsigned announced_ = 0;  ///< number of announcements() that were sent
  unsigned symbol_ = 0;     ///< the next symbol of the block
  /// For each block, the symbols to send in this round, from `first` to before `end`.
  struct Plan {
    BlockKind kind = BlockKind::symbols;
    unsigned first = 0;
    unsigned end = 0;
  };
  std::array<Plan, max_blocks> plans_{};
  std::array<std::uint8_t, max_blocks>
      missing_{};  ///< for each block, the greatest number of symbols that a module misses
  std::array<std::uint16_t, max_blocks>
      next_repair_{};  ///< for each block, the number of repair symbols that were sent already
};

}  // namespace proleg::broadcast
