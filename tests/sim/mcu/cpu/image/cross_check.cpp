// A program that prints over USART1 what its CPU computes, one line a subject: for two different models of the CPU.

#include <array>
#include <cstdint>

extern "C" {

extern std::uint32_t bss_start[];
extern std::uint32_t bss_end[];
extern std::uint32_t stack_top[];

}  // extern "C"

namespace {

volatile std::uint32_t& at(std::uint32_t address) { return *reinterpret_cast<volatile std::uint32_t*>(address); }

// USART1 (RM0090, 30.6) and the System Control Space (DDI 0403, B3.2).
constexpr std::uint32_t rcc_apb2enr = 0x4002'3844;
constexpr std::uint32_t usart_sr = 0x4001'1000;
constexpr std::uint32_t usart_dr = 0x4001'1004;
constexpr std::uint32_t usart_brr = 0x4001'1008;
constexpr std::uint32_t usart_cr1 = 0x4001'100C;
constexpr std::uint32_t syst_csr = 0xE000'E010;
constexpr std::uint32_t syst_rvr = 0xE000'E014;
constexpr std::uint32_t syst_cvr = 0xE000'E018;
constexpr std::uint32_t nvic_iser = 0xE000'E100;
constexpr std::uint32_t nvic_ispr = 0xE000'E200;
constexpr std::uint32_t nvic_iabr = 0xE000'E300;
constexpr std::uint32_t nvic_ipr = 0xE000'E400;
constexpr std::uint32_t icsr = 0xE000'ED04;
constexpr std::uint32_t aircr = 0xE000'ED0C;
constexpr std::uint32_t shpr1 = 0xE000'ED18;
constexpr std::uint32_t shpr2 = 0xE000'ED1C;
constexpr std::uint32_t shpr3 = 0xE000'ED20;
constexpr std::uint32_t shcsr = 0xE000'ED24;
constexpr std::uint32_t cfsr = 0xE000'ED28;
constexpr std::uint32_t hfsr = 0xE000'ED2C;
constexpr std::uint32_t bfar = 0xE000'ED38;

/// FNV-1a over words.
class Digest {
 public:
  void add(std::uint32_t word) {
    for (unsigned i = 0; i < 4; ++i) {
      value_ = (value_ ^ (word >> 8U * i & 0xFFU)) * 0x0100'0193U;
    }
  }
  [[nodiscard]] std::uint32_t value() const { return value_; }

 private:
  std::uint32_t value_ = 0x811C'9DC5;
};

void put(char character) {
  while ((at(usart_sr) & 0x80U) == 0) {
  }
  at(usart_dr) = static_cast<std::uint32_t>(character);
}

void print(const char* text) {
  for (; *text != '\0'; ++text) {
    put(*text);
  }
}

void print(const char* name, std::uint32_t value) {
  print(name);
  put(' ');
  for (int shift = 28; shift >= 0; shift -= 4) {
    put("0123456789abcdef"[value >> static_cast<unsigned>(shift) & 0xFU]);
  }
  put('\n');
}

/// xorshift32, with the values that matter most in between.
class Numbers {
 public:
  std::uint32_t next() {
    constexpr std::uint32_t corners[]{0,           1,           2,           0x7FFF'FFFF, 0x8000'0000,
                                      0xFFFF'FFFF, 0xFFFF'8000, 0x0000'7FFF, 0x8000'7FFF, 0x7F80'80FF};
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 17U;
    state_ ^= state_ << 5U;
    return state_ % 4 == 0 ? corners[(state_ >> 4U) % std::size(corners)] : state_;
  }

 private:
  std::uint32_t state_ = 0x1234'5678;
};

constexpr int rounds = 2000;

/// An instruction with two operands, its result and the flags it leaves.
#define BINARY(instruction)                                           \
  {                                                                   \
    std::uint32_t result = c;                                         \
    std::uint32_t flags = 0;                                          \
    asm volatile("msr apsr_nzcvqg, %4\n" instruction "\nmrs %1, apsr" \
                 : "+&r"(result), "=&r"(flags)                        \
                 : "r"(a), "r"(b), "r"(d)                             \
                 : "cc");                                             \
    digest.add(result);                                               \
    digest.add(flags & 0xF80F'0000U);                                 \
  }

/// One with a result of 64 bits.
#define LONG(instruction)                                                        \
  {                                                                              \
    std::uint32_t low = c;                                                       \
    std::uint32_t high = d;                                                      \
    asm volatile(instruction : "+&r"(low), "+&r"(high) : "r"(a), "r"(b) : "cc"); \
    digest.add(low);                                                             \
    digest.add(high);                                                            \
  }

template <typename Function>
void subject(const char* name, Function function) {
  Digest digest;
  Numbers numbers;
  for (int i = 0; i < rounds; ++i) {
    const std::uint32_t a = numbers.next();
    const std::uint32_t b = numbers.next();
    const std::uint32_t c = numbers.next();
    const std::uint32_t d = numbers.next() & 0xF80F'0000U;
    function(digest, a, b, c, d);
  }
  print(name, digest.value());
}

void arithmetic() {
  subject("add", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("adds %0, %2, %3")
    BINARY("adcs %0, %2, %3")
    BINARY("subs %0, %2, %3")
    BINARY("sbcs %0, %2, %3")
    BINARY("rsbs %0, %2, %3")
    BINARY("adds %0, %2, %3, lsl #7")
    BINARY("subs %0, %2, %3, ror #13")
    BINARY("cmn %2, %3")
    BINARY("cmp %2, %3, asr #5")
  });
  subject("logic", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("ands %0, %2, %3, lsr #3")
    BINARY("orrs %0, %2, %3, asr #31")
    BINARY("eors %0, %2, %3, rrx")
    BINARY("bics %0, %2, %3, lsl #31")
    BINARY("orns %0, %2, %3")
    BINARY("mvns %0, %2, ror #1")
    BINARY("tst %2, #0xFF000000")
    BINARY("teq %2, %3")
    BINARY("movs %0, #0x80000000")
  });
  subject("shift", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("lsls %0, %2, %3")
    BINARY("lsrs %0, %2, %3")
    BINARY("asrs %0, %2, %3")
    BINARY("rors %0, %2, %3")
    BINARY("lsls %0, %2, #31")
    BINARY("lsrs %0, %2, #32")
    BINARY("asrs %0, %2, #32")
    BINARY("rrxs %0, %2")
  });
  subject("bits", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("clz %0, %2")
    BINARY("rbit %0, %2")
    BINARY("rev %0, %2")
    BINARY("rev16 %0, %2")
    BINARY("revsh %0, %2")
    BINARY("bfi %0, %2, #5, #13")
    BINARY("bfc %0, #3, #20")
    BINARY("ubfx %0, %2, #7, #11")
    BINARY("sbfx %0, %2, #9, #17")
    BINARY("sxtb %0, %2, ror #8")
    BINARY("uxtah %0, %2, %3, ror #16")
    BINARY("sxtab16 %0, %2, %3, ror #24")
    BINARY("pkhbt %0, %2, %3, lsl #4")
    BINARY("pkhtb %0, %2, %3, asr #9")
  });
  subject("multiply", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("mul %0, %2, %3")
    BINARY("mla %0, %2, %3, %0")
    BINARY("mls %0, %2, %3, %0")
    BINARY("smulbt %0, %2, %3")
    BINARY("smlatb %0, %2, %3, %0")
    BINARY("smulwt %0, %2, %3")
    BINARY("smlawb %0, %2, %3, %0")
    BINARY("smmulr %0, %2, %3")
    BINARY("smmla %0, %2, %3, %0")
    BINARY("smmlsr %0, %2, %3, %0")
    BINARY("smuad %0, %2, %3")
    BINARY("smusdx %0, %2, %3")
    BINARY("smladx %0, %2, %3, %0")
    BINARY("smlsd %0, %2, %3, %0")
    LONG("umull %0, %1, %2, %3")
    LONG("smull %0, %1, %2, %3")
    LONG("umlal %0, %1, %2, %3")
    LONG("smlal %0, %1, %2, %3")
    LONG("umaal %0, %1, %2, %3")
    LONG("smlalbt %0, %1, %2, %3")
    LONG("smlald %0, %1, %2, %3")
    LONG("smlsldx %0, %1, %2, %3")
  });
  subject("divide", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("sdiv %0, %2, %3")
    BINARY("udiv %0, %2, %3")
    BINARY("sdiv %0, %3, %2")
    BINARY("udiv %0, %3, %0")
  });
  subject("saturate", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("ssat %0, #13, %2, lsl #3")
    BINARY("usat %0, #9, %2, asr #7")
    BINARY("ssat16 %0, #7, %2")
    BINARY("usat16 %0, #5, %2")
    BINARY("qadd %0, %2, %3")
    BINARY("qsub %0, %2, %3")
    BINARY("qdadd %0, %2, %3")
    BINARY("qdsub %0, %2, %3")
    BINARY("qadd16 %0, %2, %3")
    BINARY("qsax %0, %2, %3")
    BINARY("uqadd8 %0, %2, %3")
    BINARY("uqsub16 %0, %2, %3")
  });
  subject("parallel", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("sadd16 %0, %2, %3")
    BINARY("ssub8 %0, %2, %3")
    BINARY("uadd8 %0, %2, %3")
    BINARY("usub16 %0, %2, %3")
    BINARY("sasx %0, %2, %3")
    BINARY("uadd8 %0, %2, %3\nsel %0, %2, %3")
    BINARY("shadd8 %0, %2, %3")
    BINARY("uhsax %0, %2, %3")
    BINARY("usad8 %0, %2, %3")
    BINARY("usada8 %0, %2, %3, %0")
  });
  subject("conditional", [](Digest& digest, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    BINARY("cmp %2, %3\nittee hi\naddhi %0, %2, #1\nsubhi %0, #3\nmvnls %0, %2\neorls %0, %3")
    BINARY("cmp %2, %3\nitet lt\nmovlt %0, %2\nmovge %0, %3\naddlt %0, #9")
    BINARY("ite vs\nmovvs %0, #1\nmovvc %0, #2")
    BINARY("cmp %2, %3\nbgt 1f\nadds %0, #1\n1:\nbmi 2f\nadds %0, #4\n2:")
    BINARY("cbz %2, 1f\nadd %0, #1\n1: cbnz %3, 2f\nadd %0, #2\n2:")
    BINARY("cmp %2, #0\nit eq\ncmpeq %3, #0\nit ne\nmovne %0, #77")
  });
}

std::uint32_t memory[64];

void memory_accesses() {
  Digest digest;
  Numbers numbers;
  for (int i = 0; i < rounds; ++i) {
    for (std::uint32_t& word : memory) {
      word = numbers.next();
    }
    auto* const base = reinterpret_cast<std::uint8_t*>(memory) + 64;
    const std::uint32_t offset = numbers.next() % 32;
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint32_t moved = reinterpret_cast<std::uint32_t>(base);
    // Also where the address is not a multiple of the size.
    asm volatile("ldr %0, [%2, %3]\nldrsh %1, [%2, %3]" : "=&r"(a), "=&r"(b) : "r"(base), "r"(offset) : "memory");
    digest.add(a);
    digest.add(b);
    asm volatile("str %0, [%2, %3]\nstrh %1, [%2, #-7]\nldrsb %0, [%2, %3, lsl #1]"
                 : "+&r"(a)
                 : "r"(b), "r"(base), "r"(offset)
                 : "memory");
    digest.add(a);
    asm volatile("ldr %0, [%2], #8\nldr %1, [%2, #-4]!\nstr %0, [%2, #12]!\nstrb %1, [%2], #-3"
                 : "=&r"(a), "=&r"(b), "+&r"(moved)
                 :
                 : "memory");
    digest.add(moved);
    asm volatile(
        "ldmia %0!, {r4-r7}\nstmdb %0!, {r5, r7}\nldrd r4, r5, [%0, #-8]\nstrd r6, r4, [%0], #4\nldmdb %0, {r4, r8}\n"
        "mov r6, r8\nstmia %0, {r4-r6}"
        : "+r"(moved = reinterpret_cast<std::uint32_t>(base))
        :
        : "memory", "r4", "r5", "r6", "r7", "r8");
    digest.add(moved);
    for (const std::uint32_t word : memory) {
      digest.add(word);
    }
  }
  print("memory", digest.value());
}

void exclusive_accesses() {
  Digest digest;
  Numbers numbers;
  for (int i = 0; i < rounds; ++i) {
    memory[0] = numbers.next();
    std::uint32_t loaded = 0;
    std::uint32_t failed = 0;
    asm volatile("ldrex %0, [%2]\nadds %0, #1\nstrex %1, %0, [%2]"
                 : "=&r"(loaded), "=&r"(failed)
                 : "r"(memory)
                 : "memory", "cc");
    digest.add(loaded);
    digest.add(failed);
    // Without a load before, or after CLREX, it fails.
    asm volatile("strexb %0, %1, [%2]" : "=&r"(failed) : "r"(loaded), "r"(memory) : "memory");
    digest.add(failed);
    asm volatile("ldrexh %0, [%2]\nclrex\nstrexh %1, %0, [%2]" : "=&r"(loaded), "=&r"(failed) : "r"(memory) : "memory");
    digest.add(failed);
    digest.add(memory[0]);
  }
  print("exclusive", digest.value());
}

void table_branches() {
  Digest digest;
  for (std::uint32_t i = 0; i < 64; ++i) {
    std::uint32_t result = 0;
    asm volatile(
        "tbb [pc, %1]\n"
        "1: .byte (2f - 1b) / 2, (3f - 1b) / 2, (4f - 1b) / 2, (5f - 1b) / 2\n"
        "2: adds %0, #1\n"
        "3: adds %0, #10\n"
        "4: adds %0, #100\n"
        "5: nop"
        : "+r"(result)
        : "r"(i % 4)
        : "cc");
    digest.add(result);
  }
  print("tables", digest.value());
}

// Exceptions.

volatile std::uint32_t ticks;
Digest order;

void systick_handler() { ticks = ticks + 1; }

void wait_for_ticks() {
  at(syst_rvr) = 20'000;
  at(syst_cvr) = 0;
  at(syst_csr) = 7;
  while (ticks < 20) {
    asm volatile("wfi");
  }
  at(syst_csr) = 0;
  at(icsr) = 1U << 25U;
  print("ticks", ticks < 20 ? 0U : 20U);
}

[[gnu::naked]] void svc_handler() {
  // Result: the frame's words and the number behind SVC.
  asm volatile(
      "tst lr, #4\n"
      "ite eq\n"
      "mrseq r0, msp\n"
      "mrsne r0, psp\n"
      "mov r1, lr\n"
      "b %0"
      :
      : "i"(+[](std::uint32_t* frame, std::uint32_t exc_return) {
        const auto* const code = reinterpret_cast<const std::uint8_t*>(frame[6]);
        order.add(code[-2]);
        for (unsigned i = 0; i < 5; ++i) {
          order.add(frame[i]);
        }
        order.add(frame[7]);
        order.add(exc_return);
        order.add(at(icsr) & 0x1FFU);
        frame[0] = frame[0] * 3 + frame[1];
      }));
}

std::uint32_t supervisor_call(std::uint32_t a, std::uint32_t b, std::uint32_t flags) {
  register std::uint32_t r0 asm("r0") = a;
  register std::uint32_t r1 asm("r1") = b;
  register std::uint32_t r2 asm("r2") = a ^ b;
  register std::uint32_t r3 asm("r3") = a + b;
  register std::uint32_t r12 asm("r12") = a - b;
  asm volatile("msr apsr_nzcvqg, %5\nsvc #77\nmrs %1, apsr"
               : "+r"(r0), "+r"(r1), "+r"(r2), "+r"(r3), "+r"(r12)
               : "r"(flags)
               : "memory", "cc");
  order.add(r1 & 0xF80F'0000U);
  order.add(r2);
  order.add(r3);
  order.add(r12);
  return r0;
}

void pendsv_handler() {
  order.add(14);
  order.add(at(icsr) & 0xF'F1FFU);
}

void interrupt_handler() {
  std::uint32_t number = 0;
  asm volatile("mrs %0, ipsr" : "=r"(number));
  order.add(number);
  order.add(at(nvic_iabr));
  order.add(at(icsr));
  // 20 is below 21, 22 above both, 23 as 21.
  // Without barriers models differ in when what is pending is taken.
  if (number == 16 + 20) {
    at(nvic_ispr) = 1U << 21U;
    asm volatile("dsb\nisb" ::: "memory");
    at(icsr) = 1U << 28U;
    asm volatile("dsb\nisb" ::: "memory");
  } else if (number == 16 + 21) {
    at(nvic_ispr) = 1U << 22U | 1U << 23U;
    asm volatile("dsb\nisb" ::: "memory");
  }
  order.add(0x8000'0000U + number);
  order.add(at(nvic_ispr));
}

void nested_interrupts() {
  at(shpr3) = 0x00F0'0000;
  at(nvic_ipr + 20) = 0x6040'60A0;
  at(nvic_iser) = 0xFU << 20U;
  for (int i = 0; i < 10; ++i) {
    at(nvic_ispr) = 1U << 20U;
    asm volatile("dsb\nisb" ::: "memory");
    order.add(1);
    // Masked, then not.
    asm volatile("cpsid i");
    at(nvic_ispr) = 1U << 20U | 1U << 22U;
    asm volatile("dsb\nisb" ::: "memory");
    order.add(2);
    asm volatile("cpsie i\nisb" ::: "memory");
    order.add(3);
    asm volatile("msr basepri, %0" ::"r"(0x60));
    at(nvic_ispr) = 1U << 21U | 1U << 22U;
    asm volatile("dsb\nisb" ::: "memory");
    order.add(4);
    asm volatile("msr basepri, %0\nisb" ::"r"(0) : "memory");
    order.add(5);
  }
  print("interrupts", order.value());
}

void supervisor_calls() {
  Numbers numbers;
  for (int i = 0; i < 100; ++i) {
    const std::uint32_t a = numbers.next();
    const std::uint32_t b = numbers.next();
    order.add(supervisor_call(a, b, numbers.next() & 0xF80F'0000U));
  }
  print("calls", order.value());
}

std::uint32_t process_stack[64];

void process_stack_calls() {
  // On the process stack and back.
  asm volatile(
      "msr psp, %0\n"
      "movs r0, #2\n"
      "msr control, r0\n"
      "isb" ::"r"(process_stack + 60)
      : "r0", "memory");
  asm volatile("movs r0, #5\nmovs r1, #7\nmovs r2, #0\nmovs r3, #0\nmov r12, r3\nsvc #3" ::
                   : "r0", "r1", "r2", "r3", "r12", "cc", "memory");
  std::uint32_t control = 0;
  std::uint32_t psp = 0;
  asm volatile("mrs %0, control\nmrs %1, psp" : "=r"(control), "=r"(psp));
  asm volatile("movs r0, #0\nmsr control, r0\nisb" ::: "r0", "memory");
  order.add(control);
  order.add(psp - reinterpret_cast<std::uint32_t>(process_stack));
  print("process", order.value());
}

/// Notes the fault and continues behind the instruction, of 4 bytes, that caused it.
[[gnu::naked]] void fault_handler() {
  asm volatile(
      "mov r0, sp\n"
      "b %0"
      :
      : "i"(+[](std::uint32_t* frame) {
        std::uint32_t number = 0;
        asm volatile("mrs %0, ipsr" : "=r"(number));
        order.add(number);
        order.add(at(cfsr));
        order.add(at(hfsr));
        order.add((at(cfsr) & 0x8000U) != 0 ? at(bfar) : 0U);
        order.add(frame[6]);
        order.add(frame[7]);
        at(cfsr) = 0xFFFF'FFFF;
        at(hfsr) = 0xFFFF'FFFF;
        frame[6] += 4;
      }));
}

void faults() {
  for (const bool enabled : {false, true}) {
    at(shcsr) = enabled ? 7U << 16U : 0U;
    at(shpr1) = 0x0020'2020;
    asm volatile("dsb\nisb" ::: "memory");
    asm volatile("udf.w #0");
    asm volatile("movs r0, #5\nldr.w r1, [%0]\nadds r0, #1" ::"r"(0x6000'0010) : "r0", "r1", "cc", "memory");
    asm volatile("movs r0, #5\nstr.w r0, [%0, #8]\nadds r0, #1" ::"r"(0x6000'0010) : "r0", "cc", "memory");
  }
  print("faults", order.value());
}

[[noreturn]] void reset_handler_body() {
  for (std::uint32_t* word = bss_start; word != bss_end; ++word) {
    *word = 0;
  }
  order = Digest();
  at(rcc_apb2enr) = 1U << 4U;
  at(usart_brr) = 139;
  at(usart_cr1) = 0x200C;
  at(aircr) = 0x05FA'0000;
  at(shpr2) = 0x1000'0000;
  arithmetic();
  memory_accesses();
  exclusive_accesses();
  table_branches();
  wait_for_ticks();
  nested_interrupts();
  supervisor_calls();
  process_stack_calls();
  faults();
  print("end\n");
  for (;;) {
    asm volatile("wfi");
  }
}

constexpr unsigned exception_count = 98;

struct VectorTable {
  const std::uint32_t* initial_stack;
  void (*handlers[exception_count - 1])();
};

constexpr VectorTable make_vectors() {
  VectorTable table{stack_top, {}};
  for (auto& handler : table.handlers) {
    handler = interrupt_handler;
  }
  table.handlers[0] = reset_handler_body;
  for (unsigned fault = 2; fault <= 5; ++fault) {
    table.handlers[fault] = fault_handler;
  }
  table.handlers[10] = svc_handler;
  table.handlers[13] = pendsv_handler;
  table.handlers[14] = systick_handler;
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vectors = make_vectors();

}  // namespace

extern "C" [[noreturn]] void reset_handler() { reset_handler_body(); }
