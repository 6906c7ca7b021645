#include "sim/mcu/cpu/cpu.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/random.hpp"
#include "sim/mcu/cpu/engine.hpp"
#include "sim/mcu/cpu/exceptions.hpp"
#include "sim/mcu/cpu/nvic.hpp"
#include "sim/mcu/cpu/system_control.hpp"

namespace proleg::sim {
namespace {

using namespace address_map;

/// The bit that a word of a bit-band alias region stands for (DDI 0403, B3.1; RM0090, 2.3.3).
struct AliasedBit {
  std::uint32_t address;  ///< of its word (peripherals) or byte (RAM)
  unsigned bit;
};

AliasedBit peripheral_bit(std::uint32_t alias) {
  const std::uint32_t offset = alias - peripheral_bits_start;
  return {peripherals_start + (offset >> 5U & ~3U), offset >> 2U & 31U};
}

AliasedBit ram_bit(std::uint32_t alias) {
  const std::uint32_t offset = alias - ram_bits_start;
  return {ChipMemory::ram_start + (offset >> 5U), offset >> 2U & 7U};
}

void fill_with_noise(std::span<std::uint8_t> bytes, Pcg32& noise) {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(noise.next());
  }
}

}  // namespace

class Cpu::Implementation final : public EngineClient, public SystemControlOwner {
 public:
  explicit Implementation(CpuSurroundings& surroundings)
      : surroundings_(&surroundings),
        engine_(*this),
        system_control_(*this, nvic_),
        exceptions_(engine_, nvic_, system_control_) {
    lose_memory(0);
    const std::vector<std::uint8_t> erased(ChipMemory::flash_size, 0xFF);
    static_cast<void>(engine_.write_memory(ChipMemory::flash_start, erased));
    static_cast<void>(
        engine_.write_memory(ChipMemory::system_memory_start, std::span(erased).first(ChipMemory::system_memory_size)));
  }

  void lose_memory(std::uint64_t seed) {
    Pcg32 noise(seed, 0);
    fill_with_noise({engine_.ram(ChipMemory::ram_start, ChipMemory::ram_size), ChipMemory::ram_size}, noise);
    fill_with_noise({engine_.ram(ChipMemory::ccm_start, ChipMemory::ccm_size), ChipMemory::ccm_size}, noise);
  }

  void restart() {
    halt_reason_.clear();
    stop_requested_ = false;
    wants_halt_ = false;
    idle_turns_ = 0;
    sleep_priority_ = Nvic::no_priority;
    state_ = State::running;
    exceptions_.reset();
    apply_traps();
  }

  State run(std::uint64_t instructions) {
    if (!begin()) {
      return state_;
    }
    const std::uint64_t done = engine_.instructions();
    limit_ =
        done + std::min(std::max<std::uint64_t>(instructions, 1), std::numeric_limits<std::uint64_t>::max() - done);
    while (prepare() && engine_.instructions() < limit_) {
      const std::uint64_t before = engine_.instructions();
      engine_.set_limit(limit_);
      handle(engine_.run());
      require_progress(engine_.instructions() - before);
    }
    return state_;
  }

  void step() {
    if (begin() && prepare()) {
      limit_ = std::numeric_limits<std::uint64_t>::max();
      engine_.pass_breakpoint(true);
      handle(engine_.step());
      static_cast<void>(prepare_to_stop());
    }
  }

  void limit(std::uint64_t total) {
    limit_ = std::min(limit_, total);
    attend();
  }

  void pause() {
    stop_requested_ = true;
    attend();
  }

  [[nodiscard]] bool wakes() const {
    const int priority = state_ == State::sleeping ? sleep_priority_ : priority_without_primask();
    return nvic_.next_priority() < priority;
  }

  void advance_system_tick() {
    system_control_.system_tick().advance(now());
    system_control_.collect_system_tick();
  }

  void read(std::uint32_t address, std::span<std::uint8_t> bytes) const {
    if (!engine_.read_memory(address, bytes)) {
      throw no_memory(address, bytes.size());
    }
    for (const Write& write : writes_) {
      for (std::size_t i = 0; i < write.bytes.size(); ++i) {
        const std::uint64_t place = std::uint64_t{write.address} + i - address;
        if (place < bytes.size()) {
          bytes[place] = write.bytes[i];
        }
      }
    }
  }

  void write(std::uint32_t address, std::span<const std::uint8_t> bytes) {
    if (!Engine::is_memory(address, bytes.size())) {
      throw no_memory(address, bytes.size());
    }
    if (engine_.is_running() && engine_.ram(address, static_cast<std::uint32_t>(bytes.size())) == nullptr) {
      writes_.push_back({address, {bytes.begin(), bytes.end()}});
      attend();
      return;
    }
    static_cast<void>(engine_.write_memory(address, bytes));
    exceptions_.discard_vectors();
  }

  [[nodiscard]] std::uint32_t core_register(unsigned number) const { return engine_.read(named(number)); }

  void set_core_register(unsigned number, std::uint32_t value) {
    constexpr std::uint32_t number_mask = 0x1FF;
    engine_.write(named(number), number == 16 ? (value & ~number_mask) | thumb_state | exceptions_.current() : value);
  }

  // EngineClient
  [[nodiscard]] std::uint32_t load(std::uint32_t address, unsigned size) override {
    if (address >= SystemControl::start) {
      return system_control_.load(address, size);
    }
    if (address - peripheral_bits_start < peripheral_bits_size) {
      const AliasedBit aliased = peripheral_bit(address);
      return surroundings_->load(aliased.address, 4) >> aliased.bit & 1U;
    }
    if (address - ram_bits_start < ram_bits_size) {
      const AliasedBit aliased = ram_bit(address);
      return static_cast<std::uint32_t>(*engine_.ram(aliased.address, 1)) >> aliased.bit & 1U;
    }
    return surroundings_->load(address, size);
  }

  void store(std::uint32_t address, unsigned size, std::uint32_t value) override {
    if (address >= SystemControl::start) {
      system_control_.store(address, size, value);
      apply_traps();
    } else if (address - peripheral_bits_start < peripheral_bits_size) {
      const AliasedBit aliased = peripheral_bit(address);
      const std::uint32_t bit = 1U << aliased.bit;
      const std::uint32_t old = surroundings_->load(aliased.address, 4);
      surroundings_->store(aliased.address, 4, (value & 1U) != 0 ? old | bit : old & ~bit);
    } else if (address - ram_bits_start < ram_bits_size) {
      const AliasedBit aliased = ram_bit(address);
      std::uint8_t& byte = *engine_.ram(aliased.address, 1);
      const unsigned bit = 1U << aliased.bit;
      byte = static_cast<std::uint8_t>((value & 1U) != 0 ? byte | bit : byte & ~bit);
    } else {
      surroundings_->store(address, size, value);
    }
  }

  [[nodiscard]] bool store_to_flash(std::uint32_t address, unsigned size, std::uint32_t value) override {
    return surroundings_->store_to_flash(address, size, value);
  }

  [[nodiscard]] bool stops() override {
    if (stop_requested_ || wants_halt_ || !writes_.empty() || engine_.instructions() >= limit_) {
      return true;
    }
    if (exceptions_.takes_next()) {
      return true;
    }
    engine_.set_limit(limit_);
    return false;
  }

  [[nodiscard]] bool coprocessor_allowed() const override {
    constexpr std::uint32_t unprivileged = 1;
    return system_control_.fpu_enabled(exceptions_.current() != 0 ||
                                       (engine_.read(CoreRegister::control) & unprivileged) == 0);
  }

  [[nodiscard]] bool is_forbidden(std::uint32_t address) const override {
    return system_control_.protection().forbids(address);
  }

  void send_event() override { exceptions_.send_event(); }

  // SystemControlOwner
  [[nodiscard]] LocalTime now() const override { return surroundings_->now(); }
  [[nodiscard]] LocalTime core_period() const override { return surroundings_->core_period(); }
  [[nodiscard]] std::uint64_t instructions() const override { return engine_.instructions(); }
  [[nodiscard]] unsigned active_exception() const override { return exceptions_.current(); }
  void attend() override { engine_.set_limit(0); }
  void reschedule() override { limit(engine_.instructions()); }
  void request_reset() override {
    stop_requested_ = true;
    surroundings_->reset_requested();
  }
  void halt(std::string reason) override {
    if (halt_reason_.empty()) {
      halt_reason_ = std::move(reason);
      if (engine_.is_running()) {
        halt_reason_ += ", by the code at " + hexadecimal(engine_.pc());
      }
    }
    wants_halt_ = true;
    attend();
    if (!engine_.is_running()) {
      state_ = State::halted;
    }
  }

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const std::string& halt_reason() const { return halt_reason_; }
  Engine& engine() { return engine_; }
  Nvic& nvic() { return nvic_; }
  SystemControl& system_control() { return system_control_; }
  Exceptions& exceptions() { return exceptions_; }

 private:
  /// Halts a program that only takes exceptions: a fault whose handler returns to the instruction that failed, or an
  /// interrupt whose handler is no code. Exceptions take no time in this model, so such a program would never end.
  void require_progress(std::uint64_t executed) {
    constexpr std::uint32_t max_faults = 100;
    constexpr std::uint32_t max_idle_turns = 1000;
    idle_turns_ = executed == 0 ? idle_turns_ + 1 : 0;
    if (exceptions_.fault_count() > max_faults) {
      halt("more than " + std::to_string(max_faults) + " faults since the reset, the last at " +
           hexadecimal(engine_.pc()));
    } else if (idle_turns_ > max_idle_turns) {
      halt("exceptions without an instruction between them, at " + hexadecimal(engine_.pc()));
    }
  }

  /// A write to flash or system memory by an instruction, which waits for the end of the instruction.
  struct Write {
    std::uint32_t address;
    std::vector<std::uint8_t> bytes;
  };

  static std::out_of_range no_memory(std::uint32_t address, std::size_t size) {
    return std::out_of_range("no memory at " + hexadecimal(address) + ", " + std::to_string(size) + " bytes");
  }

  static CoreRegister named(unsigned number) {
    if (number > 16) {
      throw std::out_of_range("no core register " + std::to_string(number));
    }
    return static_cast<CoreRegister>(number);
  }

  [[nodiscard]] int priority_without_primask() const {
    ExceptionMasks masks = exceptions_.masks();
    masks.primask = 0;
    return nvic_.execution_priority(masks);
  }

  /// False: the CPU does not run.
  bool begin() {
    if (state_ == State::locked_up || state_ == State::halted || (state_ == State::sleeping && !wakes())) {
      return false;
    }
    // A breakpoint that has stopped the run does not stop it again.
    engine_.pass_breakpoint(state_ == State::at_breakpoint);
    state_ = State::running;
    stop_requested_ = false;
    return true;
  }

  bool prepare_to_stop() {
    if (!writes_.empty()) {
      for (const Write& write : std::exchange(writes_, {})) {
        static_cast<void>(engine_.write_memory(write.address, write.bytes));
      }
      exceptions_.discard_vectors();
    }
    if (exceptions_.is_locked_up()) {
      state_ = State::locked_up;
    } else if (wants_halt_) {
      state_ = State::halted;
    } else if (stop_requested_ && state_ == State::running) {
      state_ = State::paused;
    }
    return state_ != State::running;
  }

  void apply_traps() { engine_.set_traps(system_control_.traps_unaligned(), system_control_.traps_division_by_zero()); }

  /// The work between two runs of the engine. False: the run ends.
  bool prepare() {
    if (prepare_to_stop()) {
      return false;
    }
    if (exceptions_.takes_next()) {
      exceptions_.take_next();
      return !prepare_to_stop();
    }
    return true;
  }

  void sleep() {
    sleep_priority_ = priority_without_primask();
    if (nvic_.next_priority() >= sleep_priority_) {
      state_ = State::sleeping;
    }
  }

  void handle(End end) {
    switch (end) {
      case End::none:
      case End::stopped:
      case End::stepped:
        break;
      case End::breakpoint:
        state_ = State::at_breakpoint;
        break;
      case End::wait_for_interrupt:
        sleep();
        break;
      case End::wait_for_event:
        if (!exceptions_.take_event()) {
          sleep();
        }
        break;
      case End::supervisor_call:
        exceptions_.call_supervisor();
        break;
      case End::exception_return:
        exceptions_.return_from_handler(engine_.exception_return_value());
        if (exceptions_.current() == 0 && system_control_.sleeps_on_exit()) {
          sleep();
        }
        break;
      case End::breakpoint_instruction:
        exceptions_.raise_breakpoint();
        break;
      case End::no_coprocessor:
        exceptions_.raise_no_coprocessor();
        break;
      case End::undefined_instruction:
        exceptions_.raise_undefined_instruction();
        break;
      case End::invalid_state:
        exceptions_.raise_invalid_state();
        break;
      case End::unaligned_access:
        exceptions_.raise_unaligned_access(engine_.fault());
        break;
      case End::divide_by_zero:
        exceptions_.raise_divide_by_zero();
        break;
      case End::memory_fault:
        exceptions_.raise_memory_fault(engine_.fault());
        break;
      case End::floating_point:
        halt("an instruction of the FPU, which is not modelled, at " + hexadecimal(engine_.pc()));
        break;
    }
  }

  CpuSurroundings* surroundings_;
  Engine engine_;
  Nvic nvic_;
  SystemControl system_control_;
  Exceptions exceptions_;
  State state_ = State::halted;
  std::uint64_t limit_ = 0;
  std::uint32_t idle_turns_ = 0;  ///< turns of run() in a row that executed no instruction
  int sleep_priority_ = Nvic::no_priority;
  bool stop_requested_ = false;
  bool wants_halt_ = false;
  std::string halt_reason_;
  std::vector<Write> writes_;
};

Cpu::Cpu(CpuSurroundings& surroundings) : implementation_(std::make_unique<Implementation>(surroundings)) {}

Cpu::~Cpu() = default;

void Cpu::lose_memory(std::uint64_t seed) { implementation_->lose_memory(seed); }

void Cpu::reset() { implementation_->restart(); }

Cpu::State Cpu::run(std::uint64_t instructions) { return implementation_->run(instructions); }

Cpu::State Cpu::state() const { return implementation_->state(); }

std::uint64_t Cpu::instructions() const { return implementation_->engine().instructions(); }

void Cpu::limit(std::uint64_t instructions) { implementation_->limit(instructions); }

void Cpu::pause() { implementation_->pause(); }

void Cpu::halt(std::string reason) { implementation_->halt(std::move(reason)); }

const std::string& Cpu::halt_reason() const { return implementation_->halt_reason(); }

void Cpu::set_interrupt(unsigned position, bool high) {
  if (position >= Nvic::interrupt_count) {
    throw std::out_of_range("no interrupt " + std::to_string(position));
  }
  implementation_->nvic().set_line(position, high);
  implementation_->attend();
}

void Cpu::set_non_maskable(bool high) {
  implementation_->nvic().set_non_maskable_line(high);
  implementation_->attend();
}

bool Cpu::wakes() const { return implementation_->wakes(); }

LocalTime Cpu::next_system_tick() const { return implementation_->system_control().system_tick().next_exception(); }

void Cpu::advance_system_tick() { implementation_->advance_system_tick(); }

void Cpu::change_core_period() {
  implementation_->system_control().system_tick().set_core_period(implementation_->now(),
                                                                  implementation_->core_period());
}

void Cpu::read(std::uint32_t address, std::span<std::uint8_t> bytes) const { implementation_->read(address, bytes); }

void Cpu::write(std::uint32_t address, std::span<const std::uint8_t> bytes) { implementation_->write(address, bytes); }

std::uint32_t Cpu::core_register(unsigned number) const { return implementation_->core_register(number); }

void Cpu::set_core_register(unsigned number, std::uint32_t value) { implementation_->set_core_register(number, value); }

unsigned Cpu::active_exception() const { return implementation_->exceptions().current(); }

void Cpu::set_breakpoints(std::span<const std::uint32_t> addresses) {
  implementation_->engine().set_breakpoints(addresses);
}

void Cpu::step() { implementation_->step(); }

std::vector<CpuFault> Cpu::take_faults() { return implementation_->exceptions().take_faults(); }

}  // namespace proleg::sim
