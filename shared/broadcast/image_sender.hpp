#pragma once

// The host's side of a broadcast (transfer_frame.hpp): sends an image to the bootloaders of some modules and lets them
// install it. All symbols go out once; then the modules report what they miss, and repair symbols go out, until all
// modules have the image. A module that answers no more is left behind; the others go on.

#include <array>

#include "shared/broadcast/transfer_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::broadcast {

/// A module that gets the image.
struct Target {
  std::uint32_t serial = 0;  ///< object 0x1018:4
  StatusAnswer status{};     ///< the last one that the module has sent
  bool is_lost = false;      ///< it has not answered, or belongs to another host's session
};

struct SenderOptions {
  std::uint8_t session = 1;  ///< 1 to 255, random
  /// Of an answer, until others have come; then four times the longest one. It doubles with each attempt: in the
  /// transport's queue frames may be waiting.
  Microseconds answer_timeout_us = 50'000;
  Microseconds longest_timeout_us = 150'000;
  unsigned attempts = 12;                        ///< of a request until it is answered
  Microseconds send_timeout_us = 1'000'000;      ///< in which the bus takes a frame
  Microseconds install_timeout_us = 15'000'000;  ///< from the request to the end of all installations
  Microseconds status_period_us = 20'000;        ///< between two questions while modules install
};

class ImageSender {
 public:
  enum class State : std::uint8_t {
    idle,
    sending,
    complete,  ///< all targets that are not lost have the image
    installing,
    done,  ///< their status says what came of it
  };

  /// image: 1 byte to max_blocks blocks. image and targets must outlive the sender.
  ImageSender(CanPort& port, std::span<const std::uint8_t> image, std::span<Target> targets,
              const SenderOptions& options)
      : port_(port), image_(image), targets_(targets), options_(options) {}
  ImageSender(const ImageSender&) = delete;
  ImageSender& operator=(const ImageSender&) = delete;

  void start(Microseconds now);
  /// In state `complete`.
  void install(Microseconds now);

  void receive(Microseconds now, const CanFrame& frame);
  /// The controller has sent a frame of the sender.
  void transmitted(Microseconds now);
  /// Handles the deadline that has passed; must be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const { return deadline_; }

  [[nodiscard]] State state() const { return state_; }
  /// Symbols, repair symbols included, that were sent so far.
  [[nodiscard]] std::uint32_t symbols_sent() const { return symbols_sent_; }

 private:
  /// A request that may be lost, and has no answer, is sent so often: a block whose beginning is lost is lost.
  static constexpr unsigned repetitions = 4;
  /// Rounds of symbols, after which a module that still misses some is left behind.
  static constexpr unsigned max_rounds = 24;

  enum class Step : std::uint8_t { idle, select, begin, send, report, install, status };

  void enter(Microseconds now, Step step);
  void pump(Microseconds now);
  [[nodiscard]] std::optional<CanFrame> next_broadcast();
  /// Frames that this step, or a block of it, begins with: a block has a checksum after each frame that begins it.
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
  void on_status(Microseconds now, const StatusAnswer& status);
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

  // Requests to one module after the other.
  std::size_t target_ = 0;
  unsigned attempt_ = 0;
  bool is_unsent_ = false;       ///< the request waits for a mailbox
  bool begins_again_ = false;    ///< a module has not received `begin`, or has restarted
  unsigned rounds_ = 0;          ///< of symbols
  bool installs_again_ = false;  ///< a module has not received `install`
  Microseconds asked_at_ = 0;
  Microseconds longest_answer_ = 0;  ///< that was waited for

  // Symbols of one block after the other.
  unsigned block_ = 0;
  unsigned announced_ = 0;  ///< of announcements()
  unsigned symbol_ = 0;     ///< the next one of the block
  /// By block: what to send in this round, from `first` to before `end`.
  struct Plan {
    BlockKind kind = BlockKind::symbols;
    unsigned first = 0;
    unsigned end = 0;
  };
  std::array<Plan, max_blocks> plans_{};
  std::array<std::uint8_t, max_blocks> missing_{};       ///< the most that a module misses
  std::array<std::uint16_t, max_blocks> next_repair_{};  ///< repair symbols that were sent already
};

}  // namespace proleg::broadcast
