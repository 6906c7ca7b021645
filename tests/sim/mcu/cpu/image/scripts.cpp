// A program that does what the test has written into RAM: a list of steps for thread mode and one for each exception.

#include <cstdint>

namespace {

constexpr unsigned exception_count = 98;
constexpr unsigned max_steps = 12;

enum class Action : std::uint32_t {
  end,
  store,      ///< value to address
  mark,       ///< value
  mark_load,  ///< what is read from address
  wait_for_interrupt,
  wait_for_event,
  send_event,
  supervisor_call,
  set_primask,    ///< by CPS
  set_faultmask,  ///< by CPS
  set_basepri,
  mark_basepri,
  mark_control,
  call,  ///< address
  spin,  ///< value rounds
};

struct Step {
  Action action;
  std::uint32_t address;
  std::uint32_t value;
};

volatile std::uint32_t& at(std::uint32_t address) { return *reinterpret_cast<volatile std::uint32_t*>(address); }

void mark(std::uint32_t value) { at(0x4000'0000) = value; }

}  // namespace

extern "C" {

/// Written by the test.
extern Step scripts[exception_count][max_steps];
[[gnu::section(".bss.scripts")]] Step scripts[exception_count][max_steps];
extern std::uint32_t stack_top[];

void play(std::uint32_t number) {
  for (const Step& step : scripts[number]) {
    switch (step.action) {
      case Action::end:
        return;
      case Action::store:
        at(step.address) = step.value;
        break;
      case Action::mark:
        mark(step.value);
        break;
      case Action::mark_load:
        mark(at(step.address));
        break;
      case Action::wait_for_interrupt:
        asm volatile("wfi" ::: "memory");
        break;
      case Action::wait_for_event:
        asm volatile("wfe" ::: "memory");
        break;
      case Action::send_event:
        asm volatile("sev" ::: "memory");
        break;
      case Action::supervisor_call:
        asm volatile("svc #1" ::: "memory");
        break;
      case Action::set_primask:
        if (step.value != 0) {
          asm volatile("cpsid i" ::: "memory");
        } else {
          asm volatile("cpsie i" ::: "memory");
        }
        break;
      case Action::set_faultmask:
        if (step.value != 0) {
          asm volatile("cpsid f" ::: "memory");
        } else {
          asm volatile("cpsie f" ::: "memory");
        }
        break;
      case Action::set_basepri:
        asm volatile("msr basepri, %0" ::"r"(step.value) : "memory");
        break;
      case Action::mark_basepri: {
        std::uint32_t value = 0;
        asm volatile("mrs %0, basepri" : "=r"(value));
        mark(value);
        break;
      }
      case Action::mark_control: {
        std::uint32_t value = 0;
        asm volatile("mrs %0, control" : "=r"(value));
        mark(value);
        break;
      }
      case Action::call:
        reinterpret_cast<void (*)()>(step.address)();
        break;
      case Action::spin:
        for (std::uint32_t i = 0; i < step.value; ++i) {
          asm volatile("nop");
        }
        break;
    }
  }
}

/// Marks its entry and its end: 0x1000 and 0x2000, with its number.
void scripted_handler() {
  std::uint32_t number = 0;
  asm volatile("mrs %0, ipsr" : "=r"(number));
  mark(0x1000 + number);
  play(number);
  mark(0x2000 + number);
}

[[noreturn]] void reset_handler() {
  play(0);
  mark(0x2000);
  for (;;) {
    asm volatile("wfi" ::: "memory");
  }
}

// For the trace of calls: three functions deep, each with its own frame.
[[gnu::noinline]] std::uint32_t third_function(std::uint32_t address) {
  volatile std::uint32_t room[4]{address, 2, 3, 4};
  const std::uint32_t value = at(room[0]);
  return value + room[1];
}

[[gnu::noinline]] std::uint32_t second_function(std::uint32_t address) {
  volatile std::uint32_t room[20]{address};
  return third_function(room[0]) + room[3];
}

[[noreturn]] void first_function() {
  mark(second_function(0x6000'0000));
  for (;;) {
    asm volatile("wfi" ::: "memory");
  }
}

/// As first_function, but in the handler of an interrupt.
void calling_handler() { mark(second_function(0x6000'0000) + 1); }

}  // extern "C"

namespace {

struct VectorTable {
  const std::uint32_t* initial_stack;
  void (*reset)();
  void (*handlers[exception_count - 2])();
};

constexpr VectorTable make_vectors() {
  VectorTable table{stack_top, reset_handler, {}};
  for (auto& handler : table.handlers) {
    handler = scripted_handler;
  }
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vectors = make_vectors();

}  // namespace
