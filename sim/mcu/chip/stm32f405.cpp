#include "sim/mcu/chip/stm32f405.hpp"

#include <algorithm>
#include <initializer_list>
#include <utility>
#include <vector>

#include "sim/mcu/chip/falling_lines.hpp"
#include "sim/mcu/chip/oscillator.hpp"
#include "sim/mcu/chip/peripheral_map.hpp"
#include "sim/mcu/chip/pins.hpp"
#include "sim/mcu/chip/timed_peripherals.hpp"
#include "sim/mcu/peripherals/adc.hpp"
#include "sim/mcu/peripherals/bxcan.hpp"
#include "sim/mcu/peripherals/chip_identity.hpp"
#include "sim/mcu/peripherals/dma.hpp"
#include "sim/mcu/peripherals/exti.hpp"
#include "sim/mcu/peripherals/flash_interface.hpp"
#include "sim/mcu/peripherals/iwdg.hpp"
#include "sim/mcu/peripherals/pwr.hpp"
#include "sim/mcu/peripherals/rcc.hpp"
#include "sim/mcu/peripherals/syscfg.hpp"
#include "sim/mcu/peripherals/timer.hpp"
#include "sim/mcu/peripherals/usart.hpp"

namespace proleg::sim {
namespace {

/// Typical thresholds (DS8626, embedded reset and power control block): VBOR by BOR_LEV, then VPOR/PDR.
struct ResetThreshold {
  std::uint32_t falling_mv;
  std::uint32_t rising_mv;
};
constexpr std::array<ResetThreshold, 4> reset_thresholds{
    {{2'830, 2'920}, {2'500, 2'590}, {2'190, 2'290}, {1'680, 1'720}}};
constexpr unsigned power_down = 3;

}  // namespace

class Stm32f405::Implementation final : public CpuSurroundings, public ChipServices, public FlashMemory {
 public:
  Implementation(Bus& bus, BoardSignals& board, const ChipSettings& settings)
      : settings_(settings),
        oscillator_(settings.crystal_parts_per_billion),
        cpu_(*this),
        iwdg_(*this),
        exti_(*this),
        pwr_(*this, &exti_),
        flash_(*this, *this),
        rcc_(*this, flash_, pwr_, iwdg_, settings.crystal),
        syscfg_(*this),
        timer_2_(*this, 2),
        timer_3_(*this, 3),
        timer_5_(*this, 5),
        dma_1_(*this, 1, memory()),
        dma_2_(*this, 2, memory()),
        usart_(*this, board, &dma_1_),
        adc_(*this, board, &dma_2_),
        can_(*this, bus, [this](LocalTime time) { return oscillator_.when(time); }),
        pins_(*this, board, timer_2_) {
    flash_.set_brown_out_level(settings.brown_out_level);
    peripherals_ = {&iwdg_,    &exti_,    &pwr_,   &flash_, &rcc_,   &syscfg_, &timer_2_,
                    &timer_3_, &timer_5_, &dma_1_, &dma_2_, &usart_, &adc_,    &can_};
    timer_3_.connect_trigger_output(adc_);
    for (const auto& port : pins_.ports()) {
      peripherals_.push_back(port.get());
    }
    for (Peripheral* peripheral : peripherals_) {
      rcc_.attach(*peripheral);
      map_.add(*peripheral);
    }
    for (Peripheral* const peripheral : std::initializer_list<Peripheral*>{&rcc_, &flash_, &iwdg_, &timer_2_, &timer_3_,
                                                                           &timer_5_, &usart_, &adc_, &can_}) {
      timed_.add(*peripheral);
    }
    cpu_.write(system_memory_address, system_memory(settings.unique_id));
  }

  void power_on(BusTime now) {
    if (on_) {
      cut_flash();
    }
    on_ = true;
    stands_still_ = false;
    is_held_ = false;
    release_cause_ = ResetCause::brown_out;
    cpu_.lose_memory(settings_.seed + ++memory_losses_);
    oscillator_.start(now);
    anchor_time_ = 0;
    anchor_instructions_ = cpu_.instructions();
    reset_cause_.reset();
    start(ResetCause::power_on);
    set_supply(supply_mv_);
  }

  void set_supply(std::uint32_t mv) {
    supply_mv_ = mv;
    change_outside([&] {
      pwr_.set_supply(mv);
      flash_.set_supply(mv);
    });
    if (!on_) {
      return;
    }
    const ResetThreshold& threshold = reset_thresholds.at(flash_.brown_out_level());
    if (mv < reset_thresholds[power_down].falling_mv) {
      release_cause_ = ResetCause::power_on;
    }
    if (mv < threshold.falling_mv && !is_held_) {
      hold();
    } else if (mv >= threshold.rising_mv && is_held_) {
      release();
    }
    require_flash_speed();
  }

  void pull_reset_pin() {
    if (on_ && !is_held_) {
      hold();
      release_cause_ = ResetCause::pin;
      release();
    }
  }

  [[nodiscard]] BusTime next_event() const {
    if (!next_event_) {
      next_event_ = never_on_bus;
      if (on_ && !stands_still_ && !is_held_) {
        const LocalTime next = is_awake() ? now() : next_visible_event();
        next_event_ = std::min(can_.next_request(), oscillator_.when(next));
      }
    }
    return *next_event_;
  }

  void submit(BusTime now_on_bus) {
    if (on_ && !stands_still_ && !is_held_) {
      invalidate_next_events();
      can_.submit(now_on_bus);
    }
  }

  bool run(BusTime now_on_bus, BusTime quiet_until, bool ends_before_restart) {
    if (!on_ || stands_still_) {
      return true;
    }
    if (is_held_) {
      pass_to(std::max(now(), oscillator_.at(now_on_bus)));
      return true;
    }
    invalidate_next_events();
    const LocalTime due = oscillator_.at(now_on_bus);
    const LocalTime horizon = std::max(due, oscillator_.at(quiet_until));
    if (cpu_.state() == Cpu::State::sleeping) {
      // An event of the bus may have woken the CPU at `due`.
      pass_to(std::max(now(), std::min(due, next_visible_event())));
    }
    while (!stands_still_) {
      while (!stands_still_ && (is_awake() ? next_internal_event() : next_visible_event()) <= now()) {
        take_events();
      }
      if (stands_still_) {
        return true;
      }
      if (reset_cause_) {
        if (ends_before_restart) {
          return false;
        }
        restart();
      } else if (!is_awake()) {
        const LocalTime next = next_visible_event();
        if (next > horizon) {
          pass_to(std::max(now(), due));
          return true;
        }
        pass_to(next);
      } else if (now() >= horizon) {
        return true;
      } else if (stalls()) {
        pass_to(std::min({flash_.busy_until(), next_internal_event(), horizon}));
      } else {
        execute(std::min(horizon, next_internal_event()));
      }
    }
    return true;
  }

  void catch_up_before(BusTime time) {
    const bool executes = cpu_.state() != Cpu::State::sleeping && is_awake();
    if (!on_ || stands_still_ || is_held_ || time == 0 || executes) {
      return;  // a CPU that executes takes each event at its time
    }
    const LocalTime until = std::min(oscillator_.at(time - 1), next_visible_event());
    if (until > now()) {
      pass_to(until);
      catch_up();
    }
  }

  /// Does the events that are due and not visible.
  void catch_up() {
    guard([this] {
      timer_3_.advance();
      adc_.advance();
    });
    timed_.forget();
  }

  /// Applies a change outside of the chip at the present time.
  template <typename Action>
  void change_outside(const Action& action) {
    const LocalTime time = now();
    pass_to(time);
    catch_up();
    pins_.look();
    guard(action);
    pins_.look();
    invalidate_next_events();
    static_cast<void>(follow_core_clock(time));
  }

  [[nodiscard]] std::uint64_t starts() const { return starts_; }

  [[nodiscard]] std::optional<ChipEvent> take_event() {
    if (events_.empty()) {
      return std::nullopt;
    }
    ChipEvent event = std::move(events_.front());
    events_.pop_front();
    return event;
  }

  ChipSettings settings_;
  Oscillator oscillator_;
  Cpu cpu_;
  Iwdg iwdg_;
  Exti exti_;
  Pwr pwr_;
  FlashInterface flash_;
  Rcc rcc_;
  Syscfg syscfg_;
  Timer timer_2_;
  Timer timer_3_;
  Timer timer_5_;
  Dma dma_1_;
  Dma dma_2_;
  Usart usart_;
  Adc adc_;
  BxCan can_;
  Pins pins_;
  TransmitWatch transmit_watch_;
  CompareWatch compare_watch_;
  DebugHook debug_hook_;

 private:
  // Time.

  [[nodiscard]] LocalTime now() const override {
    return anchor_time_ + (cpu_.instructions() - anchor_instructions_) * rcc_.clocks().core;
  }
  [[nodiscard]] LocalTime core_period() const override { return rcc_.clocks().core; }
  [[nodiscard]] const Clocks& clocks() const override { return rcc_.clocks(); }

  /// Time passes without instructions.
  void pass_to(LocalTime time) {
    anchor_time_ = time;
    anchor_instructions_ = cpu_.instructions();
  }

  [[nodiscard]] LocalTime next_internal_event() const { return std::min(timed_.next_event(), next_other_event()); }
  /// Time of the next event, without events that only a CPU that executes can see.
  [[nodiscard]] LocalTime next_visible_event() const {
    return std::min(timed_.next_visible_event(), next_other_event());
  }
  [[nodiscard]] LocalTime next_other_event() const {
    return std::min({pins_.next_edge(), falling_lines_.next(), cpu_.next_system_tick()});
  }
  /// To be called when the time of the next event may have changed.
  void invalidate_next_events() {
    timed_.forget();
    next_event_.reset();
  }

  void take_events() {
    const LocalTime time = now();
    pass_to(time);
    invalidate_next_events();
    if (cpu_.next_system_tick() <= time) {
      cpu_.advance_system_tick();
    }
    if (falling_lines_.next() <= time) {
      falling_lines_.finish([this](unsigned position) { cpu_.set_interrupt(position, false); });
    }
    timed_.for_due(time, [this](Peripheral& peripheral) { guard([&] { peripheral.advance(); }); });
    pins_.look();
    invalidate_next_events();
    static_cast<void>(follow_core_clock(time));
  }

  /// To be called when the core may have a new clock, with the time before. True if the clock is new.
  bool follow_core_clock(LocalTime time) {
    if (core_period() == known_core_period_) {
      return false;
    }
    known_core_period_ = core_period();
    pass_to(time);
    cpu_.change_core_period();
    require_flash_speed();
    return true;
  }

  /// Stops a chip whose flash does not follow its clock: what it would execute is not defined.
  void require_flash_speed() {
    if (!on_ || is_held_ || stands_still_) {
      return;
    }
    guard([this] {
      if (const std::optional<std::string> fault = flash_.speed_fault(core_period())) {
        throw UnmodelledAccess(*fault);
      }
    });
  }

  /// Whether the CPU executes; a CPU that has locked up waits for the watchdog.
  [[nodiscard]] bool is_awake() const {
    const Cpu::State state = cpu_.state();
    return state != Cpu::State::locked_up && (state != Cpu::State::sleeping || cpu_.wakes()) &&
           !rcc_.core_stands_still();
  }

  /// Whether a flash operation is under way and the program runs from flash.
  [[nodiscard]] bool stalls() const {
    if (flash_.busy_until() <= now()) {
      return false;
    }
    const std::uint32_t address = cpu_.core_register(program_counter);
    return address >= ChipMemory::flash_start && address - ChipMemory::flash_start < ChipMemory::flash_size;
  }

  void execute(LocalTime until) {
    if (debug_hook_ && step_for_debugger()) {
      return;
    }
    const LocalTime period = core_period();
    run_end_ = until;
    const Cpu::State state = cpu_.run((until - now() + period - 1) / period);
    run_end_ = 0;
    note_faults();
    if (state == Cpu::State::halted) {
      stand_still();
    }
    if (debug_hook_ && state == Cpu::State::at_breakpoint) {
      take_debugger(DebugEvent::breakpoint);
    }
  }

  // The debugger.

  bool step_for_debugger() {
    if (!steps_) {
      take_debugger(DebugEvent::about_to_run);
    }
    if (!steps_) {
      return false;
    }
    cpu_.step();
    note_faults();
    take_debugger(DebugEvent::step);
    return true;
  }
  void take_debugger(DebugEvent event) { steps_ = debug_hook_(event); }

  // Resets.

  void reset_peripherals() {
    map_.forget_answers();
    for (Peripheral* peripheral : peripherals_) {
      peripheral->reset();
    }
    pins_.reset();
    falling_lines_ = {};
    invalidate_next_events();
  }

  /// Time that a write needs to reach a peripheral behind a slow bus, until which an interrupt that it ends is still
  /// requested: three clocks of the bus. ST gives no figure. A read from such a peripheral comes after the writes.
  [[nodiscard]] LocalTime bus_latency(const Peripheral& peripheral) const {
    constexpr std::uint32_t apb2_start = 0x4001'0000;
    constexpr std::uint32_t ahb_start = 0x4002'0000;
    constexpr LocalTime bus_clocks = 3;
    if (peripheral.base() >= ahb_start) {
      return 0;
    }
    return bus_clocks * (peripheral.base() < apb2_start ? clocks().apb1 : clocks().apb2);
  }

  void start(ResetCause cause) {
    ++starts_;
    reset_peripherals();
    rcc_.note_start(cause);
    cpu_.reset();
    known_core_period_ = core_period();
    faults_since_reset_ = 0;
  }

  /// Holds the chip in reset, because of the supply voltage.
  void hold() {
    pass_to(now());
    cut_flash();
    is_held_ = true;
    reset_cause_.reset();
    reset_peripherals();
  }

  void release() {
    is_held_ = false;
    const ResetCause cause = std::exchange(release_cause_, ResetCause::brown_out);
    if (cause == ResetCause::power_on) {
      cpu_.lose_memory(settings_.seed + ++memory_losses_);
    }
    start(cause);
    new_event(ChipEvent::Kind::reset).cause = cause;
  }

  void restart() {
    const ResetCause cause = *std::exchange(reset_cause_, std::nullopt);
    pass_to(now());
    cut_flash();
    start(cause);
    new_event(ChipEvent::Kind::reset).cause = cause;
  }

  void cut_flash() {
    if (flash_.busy_until() > now()) {
      flash_.cut(settings_.seed + ++cuts_);
    }
  }

  // Memory and registers of the CPU.

  /// The peripheral at an address, and the offset of its register. Throws UnmodelledAccess if it has no clock.
  std::pair<Peripheral*, std::uint32_t> find(std::uint32_t address, unsigned size) {
    const PeripheralMap::Place place = map_.find(address, size);
    if (!place.answers) {
      rcc_.require_clock(*place.peripheral, place.offset);
      map_.note_answer(address);
    }
    return {place.peripheral, place.offset};
  }

  std::uint32_t load(std::uint32_t address, unsigned size) override {
    std::uint32_t value = 0;
    guard([&] {
      const auto [peripheral, offset] = find(address, size);
      if (bus_latency(*peripheral) != 0) {
        falling_lines_.finish([this](unsigned position) { cpu_.set_interrupt(position, false); });
      }
      value = peripheral->read(offset);
      if (peripheral == &flash_ && flash_.busy_until() > now()) {
        // A program in RAM polls for the end of the operation: skips to it.
        pass_to(std::max(now(), std::min({flash_.busy_until(), next_internal_event(), run_end_})));
        shorten_run(run_end_);
      }
    });
    return value;
  }

  void store(std::uint32_t address, unsigned size, std::uint32_t value) override {
    guard([&] {
      const auto [peripheral, offset] = find(address, size);
      const LocalTime time = now();
      if (peripheral == &can_) {
        watch_can(offset, value);
      }
      if (peripheral == &timer_2_ && offset == Timer::ccr1 && compare_watch_) {
        compare_watch_(oscillator_.when(time), value);
      }
      pins_.look();
      if (peripheral == &rcc_) {
        map_.forget_answers();
      }
      store_latency_ = bus_latency(*peripheral);
      peripheral->write(offset, value);
      store_latency_ = 0;
      pins_.look();
      invalidate_next_events();
      if (follow_core_clock(time)) {
        cpu_.pause();
      }
      if (peripheral == &flash_) {
        require_flash_speed();
      }
      shorten_run(peripheral->next_event());
      shorten_run(pins_.next_edge());
    });
    if (flash_.busy_until() > now()) {
      cpu_.pause();
    }
  }

  bool store_to_flash(std::uint32_t address, unsigned size, std::uint32_t value) override {
    const bool taken = flash_.program(address, size, value);
    invalidate_next_events();
    shorten_run(flash_.next_event());
    if (flash_.busy_until() > now()) {
      cpu_.pause();
    }
    return taken;
  }

  /// Ends the run at the time of an event if this is earlier.
  void shorten_run(LocalTime next) {
    if (run_end_ == 0 || next > run_end_) {
      return;
    }
    run_end_ = next;
    const LocalTime period = core_period();
    const LocalTime time = now();
    cpu_.limit(cpu_.instructions() + (next <= time ? 0 : (next - time + period - 1) / period));
  }

  void watch_can(std::uint32_t offset, std::uint32_t value) {
    constexpr std::uint32_t mcr = 0x000;
    constexpr std::uint32_t inrq = 1;
    constexpr std::uint32_t first_mailbox = 0x180;
    constexpr std::uint32_t mailbox_bytes = 0x10;
    constexpr std::uint32_t mailboxes = 3;
    constexpr std::uint32_t txrq = 1;
    if (offset == mcr && (value & inrq) == 0 && !pins_.connect_can()) {
      throw UnmodelledAccess("CAN1_MCR: the controller is to join the bus, but no pins are connected to it (AF9)");
    }
    if (offset == mcr && (value & inrq) == 0 && pins_.has_slow_can_edges()) {
      throw UnmodelledAccess(
          "CAN1_MCR: the controller is to join the bus, but the edges of its pin take up to 100 ns (GPIO OSPEEDR = 0)");
    }
    const std::uint32_t place = offset - first_mailbox;
    if (transmit_watch_ && offset >= first_mailbox && place < mailboxes * mailbox_bytes && place % mailbox_bytes == 0 &&
        (value & txrq) != 0) {
      transmit_watch_(static_cast<std::uint16_t>(value >> 21U), cpu_.instructions());
    }
  }

  /// The memory that DMA accesses.
  [[nodiscard]] Dma::Memory memory() {
    return {[this](std::uint32_t address, std::span<std::uint8_t> bytes) { cpu_.read(address, bytes); },
            [this](std::uint32_t address, std::span<const std::uint8_t> bytes) { cpu_.write(address, bytes); }};
  }

  // FlashMemory.
  void read(std::uint32_t address, std::span<std::uint8_t> bytes) override { cpu_.read(address, bytes); }
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes) override { cpu_.write(address, bytes); }

  // Services for peripherals and CPU.
  void set_interrupt(unsigned position, bool high) override {
    if (!high && store_latency_ != 0) {
      falling_lines_.add(position, now() + store_latency_);
      reschedule();
      return;
    }
    falling_lines_.remove(position);
    cpu_.set_interrupt(position, high);
    next_event_.reset();
  }
  void set_non_maskable(bool high) override {
    cpu_.set_non_maskable(high);
    next_event_.reset();
  }
  void request_reset(ResetCause cause) override {
    if (!reset_cause_) {
      reset_cause_ = cause;
      cpu_.pause();
    }
  }
  void reset_requested() override { request_reset(ResetCause::software); }
  void reschedule() override {
    invalidate_next_events();
    if (run_end_ != 0) {
      shorten_run(next_internal_event());
    }
  }

  // Reports.

  template <typename Action>
  void guard(const Action& action) {
    try {
      action();
    } catch (const UnmodelledAccess& error) {
      cpu_.halt(error.what());
      stand_still();
      next_event_.reset();
    }
  }

  /// Stops the chip because the program has used what the model does not have.
  void stand_still() {
    if (stands_still_) {
      return;
    }
    stands_still_ = true;
    ChipEvent& event = new_event(ChipEvent::Kind::unmodelled);
    event.text = cpu_.halt_reason();
    for (unsigned number = 0; number < event.registers.size(); ++number) {
      event.registers[number] = cpu_.core_register(number);
    }
  }

  ChipEvent& new_event(ChipEvent::Kind kind) {
    ChipEvent event;
    event.kind = kind;
    event.time = oscillator_.when(now());
    return events_.emplace_back(std::move(event));
  }

  void note_faults() {
    constexpr std::uint32_t max_reported = 5;
    for (CpuFault& fault : cpu_.take_faults()) {
      if (++faults_since_reset_ > max_reported && !fault.locked_up) {
        continue;
      }
      ChipEvent& event = new_event(fault.locked_up ? ChipEvent::Kind::locked_up : ChipEvent::Kind::fault);
      event.text = std::move(fault.cause);
      std::ranges::copy(fault.registers, event.registers.begin());
      if (debug_hook_) {
        take_debugger(DebugEvent::fault);
      }
    }
  }

  static constexpr unsigned program_counter = 15;

  std::vector<Peripheral*> peripherals_;
  TimedPeripherals timed_;
  PeripheralMap map_;
  mutable std::optional<BusTime> next_event_;  ///< nothing: not computed
  FallingLines falling_lines_;
  LocalTime store_latency_ = 0;  ///< while a store is done: bus_latency()
  LocalTime anchor_time_ = 0;    ///< local time when the CPU had executed anchor_instructions_
  std::uint64_t anchor_instructions_ = 0;
  LocalTime known_core_period_ = Clocks::hsi;
  LocalTime run_end_ = 0;  ///< end of the run, while instructions are executed
  std::optional<ResetCause> reset_cause_;
  std::uint64_t cuts_ = 0;
  std::uint64_t memory_losses_ = 0;
  std::uint64_t starts_ = 0;
  std::uint32_t faults_since_reset_ = 0;
  bool on_ = false;
  bool stands_still_ = false;  ///< the model has ended
  bool is_held_ = false;       ///< the supply voltage holds it in reset
  ResetCause release_cause_ = ResetCause::brown_out;
  std::uint32_t supply_mv_ = Pwr::nominal_supply_mv;
  bool steps_ = false;
  std::deque<ChipEvent> events_;
};

Stm32f405::Stm32f405(Bus& bus, BoardSignals& board, const ChipSettings& settings)
    : implementation_(std::make_unique<Implementation>(bus, board, settings)) {}
Stm32f405::~Stm32f405() = default;

void Stm32f405::write(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  implementation_->cpu_.write(address, bytes);
}
void Stm32f405::read(std::uint32_t address, std::span<std::uint8_t> bytes) const {
  implementation_->catch_up();
  implementation_->cpu_.read(address, bytes);
}
void Stm32f405::power_on(BusTime now) { implementation_->power_on(now); }
BusTime Stm32f405::next_event() const { return implementation_->next_event(); }
void Stm32f405::advance_to(BusTime now, BusTime quiet_until) {
  submit(now);
  static_cast<void>(run(now, quiet_until));
}
BusTime Stm32f405::next_request() const { return implementation_->can_.next_request(); }
void Stm32f405::submit(BusTime now) { implementation_->submit(now); }
bool Stm32f405::run(BusTime from, BusTime quiet_until, bool ends_before_restart) {
  return implementation_->run(from, quiet_until, ends_before_restart);
}
void Stm32f405::catch_up_before(BusTime time) { implementation_->catch_up_before(time); }
void Stm32f405::set_crystal(bool runs) {
  implementation_->change_outside([this, runs] { implementation_->rcc_.set_crystal(runs); });
}
void Stm32f405::set_pll(bool locks) {
  implementation_->change_outside([this, locks] { implementation_->rcc_.set_pll(locks); });
}
void Stm32f405::set_adc(bool is_read) {
  implementation_->change_outside([this, is_read] { implementation_->adc_.set_dma_reach(is_read); });
}
void Stm32f405::fail_dma_of_adc() {
  implementation_->change_outside([this] { implementation_->dma_2_.fail(Adc::dma_stream); });
}
void Stm32f405::set_weak_word(std::uint32_t address, std::uint32_t bits) {
  implementation_->change_outside([=, this] { implementation_->flash_.set_weak_word(address, bits); });
}
void Stm32f405::begin_serial_input(BusTime start, const SerialCharacter& character, BusTime bit) {
  constexpr BusTime ns_per_us = 1'000;
  const LocalTime local_bit = (bit * local_time_per_us + ns_per_us / 2) / ns_per_us;
  implementation_->change_outside(
      [&] { implementation_->usart_.begin_receive(implementation_->oscillator_.at(start), character, local_bit); });
}
void Stm32f405::set_serial_watch(SerialWatch watch) {
  implementation_->usart_.watch_output([this, watch = std::move(watch)](LocalTime end, std::uint8_t byte) {
    watch(implementation_->oscillator_.when(end), byte);
  });
}
void Stm32f405::set_supply(std::uint32_t mv) { implementation_->set_supply(mv); }
void Stm32f405::pull_reset_pin() { implementation_->pull_reset_pin(); }
std::optional<LocalTime> Stm32f405::pulse_time(unsigned channel) const {
  return implementation_->pins_.pulse_time(channel);
}
void Stm32f405::set_pin_watch(char port, unsigned number, PinWatch watch) {
  implementation_->pins_.watch(port, number, [this, watch = std::move(watch)](LocalTime edge, bool high) {
    watch(implementation_->oscillator_.when(edge), high);
  });
}
void Stm32f405::set_compare_watch(CompareWatch watch) { implementation_->compare_watch_ = std::move(watch); }
std::size_t Stm32f405::controller() const { return implementation_->can_.controller(); }
std::uint64_t Stm32f405::instructions() const { return implementation_->cpu_.instructions(); }
void Stm32f405::set_flash_watch(FlashWatch watch) { implementation_->flash_.set_watch(std::move(watch)); }
std::uint64_t Stm32f405::starts() const { return implementation_->starts(); }
void Stm32f405::set_transmit_watch(TransmitWatch watch) { implementation_->transmit_watch_ = std::move(watch); }
void Stm32f405::set_debug_hook(DebugHook hook) { implementation_->debug_hook_ = std::move(hook); }
bool Stm32f405::has_debug_hook() const { return static_cast<bool>(implementation_->debug_hook_); }
Cpu& Stm32f405::cpu() { return implementation_->cpu_; }
std::optional<ChipEvent> Stm32f405::take_event() { return implementation_->take_event(); }

}  // namespace proleg::sim
