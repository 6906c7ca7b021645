#pragma once

// How a program ends that has loaded code which has not been checked: faults outside of its guarded calls
// (guarded_call.hpp) end the program with one line that names it.

namespace proleg {

/// From now on, a crash outside of a guarded call, a call of exit() in another thread than the first, and a library
/// that keeps the program from ending for three seconds print one line that names this file and end the program with
/// status 1. To be called after a guarded call that has loaded the library. The first file stays. file: must live until
/// the program ends.
void blame_for_crashes(const char* file);

/// The file that is blamed; null if there is none.
[[nodiscard]] const char* blamed_file();

/// All work is done and all results are written: what runs from now on is what libraries do at the end of the program.
void expect_program_end();

/// Whether that has been said, or exit() has been called.
[[nodiscard]] bool program_is_ending();

/// Prints the line about a crash outside of a guarded call. There is a file that is blamed.
[[noreturn]] void end_program_after_crash(int signal);

/// Prints the line about a library that does not end with the program. There is a file that is blamed.
[[noreturn]] void end_program_that_stays();

}  // namespace proleg
