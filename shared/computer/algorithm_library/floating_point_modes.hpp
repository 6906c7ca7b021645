#pragma once

#include <cfenv>
#include <cstdint>

namespace proleg {

/// How the processor computes floating point in this thread: rounding, denormal numbers, exceptions. Code that changes
/// it changes the results of all that is computed later. fegetenv() and fesetenv() take ten times as long.
class FloatingPointModes {
 public:
  FloatingPointModes() { read(); }

  /// Sets the modes again if they differ now.
  void restore() const {
    if (const FloatingPointModes now; !is_same(now)) {
      write();
    }
  }

 private:
#if defined(__x86_64__) || defined(__i386__)
  void read() {
    sse_ = __builtin_ia32_stmxcsr();
    asm volatile("fnstcw %0" : "=m"(x87_));
  }
  void write() const {
    __builtin_ia32_ldmxcsr(sse_);
    asm volatile("fldcw %0" : : "m"(x87_));
  }
  [[nodiscard]] bool is_same(const FloatingPointModes& other) const {
    constexpr std::uint32_t modes = ~0x3FU;  // the others are flags of what has happened
    return ((sse_ ^ other.sse_) & modes) == 0 && x87_ == other.x87_;
  }

  std::uint32_t sse_ = 0;
  std::uint16_t x87_ = 0;
#else
  void read() { std::fegetenv(&modes_); }
  void write() const { std::fesetenv(&modes_); }
  [[nodiscard]] static bool is_same(const FloatingPointModes& /*other*/) { return false; }

  std::fenv_t modes_{};
#endif
};

}  // namespace proleg
