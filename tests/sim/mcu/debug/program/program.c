// A program for tests of the debugger: sums up readings without end.

#include <stdint.h>

extern int main(void);
extern void supervisor(void);

static void fault(void) {
  for (;;) {
  }
}

__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))0x20008000, (void (*)(void))main, fault, fault, fault, fault, fault, 0, 0, 0, 0, supervisor};

struct Reading {
  uint16_t number;
  int32_t value;
};

volatile uint32_t rounds = 500;
volatile uint32_t calls = 0;
volatile struct Reading last = {7, -40};
volatile int32_t total = 1000;

__attribute__((noinline)) int32_t take_reading(uint16_t number, int32_t scale) {
  last.number = number;
  last.value = scale * (int32_t)number;
  return last.value;
}

void supervisor(void) { calls = calls + 1; }

int main(void) {
  for (;;) {
    total = 0;
    for (uint16_t number = 1; number <= 4; ++number) {
      total += take_reading(number, -10);
    }
    rounds = rounds + 1;  // the place of a breakpoint
    __asm__ volatile("svc 0");
  }
}
