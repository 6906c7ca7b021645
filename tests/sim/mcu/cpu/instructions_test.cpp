// Each form of instruction against an independent program: Unicorn executes the same halfwords with the same registers
// and memory. The forms are those of the ARMv7-M Architecture Reference Manual, DDI 0403, A5.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <string_view>

#include "shared/fixed/random.hpp"
#include "sim/mcu/cpu/engine.hpp"
#include "sim/mcu/cpu/thumb.hpp"
#include "tests/sim/mcu/cpu/reference_cpu.hpp"

namespace proleg::sim {
namespace {

using Registers = ReferenceCpu::Registers;

constexpr std::uint32_t code_address = ChipMemory::ram_start + 0x10000;

/// Nothing lies around the CPU. Notes whether it was asked.
class NoSurroundings final : public EngineClient {
 public:
  std::uint32_t load(std::uint32_t /*address*/, unsigned /*size*/) override { return note(0); }
  void store(std::uint32_t /*address*/, unsigned /*size*/, std::uint32_t /*value*/) override {
    static_cast<void>(note(0));
  }
  bool store_to_flash(std::uint32_t /*address*/, unsigned /*size*/, std::uint32_t /*value*/) override {
    return note(0) != 0;
  }
  bool stops() override { return false; }
  [[nodiscard]] bool coprocessor_allowed() const override { return false; }
  [[nodiscard]] bool is_forbidden(std::uint32_t /*address*/) const override { return true; }
  void send_event() override {}

  bool was_asked = false;

 private:
  std::uint32_t note(std::uint32_t value) {
    was_asked = true;
    return value;
  }
};

struct Outcome {
  End end;
  Registers registers;
};

/// Both processors, with the same memory.
class Pair {
 public:
  Pair() : engine_(surroundings_), reference_(ChipMemory::ram_start, ChipMemory::ram_size) {
    Pcg32 noise(1, 1);
    for (std::uint8_t& byte : reference_.memory()) {
      byte = static_cast<std::uint8_t>(noise.next());
    }
    std::memcpy(ram(), reference_.memory().data(), ChipMemory::ram_size);
  }

  [[nodiscard]] std::uint8_t* ram() { return engine_.ram(ChipMemory::ram_start, ChipMemory::ram_size); }

  /// registers[15] is where the halfwords are.
  Outcome execute(const Registers& registers, std::uint16_t first, std::uint16_t second) {
    const std::array<std::uint16_t, 2> code{first, second};
    const std::size_t place = registers[15] - ChipMemory::ram_start;
    std::memcpy(ram() + place, code.data(), sizeof code);
    std::memcpy(reference_.memory().data() + place, code.data(), sizeof code);
    for (std::size_t i = 0; i < registers.size(); ++i) {
      engine_.write(static_cast<CoreRegister>(i), registers[i]);
    }
    surroundings_.was_asked = false;
    Outcome outcome{engine_.step(), {}};
    for (std::size_t i = 0; i < registers.size(); ++i) {
      outcome.registers[i] = engine_.read(static_cast<CoreRegister>(i));
    }
    return outcome;
  }
  ReferenceCpu::Step execute_reference(const Registers& registers, std::uint16_t first) {
    ReferenceCpu::Step step = reference_.execute(registers, static_cast<std::uint32_t>(instruction_size(first)));
    step.registers[13] &= ~3U;  // always 0 (DDI 0403, B1.4.1); Unicorn 2.0.1 keeps them in sums
    return step;
  }

  [[nodiscard]] bool was_asked() const { return surroundings_.was_asked; }
  [[nodiscard]] bool have_same_memory() {
    return std::memcmp(ram(), reference_.memory().data(), ChipMemory::ram_size) == 0;
  }
  void copy_memory() { std::memcpy(reference_.memory().data(), ram(), ChipMemory::ram_size); }

 private:
  NoSurroundings surroundings_;
  Engine engine_;
  ReferenceCpu reference_;
};

/// Numbers at which results change, others, and addresses of the memory.
std::uint32_t drawn_value(Pcg32& random) {
  constexpr std::array<std::uint32_t, 12> corners{0,      1,      2,           0x7FFF'FFFF, 0x8000'0000, 0xFFFF'FFFF,
                                                  0x7FFF, 0x8000, 0xFFFF'8000, 0x7FFF'8000, 0x8000'8000, 31};
  switch (random.below(5)) {
    case 0:
      return corners.at(random.below(corners.size()));
    case 1:
      return random.next();
    case 2:
      return random.below(64);
    default: {
      const std::uint32_t address = ChipMemory::ram_start + 0x8000 + random.below(0x4000);
      return random.below(4) == 0 ? address : address & ~3U;
    }
  }
}

Registers drawn_registers(Pcg32& random, std::uint32_t it_state) {
  constexpr std::uint32_t flags = 0xF80F'0000;
  Registers registers{};
  for (std::size_t i = 0; i < 15; ++i) {
    registers[i] = drawn_value(random);
  }
  registers[13] &= ~3U;
  registers[15] = code_address + 2 * random.below(4);
  registers[16] = (random.next() & flags) | thumb_state | (it_state & 3U) << 25U | (it_state & ~3U) << 8U;
  return registers;
}

std::string text_of(std::uint16_t first, std::uint16_t second, const Registers& before, const Registers& ours,
                    const Registers& theirs) {
  std::ostringstream text;
  text << std::hex << std::setfill('0') << std::setw(4) << first << ' ' << std::setw(4) << second;
  for (std::size_t i = 0; i < before.size(); ++i) {
    text << "\n  r" << std::dec << i << std::hex << ": " << before[i] << " -> " << ours[i]
         << (ours[i] == theirs[i] ? "" : ", expected ");
    if (ours[i] != theirs[i]) {
      text << theirs[i];
    }
  }
  return text.str();
}

/// What became of the cases of a form.
struct Count {
  int executed = 0;
  int faults = 0;
  int refused = 0;
};

class InstructionSet : public testing::Test {
 protected:
  /// Executes a case on both; they must do the same. False: this CPU says that there is no such instruction.
  bool compare(std::uint16_t first, std::uint16_t second, std::uint32_t it_state, Count& count) {
    const Registers before = drawn_registers(random_, it_state);
    const Outcome ours = pair_.execute(before, first, second);
    if (ours.end == End::undefined_instruction || ours.end == End::no_coprocessor) {
      ++count.refused;
      return false;
    }
    if (ours.end == End::unaligned_access || pair_.was_asked()) {
      pair_.copy_memory();
      ++count.faults;
      return true;
    }
    const ReferenceCpu::Step theirs = pair_.execute_reference(before, first);
    if (ours.end == End::memory_fault) {
      EXPECT_FALSE(theirs.is_executed) << text_of(first, second, before, ours.registers, theirs.registers);
      pair_.copy_memory();
      ++count.faults;
      return true;
    }
    // What Unicorn notes at once.
    const std::uint32_t next = ours.registers[15];
    const bool leads_nowhere =
        !Engine::is_memory(next, 2) || next < ChipMemory::ram_start || (ours.registers[16] & thumb_state) == 0;
    EXPECT_TRUE(theirs.is_executed || leads_nowhere)
        << text_of(first, second, before, ours.registers, theirs.registers);
    EXPECT_EQ(ours.registers, theirs.registers) << text_of(first, second, before, ours.registers, theirs.registers);
    EXPECT_TRUE(pair_.have_same_memory()) << text_of(first, second, before, ours.registers, theirs.registers);
    ++count.executed;
    return true;
  }

  Pcg32 random_{7, 3};
  Pair pair_;
};

/// Encodings of two bytes that the manual leaves undefined or unpredictable (A5.2), or that end a run in another way
/// than by a result: SVC, BKPT, WFE, WFI, SEV, CPS.
bool is_refused_or_special(unsigned code) {
  const unsigned d = (code & 7U) | (code >> 4U & 8U);
  const unsigned m = code >> 3U & 15U;
  const unsigned base = code >> 8U & 7U;
  const unsigned list = code & 0xFFU;
  switch (code >> 8U) {
    case 0x44:
      return d == 15 && m == 15;
    case 0x45:
      return (d < 8 && m < 8) || d == 15 || m == 15;
    case 0x47:
      return (code & 7U) != 0 || m == 15;
    case 0xB4:
    case 0xBC:
      return list == 0;
    case 0xBE:
    case 0xDE:
    case 0xDF:
      return true;
    case 0xB6:
      return true;  // CPS and SETEND
    case 0xB7:
    case 0xB8:
      return true;
    case 0xBA:
      return (code >> 6U & 3U) == 2;
    case 0xBF: {
      const unsigned condition = code >> 4U & 15U;
      const unsigned mask = code & 15U;
      return mask == 0 ? condition >= 1 : condition == 15 || (condition == 14 && (mask & (mask - 1)) != 0);
    }
    default:
      break;
  }
  if (code >> 12U == 0xC) {
    const bool has_base = (list >> base & 1U) != 0;
    const bool is_store = (code & 0x0800U) == 0;
    return list == 0 || (is_store && has_base && (list & ((1U << base) - 1U)) != 0);
  }
  return false;
}

TEST_F(InstructionSet, EveryInstructionOfTwoBytesDoesWhatUnicornDoes) {
  Count count;
  for (unsigned code = 0; code < 0xE800; ++code) {
    if (is_refused_or_special(code)) {
      continue;
    }
    for (int round = 0; round < 3; ++round) {
      ASSERT_TRUE(compare(static_cast<std::uint16_t>(code), 0xBF00, 0, count)) << std::hex << code;
      if (HasFailure()) {
        return;
      }
    }
  }
  std::cout << count.executed << " executed, " << count.faults << " faults\n";
  EXPECT_GT(count.executed, 100'000);
}

TEST_F(InstructionSet, InAnItBlockItIsExecutedIfItsConditionHolds) {
  Count count;
  for (unsigned code = 0; code < 0xB000; ++code) {
    if (is_refused_or_special(code)) {
      continue;
    }
    // The last one of a block, with any condition; branches must be the last.
    const std::uint32_t it_state = random_.below(15) << 4U | 8U;
    ASSERT_TRUE(compare(static_cast<std::uint16_t>(code), 0xBF00, it_state, count)) << std::hex << code;
    if (HasFailure()) {
      return;
    }
  }
  EXPECT_GT(count.executed, 30'000);
}

/// A form of four bytes: 32 characters, 0 and 1 as they are, letters for fields; of those, d, n, m, a, t and u are
/// registers.
struct Form {
  std::string_view name;
  std::string_view pattern;
  std::string_view may_be_sp = "";  ///< the registers that may be the stack pointer
  std::string_view may_be_pc = "";
};

// A5.3 and the pages of A7.7.
constexpr Form forms[]{
    {"LDMIA", "1110100010W1nnnnPM0lllllllllllll", "n"},
    {"STMIA", "1110100010W0nnnn0M0lllllllllllll", "n"},
    {"LDMDB", "1110100100W1nnnnPM0lllllllllllll", "n"},
    {"STMDB", "1110100100W0nnnn0M0lllllllllllll", "n"},
    {"LDRD offset", "11101001U101nnnnttttuuuuiiiiiiii", "n", "n"},
    {"LDRD pre-indexed", "11101001U111nnnnttttuuuuiiiiiiii", "n"},
    {"LDRD post-indexed", "11101000U111nnnnttttuuuuiiiiiiii", "n"},
    {"STRD offset", "11101001U100nnnnttttuuuuiiiiiiii", "n"},
    {"STRD pre-indexed", "11101001U110nnnnttttuuuuiiiiiiii", "n"},
    {"STRD post-indexed", "11101000U110nnnnttttuuuuiiiiiiii", "n"},
    {"TBB", "111010001101nnnn111100000000mmmm", "", "n"},
    {"TBH", "111010001101nnnn111100000001mmmm", "", "n"},
    {"AND register", "11101010000Snnnn0iiiddddiittmmmm"},
    {"TST register", "111010100001nnnn0iii1111iittmmmm"},
    {"BIC register", "11101010001Snnnn0iiiddddiittmmmm"},
    {"ORR register", "11101010010Snnnn0iiiddddiittmmmm"},
    {"MOV register", "11101010010S11110iiiddddiittmmmm", "dm"},
    {"ORN register", "11101010011Snnnn0iiiddddiittmmmm"},
    {"MVN register", "11101010011S11110iiiddddiittmmmm"},
    {"EOR register", "11101010100Snnnn0iiiddddiittmmmm"},
    {"TEQ register", "111010101001nnnn0iii1111iittmmmm"},
    {"PKH", "111010101100nnnn0iiiddddiiT0mmmm"},
    {"ADD register", "11101011000Snnnn0iiiddddiittmmmm", "n"},
    {"CMN register", "111010110001nnnn0iii1111iittmmmm", "n"},
    {"ADC register", "11101011010Snnnn0iiiddddiittmmmm"},
    {"SBC register", "11101011011Snnnn0iiiddddiittmmmm"},
    {"SUB register", "11101011101Snnnn0iiiddddiittmmmm", "n"},
    {"CMP register", "111010111011nnnn0iii1111iittmmmm", "n"},
    {"RSB register", "11101011110Snnnn0iiiddddiittmmmm"},
    {"AND constant", "11110i00000Snnnn0iiiddddcccccccc"},
    {"TST constant", "11110i000001nnnn0iii1111cccccccc"},
    {"BIC constant", "11110i00001Snnnn0iiiddddcccccccc"},
    {"ORR constant", "11110i00010Snnnn0iiiddddcccccccc"},
    {"MOV constant", "11110i00010S11110iiiddddcccccccc"},
    {"ORN constant", "11110i00011Snnnn0iiiddddcccccccc"},
    {"MVN constant", "11110i00011S11110iiiddddcccccccc"},
    {"EOR constant", "11110i00100Snnnn0iiiddddcccccccc"},
    {"TEQ constant", "11110i001001nnnn0iii1111cccccccc"},
    {"ADD constant", "11110i01000Snnnn0iiiddddcccccccc", "n"},
    {"CMN constant", "11110i010001nnnn0iii1111cccccccc", "n"},
    {"ADC constant", "11110i01010Snnnn0iiiddddcccccccc"},
    {"SBC constant", "11110i01011Snnnn0iiiddddcccccccc"},
    {"SUB constant", "11110i01101Snnnn0iiiddddcccccccc", "n"},
    {"CMP constant", "11110i011011nnnn0iii1111cccccccc", "n"},
    {"RSB constant", "11110i01110Snnnn0iiiddddcccccccc"},
    {"ADDW", "11110i100000nnnn0iiiddddcccccccc", "n", "n"},
    {"MOVW", "11110i100100kkkk0iiiddddcccccccc"},
    {"SUBW", "11110i101010nnnn0iiiddddcccccccc", "n", "n"},
    {"MOVT", "11110i101100kkkk0iiiddddcccccccc"},
    {"SSAT", "111100110000nnnn0iiiddddii0sssss"},
    {"SSAT, shifted to the right", "111100110010nnnn0001ddddii0sssss"},
    {"SSAT16", "111100110010nnnn0000dddd0000ssss"},
    {"SBFX", "111100110100nnnn0iiiddddii0wwwww"},
    {"BFI", "111100110110nnnn0iiiddddii0wwwww", "", "n"},
    {"USAT", "111100111000nnnn0iiiddddii0sssss"},
    {"USAT, shifted to the right", "111100111010nnnn0001ddddii0sssss"},
    {"USAT16", "111100111010nnnn0000dddd0000ssss"},
    {"UBFX", "111100111100nnnn0iiiddddii0wwwww"},
    {"B with a condition", "11110Sccccjjjjjj10J0Jkkkkkkkkkkk"},
    {"B", "11110Sjjjjjjjjjj10J1Jkkkkkkkkkkk"},
    {"BL", "11110Sjjjjjjjjjj11J1Jkkkkkkkkkkk"},
    {"STRB offset", "111110001000nnnnttttiiiiiiiiiiii", "n"},
    {"STRH offset", "111110001010nnnnttttiiiiiiiiiiii", "n"},
    {"STR offset", "111110001100nnnnttttiiiiiiiiiiii", "nt"},
    {"STRB indexed by a constant", "111110000000nnnntttt1PUWiiiiiiii", "n"},
    {"STRH indexed by a constant", "111110000010nnnntttt1PUWiiiiiiii", "n"},
    {"STR indexed by a constant", "111110000100nnnntttt1PUWiiiiiiii", "nt"},
    {"STRB register", "111110000000nnnntttt000000iimmmm", "n"},
    {"STRH register", "111110000010nnnntttt000000iimmmm", "n"},
    {"STR register", "111110000100nnnntttt000000iimmmm", "nt"},
    {"LDRB offset", "111110001001nnnnttttiiiiiiiiiiii", "n", "nt"},
    {"LDRH offset", "111110001011nnnnttttiiiiiiiiiiii", "n", "nt"},
    {"LDR offset", "111110001101nnnnttttiiiiiiiiiiii", "nt", "nt"},
    {"LDR of a literal", "11111000U1011111ttttiiiiiiiiiiii", "t", "t"},
    {"LDRB of a literal", "11111000U0011111ttttiiiiiiiiiiii", "", "t"},
    {"LDRH of a literal", "11111000U0111111ttttiiiiiiiiiiii", "", "t"},
    {"LDRSB of a literal", "11111001U0011111ttttiiiiiiiiiiii", "", "t"},
    {"LDRSH of a literal", "11111001U0111111ttttiiiiiiiiiiii", "", "t"},
    {"LDRSB offset", "111110011001nnnnttttiiiiiiiiiiii", "n", "nt"},
    {"LDRSH offset", "111110011011nnnnttttiiiiiiiiiiii", "n", "nt"},
    {"LDRB indexed by a constant", "111110000001nnnntttt1PUWiiiiiiii", "n", "n"},
    {"LDRH indexed by a constant", "111110000011nnnntttt1PUWiiiiiiii", "n", "n"},
    {"LDR indexed by a constant", "111110000101nnnntttt1PUWiiiiiiii", "nt", "nt"},
    {"LDRSB indexed by a constant", "111110010001nnnntttt1PUWiiiiiiii", "n", "n"},
    {"LDRSH indexed by a constant", "111110010011nnnntttt1PUWiiiiiiii", "n", "n"},
    {"LDRB register", "111110000001nnnntttt000000iimmmm", "n", "n"},
    {"LDRH register", "111110000011nnnntttt000000iimmmm", "n", "n"},
    {"LDR register", "111110000101nnnntttt000000iimmmm", "nt", "nt"},
    {"LDRSB register", "111110010001nnnntttt000000iimmmm", "n", "n"},
    {"LDRSH register", "111110010011nnnntttt000000iimmmm", "n", "n"},
    {"shift by a register", "111110100TTSnnnn1111dddd0000mmmm"},
    {"SXTAH, UXTAH", "11111010000Unnnn1111dddd10rrmmmm", "", "n"},
    {"SXTAB16, UXTAB16", "11111010001Unnnn1111dddd10rrmmmm", "", "n"},
    {"SXTAB, UXTAB", "11111010010Unnnn1111dddd10rrmmmm", "", "n"},
    {"ADD8, SUB8", "111110101o00nnnn1111dddd0Ukkmmmm"},
    {"ADD16, SUB16", "111110101o01nnnn1111dddd0Ukkmmmm"},
    {"ASX, SAX", "111110101o10nnnn1111dddd0Ukkmmmm"},
    {"QADD, QDADD, QSUB, QDSUB", "111110101000nnnn1111dddd10oommmm"},
    {"SEL", "111110101010nnnn1111dddd1000mmmm"},
    {"MLA, MUL", "111110110000nnnnaaaadddd0000mmmm", "", "a"},
    {"MLS", "111110110000nnnnaaaadddd0001mmmm"},
    {"SMLABB, SMULBB", "111110110001nnnnaaaadddd00xymmmm", "", "a"},
    {"SMLAD, SMUAD", "111110110010nnnnaaaadddd000xmmmm", "", "a"},
    {"SMLAWB, SMULWB", "111110110011nnnnaaaadddd000xmmmm", "", "a"},
    {"SMLSD, SMUSD", "111110110100nnnnaaaadddd000xmmmm", "", "a"},
    {"SMMLA, SMMUL", "111110110101nnnnaaaadddd000xmmmm", "", "a"},
    {"SMMLS", "111110110110nnnnaaaadddd000xmmmm"},
    {"USADA8, USAD8", "111110110111nnnnaaaadddd0000mmmm", "", "a"},
    {"SMULL", "111110111000nnnnaaaadddd0000mmmm"},
    {"SDIV", "111110111001nnnn1111dddd1111mmmm"},
    {"UMULL", "111110111010nnnnaaaadddd0000mmmm"},
    {"UDIV", "111110111011nnnn1111dddd1111mmmm"},
    {"SMLAL", "111110111100nnnnaaaadddd0000mmmm"},
    {"SMLALBB", "111110111100nnnnaaaadddd10xymmmm"},
    {"SMLALD", "111110111100nnnnaaaadddd110xmmmm"},
    {"SMLSLD", "111110111101nnnnaaaadddd110xmmmm"},
    {"UMLAL", "111110111110nnnnaaaadddd0000mmmm"},
    {"UMAAL", "111110111110nnnnaaaadddd0110mmmm"},
};

/// Random bits for the letters of a form.
class Drawn {
 public:
  Drawn(const Form& form, Pcg32& random) : form_(&form), word_(0) {
    const std::uint32_t noise = random.next();
    for (unsigned i = 0; i < 32; ++i) {
      const char letter = form.pattern[i];
      const std::uint32_t bit = letter == '0' ? 0U : letter == '1' ? 1U : noise >> (31 - i) & 1U;
      word_ |= bit << (31 - i);
    }
  }

  [[nodiscard]] std::uint16_t first() const { return static_cast<std::uint16_t>(word_ >> 16U); }
  [[nodiscard]] std::uint16_t second() const { return static_cast<std::uint16_t>(word_); }
  [[nodiscard]] bool has(char letter) const { return form_->pattern.find(letter) != std::string_view::npos; }
  /// All bits of a letter, in their order.
  [[nodiscard]] unsigned field(char letter) const {
    unsigned value = 0;
    for (unsigned i = 0; i < 32; ++i) {
      if (form_->pattern[i] == letter) {
        value = value << 1U | (word_ >> (31 - i) & 1U);
      }
    }
    return value;
  }
  /// Whether the letter is a field of four bits.
  [[nodiscard]] bool is_register(char letter) const {
    return std::count(form_->pattern.begin(), form_->pattern.end(), letter) == 4;
  }

  /// Whether the manual allows a processor to do anything, or the encoding is another instruction: by its registers, or
  /// a rule of its form.
  [[nodiscard]] bool may_be_refused() const {
    for (const char letter : std::string_view("dnmatu")) {
      if (!is_register(letter)) {
        continue;
      }
      const unsigned number = field(letter);
      if ((number == 13 && form_->may_be_sp.find(letter) == std::string_view::npos) ||
          (number == 15 && form_->may_be_pc.find(letter) == std::string_view::npos)) {
        return true;
      }
    }
    return breaks_a_rule();
  }

 private:
  [[nodiscard]] bool breaks_a_rule() const {
    const std::string_view name = form_->name;
    const auto starts = [&](std::string_view text) { return name.starts_with(text); };
    if (starts("LDM") || starts("STM")) {
      const bool is_kept = field('W') != 0;
      return std::popcount(second()) < 2 || (is_kept && (second() >> field('n') & 1U) != 0) ||
             (field('M') != 0 && has('P') && field('P') != 0);
    }
    if (starts("LDRD") || starts("STRD")) {
      const bool is_kept = name.find("indexed") != std::string_view::npos;
      return field('t') == field('u') || (is_kept && (field('n') == field('t') || field('n') == field('u')));
    }
    if (name.find("indexed") != std::string_view::npos) {
      const bool is_kept = field('W') != 0;
      const bool is_unprivileged = field('P') != 0 && field('U') != 0 && !is_kept;
      return field('n') == field('t') || (is_unprivileged && (field('t') == 13 || field('t') == 15)) ||
             (field('P') == 0 && !is_kept) || (is_kept && field('t') == 15);
    }
    if (starts("MOV register")) {
      const bool is_of_sp = field('d') == 13 || field('m') == 13;
      const bool is_plain = field('S') == 0 && field('i') == 0 && field('t') == 0;
      return is_of_sp && (!is_plain || field('d') == field('m'));
    }
    if (name.ends_with("constant") && !has('P')) {
      return field('c') == 0;  // repeated zeros
    }
    if (starts("SBFX") || starts("UBFX")) {
      return field('i') + field('w') > 31;
    }
    if (starts("BFI")) {
      return field('w') < field('i');
    }
    if (starts("B with")) {
      return field('c') >= 14;
    }
    if (starts("ADD8") || starts("ADD16") || starts("ASX")) {
      return field('k') == 3;
    }
    if (has('a') && !form_->may_be_pc.starts_with('a') && starts("SM") && name != "SMMLS") {
      return field('a') == field('d');
    }
    return starts("UM") && field('a') == field('d');
  }

  const Form* form_;
  std::uint32_t word_;
};

class WideForms : public InstructionSet, public testing::WithParamInterface<Form> {};

TEST_P(WideForms, DoesWhatUnicornDoes) {
  constexpr int cases = 2000;
  Count count;
  for (int i = 0; i < cases && !HasFailure(); ++i) {
    const Drawn drawn(GetParam(), random_);
    const bool is_known = compare(drawn.first(), drawn.second(), 0, count);
    EXPECT_TRUE(is_known || drawn.may_be_refused()) << std::hex << drawn.first() << ' ' << drawn.second();
  }
  // Most branches lead to where nothing is, which is no fault yet.
  EXPECT_GT(count.executed, cases / 20) << count.faults << " faults, " << count.refused << " refused";
}

INSTANTIATE_TEST_SUITE_P(All, WideForms, testing::ValuesIn(forms), [](const auto& form) {
  std::string name;
  for (const char letter : form.param.name) {
    name += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
  }
  return name;
});

}  // namespace
}  // namespace proleg::sim
