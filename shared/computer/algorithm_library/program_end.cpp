#include "shared/computer/algorithm_library/program_end.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "shared/computer/algorithm_library/last_line.hpp"
#include "shared/computer/algorithm_library/thread_guard.hpp"

namespace proleg {
namespace {

/// The file of a library that is loaded; a fault elsewhere can be the work of its threads. Set once.
std::atomic<const char*> foreign_code = nullptr;
/// What the library destroys at the end is not guarded.
std::atomic<bool> program_ends = false;

void on_quick_exit() {
  if (const ThreadGuard* const guard = current_guard; guard != nullptr && guard->is_active) {
    end_program_after(*guard, "calls quick_exit()", without_results);
  }
  LastLine line;
  line << "proleg: " << foreign_code.load() << ": a thread that this library started calls quick_exit()"
       << without_results;
  line.end_program();
}

}  // namespace

void blame_for_crashes(const char* file) {
  const char* none = nullptr;
  if (!foreign_code.compare_exchange_strong(none, file)) {
    return;
  }
  // Called before the destructors of the library, which was loaded earlier.
  std::atexit([] {
    if (!program_ends && gettid() != getpid()) {  // programs of this tree end with the return from main()
      LastLine line;
      line << "proleg: " << foreign_code.load() << ": a thread that this library started calls exit()"
           << without_results;
      line.end_program();
    }
    program_ends = true;
  });
  std::at_quick_exit(on_quick_exit);
}

const char* blamed_file() { return foreign_code; }

void expect_program_end() { program_ends = true; }

bool program_is_ending() { return program_ends; }

void end_program_after_crash(int signal) {
  const char* const file = foreign_code;
  LastLine line;
  if (program_ends) {
    line << "proleg: " << file << ": crashes (SIG" << sigabbrev_np(signal) << ") at the end of the program: "
         << "the destructor of one of its objects?";
  } else {
    line << "proleg: the program has crashed (SIG" << sigabbrev_np(signal) << ") outside of a call of " << file
         << ": a thread that this library started can be the reason, or memory that it has overwritten";
  }
  line.end_program();
}

void end_program_that_stays() {
  LastLine line;
  line << "proleg: " << foreign_code.load()
       << ": does not end with the program: an endless loop in the destructor of one of its objects?";
  line.end_program();
}

}  // namespace proleg
