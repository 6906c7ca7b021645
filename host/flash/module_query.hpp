#pragma once

// What modules say of the program that they run (shared/broadcast/transfer_frame.hpp): their state, and the header of
// the image in slot A. Bootloaders and programs answer alike, also without a node id, and when two have the same one.

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "shared/broadcast/transfer_frame.hpp"
#include "shared/image/image_header.hpp"

namespace proleg::host {

struct ModuleProgram {
  std::uint32_t serial = 0;  ///< object 0x1018:4
  bool has_answered = false;
  broadcast::StatusAnswer status{};    ///< if it has answered
  std::optional<image::Header> image;  ///< nothing: there is none, or its header is damaged

  [[nodiscard]] bool is(std::uint8_t flag) const { return (status.condition.flags & flag) != 0; }
};

struct ModuleQueryOptions {
  /// Of an answer, at first; then four times the longest one of a module, doubled with each attempt.
  Microseconds answer_timeout_us = 60'000;
  unsigned attempts = 8;  ///< of a request until it is answered
};

class ModuleQuery final : public BusUser {
 public:
  /// port: must outlive this.
  explicit ModuleQuery(CanPort& port, const ModuleQueryOptions& options = {}) : port_(port), options_(options) {}
  ModuleQuery(const ModuleQuery&) = delete;
  ModuleQuery& operator=(const ModuleQuery&) = delete;

  /// Asks one module after the other: two answers would have the same identifier.
  void start(Microseconds now, const std::vector<std::uint32_t>& serials);
  [[nodiscard]] bool is_done() const { return next_ == modules_.size(); }
  /// In the order of the serial numbers given.
  [[nodiscard]] const std::vector<ModuleProgram>& modules() const { return modules_; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override { return is_done() ? never : deadline_; }

 private:
  /// Words of a header that are not always 0: up to the signature, and the CRC at the end.
  static constexpr unsigned first_words = 40;
  static constexpr unsigned last_word = image::header_size / 4 - 1;
  /// Requests to a module that wait for their answers: it answers them in order.
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
  std::size_t next_ = 0;          ///< the module that is asked
  std::deque<CanFrame> waiting_;  ///< the port had no room for them
  image::HeaderBytes bytes_{};
  std::vector<std::uint8_t> missing_;  ///< words, in the order in which they are asked for
  std::size_t asked_ = 0;              ///< of these
  unsigned attempt_ = 0;
  Microseconds asked_at_ = 0;
  Microseconds longest_answer_ = 0;
  Microseconds deadline_ = never;
};

}  // namespace proleg::host
