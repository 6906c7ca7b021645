// Vector table and start-up of the test image. No interrupt is ever enabled, so the table ends after the exceptions of
// the CPU itself.

#include <cstdint>

extern "C" {

extern const std::uint32_t data_load[];
extern std::uint32_t data_start[];
extern std::uint32_t data_end[];
extern std::uint32_t bss_start[];
extern std::uint32_t bss_end[];
extern std::uint32_t stack_top[];
extern void (*const constructors_start[])();
extern void (*const constructors_end[])();

/// The image is ready: from here on the harness calls its functions.
[[noreturn]] void wait_for_calls() {
  for (;;) {
    asm volatile("wfi");
  }
}

/// Every exception of the CPU: stops where the harness detects it.
[[noreturn]] void fault_handler() {
  for (;;) {
    asm volatile("udf #0");
  }
}

[[noreturn]] void reset_handler() {
  const std::uint32_t* source = data_load;
  for (std::uint32_t* target = data_start; target != data_end; ++target) {
    *target = *source;
    ++source;
  }
  for (std::uint32_t* target = bss_start; target != bss_end; ++target) {
    *target = 0;
  }
  for (auto constructor = constructors_start; constructor != constructors_end; ++constructor) {
    (*constructor)();
  }
  wait_for_calls();
}

/// Called by the virtual functions that no algorithm has overridden; there is none.
[[noreturn]] void __cxa_pure_virtual() { fault_handler(); }

}  // extern "C"

namespace {

struct VectorTable {
  const std::uint32_t* initial_stack;
  void (*handlers[15])();
};

[[gnu::section(".vectors"), gnu::used]] const VectorTable vectors{
    stack_top,
    {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, nullptr, nullptr,
     nullptr, nullptr, fault_handler, fault_handler, nullptr, fault_handler, fault_handler}};

}  // namespace
