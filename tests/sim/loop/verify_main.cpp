// Verifies a recording and prints the hashes; linked once for each compiler that has made a core.
//   verify_VARIANT RECORDING

#include <cstdio>
#include <exception>

#include "sim/loop/verification.hpp"

int main(int argument_count, char** arguments) {
  if (argument_count != 2) {
    std::fputs("found other arguments, expected a recording\n", stderr);
    return 2;
  }
  try {
    const proleg::sim::Verification result = verify(proleg::sim::Recording(arguments[1]));
    std::printf("%llu %s %s\n", static_cast<unsigned long long>(result.differences), result.setpoint_hash.c_str(),
                result.servo_hash.c_str());
    return result.differences == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
