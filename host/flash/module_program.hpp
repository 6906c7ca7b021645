#pragma once

// The programs of modules: reads what modules report about the program that they run, and decides what flashing an
// image would do to a module, before anything is sent.

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "shared/broadcast/transfer_frame.hpp"
#include "shared/image/image_header.hpp"

namespace proleg::host {

struct ModuleProgram {
  std::uint32_t serial = 0;  ///< object 0x1018:4
  bool has_answered = false;
  broadcast::StatusAnswer status{};  ///< valid if the module has answered
  /// Nothing: there is no image, its header is damaged, or words of it are missing.
  std::optional<image::Header> image;
  broadcast::TrustSummary trust{};  ///< which images it takes; valid if no words are missing and there is an image
  /// Number of words of the header that the module was asked for and that were not received.
  unsigned missing_words = 0;

  [[nodiscard]] bool is(std::uint8_t flag) const { return (status.condition.flags & flag) != 0; }
};

struct ModuleQueryOptions {
  /// Timeout of the first answer of a module; later it is four times the longest answer of the module, doubled with
  /// each attempt.
  Microseconds answer_timeout_us = 60'000;
  Microseconds longest_timeout_us = 150'000;
  unsigned attempts = 12;  ///< number of times in a row that a request is sent without an answer, as in a transfer
};

/// Reads what modules report about the program that they run (shared/broadcast/transfer_frame.hpp): their state, and
/// the header of the image in slot A. Bootloaders and programs answer in the same way, also without a node id, and when
/// two have the same node id.
class ModuleQuery final : public BusUser {
 public:
  /// port: must outlive this.
  explicit ModuleQuery(CanPort& port, const ModuleQueryOptions& options = {}) : port_(port), options_(options) {}
  ModuleQuery(const ModuleQuery&) = delete;
  ModuleQuery& operator=(const ModuleQuery&) = delete;

  /// Asks one module after the other, because two answers would have the same identifier.
  void start(Microseconds now, const std::vector<std::uint32_t>& serials);
  [[nodiscard]] bool is_done() const { return next_ == modules_.size(); }
  /// The programs of the modules, in the order of the serial numbers given.
  [[nodiscard]] const std::vector<ModuleProgram>& modules() const { return modules_; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override { return is_done() ? never : deadline_; }

 private:
  /// Number of the first words of a header, up to its last field. Those behind them, except the CRC at the end, are
  /// always 0.
  static constexpr unsigned first_words = image::layout::next_key_end / 4;
  static constexpr unsigned last_word = image::header_size / 4 - 1;
  /// Greatest number of requests to a module that wait for answers; it answers them in order.
  static constexpr std::size_t max_parallel = 4;

  void begin_module(Microseconds now);
  void next_module(Microseconds now);
  void ask(Microseconds now);
  void send_waiting();
  void take_word(Microseconds now, const broadcast::HeaderWord& word);
  [[nodiscard]] ModuleProgram& module() { return modules_[next_]; }

  CanPort& port_;
  ModuleQueryOptions options_;
  std::vector<ModuleProgram> modules_;
  std::size_t next_ = 0;          ///< index of the module that is asked
  std::deque<CanFrame> waiting_;  ///< frames for which the port had no room
  image::HeaderBytes bytes_{};
  std::vector<std::uint8_t> missing_;  ///< missing words, in the order of their requests
  std::size_t asked_ = 0;              ///< number of missing words that were requested
  unsigned attempt_ = 0;
  Microseconds asked_at_ = 0;
  Microseconds longest_answer_ = 0;
  Microseconds deadline_ = never;
};

/// A module that may be flashed.
struct FlashCandidate {
  ModuleProgram program;
  std::uint8_t node = 0;       ///< node id; 0: the module has none
  std::uint16_t board_id = 0;  ///< object 0x1018:2
  bool serves_objects = true;  ///< the module answers SDO; otherwise only LSS has found it
};

struct FlashPermissions {
  bool other_board = false;
  bool older_version = false;
};

enum class FlashAction : std::uint8_t {
  install,
  nothing,  ///< the module runs this image, confirmed
  refuse,
};

struct FlashVerdict {
  FlashAction action = FlashAction::refuse;
  std::string text;  ///< what changes, or why nothing changes; without a full stop
};

[[nodiscard]] FlashVerdict judge(const image::Header& image, const FlashCandidate& module,
                                 const FlashPermissions& permissions);

/// The number of a version, such as "0.1.0".
[[nodiscard]] std::string version_number_text(const image::Version& version);
/// The version of an image, such as "0.1.0 (5267b59d)", with a "+" behind the commit of sources that have
/// changed since, or to which users have added algorithms.
[[nodiscard]] std::string version_text(const image::Header& image);
/// The commit of an image, such as "5267b59d", or "unknown".
[[nodiscard]] std::string commit_text(const image::Header& image);

/// Whether two headers belong to the same image.
[[nodiscard]] bool is_same_image(const image::Header& one, const image::Header& other);

}  // namespace proleg::host
