#pragma once

// Which exceptions are pending, enabled and active, and which one comes next (ARMv7-M Architecture Reference Manual,
// DDI 0403, B1.5 and B3.4). Exceptions have numbers: 1 to 15 are the system's, 16 + n is interrupt n.

#include <array>
#include <bit>
#include <cstdint>

namespace proleg::sim {

/// Numbers of the system exceptions (DDI 0403, B1.5.2).
namespace exception {
inline constexpr unsigned reset = 1;
inline constexpr unsigned nmi = 2;
inline constexpr unsigned hard_fault = 3;
inline constexpr unsigned memory_management = 4;
inline constexpr unsigned bus_fault = 5;
inline constexpr unsigned usage_fault = 6;
inline constexpr unsigned supervisor_call = 11;
inline constexpr unsigned debug_monitor = 12;
inline constexpr unsigned pending_supervisor = 14;
inline constexpr unsigned system_tick = 15;
inline constexpr unsigned first_interrupt = 16;
}  // namespace exception

/// A set of exceptions.
class ExceptionSet {
 public:
  [[nodiscard]] bool has(unsigned number) const { return (words_[number / 64] >> (number % 64) & 1U) != 0; }
  void set(unsigned number, bool member) {
    const std::uint64_t bit = std::uint64_t{1} << (number % 64);
    words_[number / 64] = member ? words_[number / 64] | bit : words_[number / 64] & ~bit;
  }
  [[nodiscard]] bool is_empty() const { return (words_[0] | words_[1]) == 0; }
  [[nodiscard]] int count() const { return std::popcount(words_[0]) + std::popcount(words_[1]); }
  [[nodiscard]] ExceptionSet operator&(const ExceptionSet& other) const {
    return ExceptionSet({words_[0] & other.words_[0], words_[1] & other.words_[1]});
  }
  template <typename Function>
  void for_each(Function function) const {
    for (unsigned i = 0; i < 2; ++i) {
      for (std::uint64_t rest = words_[i]; rest != 0; rest &= rest - 1) {
        function(64 * i + static_cast<unsigned>(std::countr_zero(rest)));
      }
    }
  }
  ExceptionSet() = default;

 private:
  explicit ExceptionSet(std::array<std::uint64_t, 2> words) : words_(words) {}
  std::array<std::uint64_t, 2> words_{};
};

/// The registers that mask exceptions (DDI 0403, B1.4.3).
struct ExceptionMasks {
  std::uint32_t primask = 0;
  std::uint32_t basepri = 0;
  std::uint32_t faultmask = 0;
};

class Nvic {
 public:
  /// Interrupts of an STM32F405 (RM0090, table 61).
  static constexpr unsigned interrupt_count = 82;
  static constexpr unsigned exception_count = exception::first_interrupt + interrupt_count;
  /// Priority of thread mode: everything preempts it.
  static constexpr int no_priority = 256;
  /// Priorities have four bits (RM0090, 12.1.1).
  static constexpr std::uint8_t implemented_priority = 0xF0;

  Nvic() { reset(); }
  /// Lines keep their level.
  void reset();

  /// The level of an interrupt's line; pends it when it rises.
  void set_line(unsigned interrupt, bool high) { set_exception_line(exception::first_interrupt + interrupt, high); }
  /// The level of the line of NMI; pends NMI, which is always enabled, when it rises.
  void set_non_maskable_line(bool high) { set_exception_line(exception::nmi, high); }

  [[nodiscard]] bool is_pending(unsigned number) const { return pending_.has(number); }
  [[nodiscard]] bool is_enabled(unsigned number) const { return enabled_.has(number); }
  [[nodiscard]] bool is_active(unsigned number) const { return active_.has(number); }
  [[nodiscard]] std::uint8_t priority_register(unsigned number) const { return priorities_[number]; }
  [[nodiscard]] std::uint8_t priority_group() const { return priority_group_; }

  void set_pending(unsigned number, bool pending);
  void set_enabled(unsigned number, bool enabled);
  void set_priority(unsigned number, std::uint8_t priority);
  /// PRIGROUP, 0 to 7.
  void set_priority_group(std::uint8_t group);

  /// An exception is being taken: active, no longer pending.
  void activate(unsigned number);
  /// Called when the handler has returned. An interrupt whose line is still high pends again.
  void deactivate(unsigned number);
  [[nodiscard]] int active_count() const { return active_.count(); }

  /// The exception to take next, without regard to masks: pending, enabled, of the highest priority; 0 if none.
  [[nodiscard]] unsigned next() const { return next_; }
  /// Group priority of next(); no_priority if there is none.
  [[nodiscard]] int next_priority() const { return next_priority_; }
  /// Group priority of the active exceptions; no_priority in thread mode.
  [[nodiscard]] int active_priority() const { return active_priority_; }
  /// Execution priority (DDI 0403, B1.5.4).
  [[nodiscard]] int execution_priority(const ExceptionMasks& masks) const;
  /// Group priority of an exception.
  [[nodiscard]] int group_priority(unsigned number) const;
  /// Whether next() would be taken if masks were clear.
  [[nodiscard]] bool wants_attention() const { return next_priority_ < active_priority_; }

  /// ICSR.ISRPENDING.
  [[nodiscard]] bool any_interrupt_pending() const;

 private:
  [[nodiscard]] int priority(unsigned number) const;
  void set_exception_line(unsigned number, bool high);
  void find_next();
  void find_active();

  ExceptionSet pending_;
  ExceptionSet enabled_;
  ExceptionSet active_;
  ExceptionSet lines_;
  std::array<std::uint8_t, exception_count> priorities_{};
  std::uint8_t priority_group_ = 0;
  unsigned next_ = 0;
  int next_priority_ = no_priority;
  int active_priority_ = no_priority;
};

}  // namespace proleg::sim
