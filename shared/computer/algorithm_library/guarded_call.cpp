#include "shared/computer/algorithm_library/guarded_call.hpp"

#include <pthread.h>
#include <sys/mman.h>

#include <array>
#include <csetjmp>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>

#include "shared/computer/algorithm_library/call_watchdog.hpp"
#include "shared/computer/algorithm_library/floating_point_modes.hpp"
#include "shared/computer/algorithm_library/guard_signals.hpp"
#include "shared/computer/algorithm_library/kept_signals.hpp"
#include "shared/computer/algorithm_library/thread_guard.hpp"

namespace proleg {
namespace {

constexpr std::size_t signal_stack_size = 64 * 1024;

/// The guard of a thread, from its first guarded call to its end.
class GuardOwner {
 public:
  GuardOwner() {
    catch_guard_signals();
    stack_t present{};
    sigaltstack(nullptr, &present);
    if ((present.ss_flags & SS_DISABLE) != 0) {
      void* const memory = mmap(nullptr, signal_stack_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      if (memory != MAP_FAILED) {
        stack_ = memory;
        stack_t stack{};
        stack.ss_sp = memory;
        stack.ss_size = signal_stack_size;
        sigaltstack(&stack, nullptr);
      }
    }
    current_guard = &guard_;
  }
  ~GuardOwner() {
    if (guard_.is_active) {
      end_program_after(guard_, "calls exit()", without_results);
    }
    current_guard = nullptr;
    forget_calls(guard_);
    if (stack_ != nullptr) {
      stack_t none{};
      none.ss_flags = SS_DISABLE;
      sigaltstack(&none, nullptr);
      munmap(stack_, signal_stack_size);
    }
  }
  GuardOwner(const GuardOwner&) = delete;
  GuardOwner& operator=(const GuardOwner&) = delete;

  ThreadGuard& guard() {
    if (!watches_calls(guard_)) {
      guard_.thread = pthread_self();
      pthread_sigmask(SIG_SETMASK, nullptr, &guard_.mask);
      watch_calls(guard_);
    }
    return guard_;
  }

 private:
  ThreadGuard guard_;
  void* stack_ = nullptr;
};

enum class End : std::uint8_t { returned, exception, signal };

/// Has no objects with destructors: a signal leaves it in the middle.
[[gnu::noinline]] End enter(ThreadGuard& guard, void (*function)(void*), void* context) {
  if (sigsetjmp(guard.jump, 0) != 0) {
    return End::signal;
  }
  ++guard.call;
  guard.is_terminated = false;
  guard.is_active = true;
  try {
    function(context);
    guard.is_active = false;
    return End::returned;
  } catch (const std::exception& error) {
    std::snprintf(guard.exception.data(), guard.exception.size(), "%s", error.what());
  } catch (...) {
    guard.exception[0] = '\0';
  }
  guard.is_active = false;
  return End::exception;
}

}  // namespace

bool run_guarded(const CallSubject& subject, void (*function)(void*), void* context, CallFailure& failure) {
  thread_local GuardOwner owner;
  ThreadGuard& guard = owner.guard();
  guard.subject = subject.name;
  guard.function = subject.function;
  const FloatingPointModes modes;
  const End end = enter(guard, function, context);
  modes.restore();
  if (do_libraries_change_signals()) {
    restore_ending_signals();
  }
  if (guard.is_look_due) {  // not after each call: it takes a microsecond
    guard.is_look_due = false;
    pthread_sigmask(SIG_SETMASK, &guard.mask, nullptr);
  }
  switch (end) {
    case End::returned:
      return true;
    case End::exception:
      failure = {guard.exception[0] == '\0' ? "throws an exception"
                                            : std::string("throws an exception: ") + guard.exception.data(),
                 nullptr};
      return false;
    case End::signal:
      break;
  }
  check_after_signal(guard);
  failure = {text_of(guard), guard.address.value_or(nullptr)};
  if (guard.address) {
    std::array<char, 32> address{};
    std::snprintf(address.data(), address.size(), "%p", *guard.address);
    failure.text += std::string(", at the address ") + (*guard.address == nullptr ? "0" : address.data());
  } else if (is_bad_access(guard.signal)) {
    failure.text = std::string("sends itself the signal SIG") + sigabbrev_np(guard.signal);
  }
  return false;
}

}  // namespace proleg
