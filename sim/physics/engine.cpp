#include "sim/physics/engine.hpp"

#include <ode/ode.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <mutex>

#include "sim/physics/physics_error.hpp"

namespace proleg::sim {
namespace {

thread_local std::size_t message_count = 0;

void count_message(int /*number*/, const char* /*format*/, va_list /*arguments*/) { ++message_count; }

// The engine ends the process when this returns; an exception is the only way out.
[[noreturn]] void raise_error(int number, const char* format, va_list arguments) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  throw PhysicsError("the physics engine reports error " + std::to_string(number) + ": " + text.data());
}

}  // namespace

void prepare_engine_for_this_thread() {
  static std::once_flag once;
  std::call_once(once, [] {
    dInitODE2(0);
    dSetMessageHandler(count_message);
    dSetErrorHandler(raise_error);
    dSetDebugHandler(raise_error);
  });
  dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll));
}

std::size_t engine_messages() { return message_count; }

}  // namespace proleg::sim
