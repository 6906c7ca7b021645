#include "shared/computer/algorithm_library/thread_guard.hpp"

#include "shared/computer/algorithm_library/last_line.hpp"

namespace proleg {

constinit thread_local ThreadGuard* current_guard = nullptr;

const char* text_of(const ThreadGuard& guard) {
  switch (guard.signal) {
    case SIGSEGV:
    case SIGBUS:
      return "uses memory that does not exist or is not its own";
    case SIGFPE:
      return "divides by zero, or the result of a division is too large";
    case SIGILL:
      return "executes an instruction that this processor does not have";
    case SIGABRT:
      return guard.is_terminated ? "throws an exception out of a function that is noexcept" : "calls abort()";
    default:
      return guard.waits ? "does not return within 20 s: does it wait or sleep?"
                         : "does not return within a second of processor time: an endless loop?";
  }
}

[[noreturn]] void end_program_after(const ThreadGuard& guard, const char* what, const char* consequence) {
  LastLine line;
  line << "proleg: " << guard.subject << " " << what << ", in " << guard.function << "()" << consequence;
  line.end_program();
}

}  // namespace proleg
