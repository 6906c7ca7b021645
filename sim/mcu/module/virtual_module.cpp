#include "sim/mcu/module/virtual_module.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <sstream>
#include <utility>

#include "firmware/module/board_record.hpp"
#include "firmware/stm32f405/boards/boards.hpp"
#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/image/image_header.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::sim {
namespace {

namespace board = stm32f405::board;
namespace flash_layout = stm32f405::flash_layout;

constexpr const char* record_symbol = "proleg_tick_record";
constexpr unsigned program_counter = 15;
constexpr unsigned servo_channel = 1;  ///< channel of TIM2
constexpr std::uint32_t microvolts_per_ma = 1'000;
constexpr std::uint32_t max_uv = board::vdda_millivolt * 1'000;

ChipSettings chip_settings(const ModuleParts& parts, const stm32f405::BoardProfile& board) {
  ChipSettings settings{parts.identity.unique_id, parts.crystal.parts_per_billion(), parts.identity.node};
  settings.crystal = board.crystal;
  return settings;
}

firmware::BoardRecord board_record(const ModuleParts& parts) {
  firmware::BoardRecord record;
  record.node = parts.identity.node;
  record.has_feedback = parts.readings().angle.has_value();
  record.feedback_at_minus_90 = Potentiometer::at_minus_90;
  record.feedback_at_plus_90 = Potentiometer::at_plus_90;
  record.is_gateway = parts.is_gateway;
  return record;
}

/// A time of the bus as text: "1.234567 s".
std::string at_time(BusTime time) {
  std::ostringstream text;
  text.precision(6);
  text << std::fixed << static_cast<double>(time) * 1e-9 << " s";
  return text.str();
}

std::string registers_in_words(const std::array<std::uint32_t, 17>& registers) {
  constexpr std::array<const char*, 17> names{"r0", "r1",  "r2",  "r3",  "r4", "r5", "r6", "r7",  "r8",
                                              "r9", "r10", "r11", "r12", "sp", "lr", "pc", "xpsr"};
  constexpr std::size_t in_a_line = 6;
  std::ostringstream text;
  text << std::hex;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text << (i % in_a_line == 0 ? "\n    " : "  ") << names[i] << " 0x" << registers[i];
  }
  return text.str();
}

const char* in_words(ResetCause cause) {
  switch (cause) {
    case ResetCause::power_on:
      return "power";
    case ResetCause::brown_out:
      return "a supply voltage that was too low";
    case ResetCause::pin:
      return "its reset pin";
    case ResetCause::software:
      return "its own program";
    case ResetCause::independent_watchdog:
      break;
  }
  return "its watchdog: the program had hung";
}

}  // namespace

FirmwareImage::FirmwareImage(const std::filesystem::path& file)
    : file_(file), flash_(file), board_(&stm32f405::boards::reference) {
  const auto& symbols = flash_.elf().symbols();
  const auto symbol = std::ranges::find(symbols, record_symbol, &ElfImage::Symbol::name);
  if (symbol == symbols.end()) {
    throw ElfError(file.string() + ": found no symbol " + record_symbol +
                   ", expected the firmware of a joint module for this chip (firmware/stm32f405)");
  }
  flash_.require_vector_table(flash_layout::image_body);  // behind the start stub
  tick_record_ = flash_.require_word(symbol->address);
  if (const auto* const board = stm32f405::boards::find(image::decode(image()).header.board_id); board != nullptr) {
    board_ = board;
  }
}

std::vector<std::uint8_t> FirmwareImage::image() const {
  constexpr std::uint8_t erased = 0xFF;
  std::vector<std::uint8_t> image;
  for (const ElfImage::Segment& segment : flash_.elf().segments()) {
    if (segment.load_address < flash_layout::slot_a) {
      continue;  // this is the start stub
    }
    const std::size_t offset = segment.load_address - flash_layout::slot_a;
    image.resize(std::max(image.size(), offset + segment.bytes.size()), erased);
    std::ranges::copy(segment.bytes, image.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  return image;
}

VirtualModule::VirtualModule(const ModuleParts& parts, const FirmwareImage& image, VirtualModuleOptions options)
    : image_(image),
      options_(std::move(options)),
      board_(options_.board != nullptr ? *options_.board : image.board()),
      sensors_(parts.sensors),
      readings_(parts.readings),
      state_frame_(static_cast<std::uint16_t>(canopen::identifier::state_frame + parts.identity.node)),
      chip_(parts.bus, *this, chip_settings(parts, board_)) {
  const auto& parts_of_flash = options_.flash != nullptr ? options_.flash->parts : image.flash().elf().segments();
  for (const ElfImage::Segment& segment : parts_of_flash) {
    chip_.write(segment.load_address, segment.bytes);
  }
  if (parts.identity.node != 0) {
    chip_.write(flash_layout::board_records, firmware::encode(board_record(parts), 1));
  }
  chip_.set_transmit_watch([this](std::uint16_t identifier, std::uint64_t instructions) {
    if (chip_.cpu().core_register(program_counter) >= flash_layout::slot_a) {
      start_of_program_ = chip_.starts();
    }
    if (identifier == state_frame_) {
      state_frame_instructions_ = instructions;
    }
  });
}

void VirtualModule::power_on(BusTime now) {
  line_.clear();
  tick_.reset();
  pulse_begin_.reset();
  chip_.power_on(now);
}

void VirtualModule::advance_to(BusTime now, BusTime quiet_until) {
  if (!prepared_from_) {
    chip_.advance_to(now, quiet_until);
    return;
  }
  prepared_from_.reset();
  for (const std::function<void()>& call : std::exchange(reports_, {})) {
    call();
  }
  if (error_) {
    std::rethrow_exception(std::exchange(error_, nullptr));
  }
  if (quiet_until > prepared_until_) {
    static_cast<void>(chip_.run(now, quiet_until));
  }
}

bool VirtualModule::can_prepare(BusTime from) const {
  // A request that is due at `from` comes first.
  return !prepared_from_ && !chip_.has_debug_hook() && chip_.next_request() > from;
}

void VirtualModule::prepare(BusTime from, BusTime quiet_until) {
  prepared_from_ = from;
  is_preparing_ = true;
  try {
    prepared_until_ = chip_.run(from, quiet_until, true) ? quiet_until : 0;
  } catch (...) {
    error_ = std::current_exception();
  }
  is_preparing_ = false;
}

void VirtualModule::report(std::function<void()> call) {
  if (is_preparing_) {
    reports_.push_back(std::move(call));
  } else {
    call();
  }
}

firmware::TickRecord VirtualModule::last_tick() const {
  if (start_of_program_ != chip_.starts()) {
    return {};  // the program has not filled its RAM yet, or the bootloader runs
  }
  std::array<std::uint8_t, sizeof(firmware::TickRecord)> bytes{};
  chip_.read(image_.tick_record(), bytes);
  firmware::TickRecord record;
  std::memcpy(&record, bytes.data(), bytes.size());
  return record;
}

// A chip that sleeps is behind the time of the bus.

void VirtualModule::set_supply(BusTime now, std::uint32_t mv) {
  constexpr std::uint32_t reset_threshold_mv = 1'680;  // without brown-out reset
  chip_.advance_to(now, now);
  is_pulse_whole_ = is_pulse_whole_ && mv >= reset_threshold_mv;
  chip_.set_supply(mv);
}

void VirtualModule::set_adc(BusTime now, bool converts) {
  chip_.advance_to(now, now);
  chip_.set_adc(converts);
}

void VirtualModule::set_crystal(BusTime now, bool runs) {
  chip_.advance_to(now, now);
  is_pulse_whole_ = false;
  has_clock_ = runs;
  chip_.set_crystal(runs);
}

void VirtualModule::set_pll(BusTime now, bool locks) {
  chip_.advance_to(now, now);
  is_pulse_whole_ = false;
  has_clock_ = locks;
  chip_.set_pll(locks);
}

void VirtualModule::begin_serial_input(BusTime now, const SerialCharacter& character, BusTime bit) {
  chip_.advance_to(now, now);
  chip_.begin_serial_input(now, character, bit);
}

canopen::PowerState VirtualModule::power() const { return static_cast<canopen::PowerState>(last_tick().power); }

void VirtualModule::set_pulse_watch(PulseWatch watch) {
  pulse_watch_ = std::move(watch);
  chip_.set_pin_watch(board_.servo.port, board_.servo.number,
                      [this](BusTime time, bool high) { see_edge(time, high); });
}

void VirtualModule::set_command_watch(CommandWatch watch) {
  chip_.set_compare_watch([this, watch = std::move(watch)](BusTime time, std::uint32_t counts) {
    if (counts != 0) {  // 0: no pulses
      report([&watch, time, counts] { watch(time, static_cast<std::int32_t>(counts)); });
    }
  });
}

void VirtualModule::set_serial_watch(SerialWatch watch) {
  chip_.set_serial_watch([this, watch = std::move(watch)](BusTime time, std::uint8_t byte) {
    report([&watch, time, byte] { watch(time, byte); });
  });
}

void VirtualModule::see_edge(BusTime time, bool high) {
  if (high) {
    pulse_begin_ = time;
    is_pulse_whole_ = has_clock_;
    power_at_begin_ = power();
  } else if (pulse_begin_) {
    constexpr BusTime ns_per_us = 1'000;
    const BusTime counts = ((time - *pulse_begin_) * servo_counts_per_us + ns_per_us / 2) / ns_per_us;
    // The program publishes the state after the event that has begun the first pulse.
    const bool was_enabled = power_at_begin_ == canopen::PowerState::operation_enabled ||
                             power_at_begin_ == canopen::PowerState::quick_stop_active;
    const WatchedPulse pulse{*pulse_begin_, static_cast<std::int32_t>(counts), was_enabled ? power_at_begin_ : power(),
                             std::nullopt, is_pulse_whole_};
    report([this, pulse] { pulse_watch_(pulse); });
    pulse_begin_.reset();
  }
}

std::optional<std::int32_t> VirtualModule::pulse() const {
  constexpr LocalTime twelfth = local_time_per_us / servo_counts_per_us;
  const auto high = chip_.pulse_time(servo_channel);
  return high ? std::optional(static_cast<std::int32_t>(*high / twelfth)) : std::nullopt;
}

void VirtualModule::note_sync(std::uint32_t tick) {
  const std::uint64_t instructions = chip_.instructions();
  if (tick_) {
    const bool sent = state_frame_instructions_ > sync_instructions_;
    const TickCost cost{*tick_, sent ? state_frame_instructions_ - sync_instructions_ : 0,
                        instructions - sync_instructions_};
    if (cost.to_state_frame > worst_.to_state_frame) {
      worst_ = cost;
    }
    if (options_.on_tick) {
      options_.on_tick(cost);
    }
  }
  tick_ = tick;
  sync_instructions_ = instructions;
}

std::optional<std::string> VirtualModule::take_problem() {
  if (prepared_from_) {
    return std::nullopt;  // what it has found comes later
  }
  while (const auto event = chip_.take_event()) {
    if (event->kind == ChipEvent::Kind::reset && event->cause == ResetCause::software) {
      continue;  // the fault handler reset it, and the fault is reported; or the reset was requested
    }
    leaves_model_ = event->kind == ChipEvent::Kind::unmodelled;
    return describe(*event);
  }
  return std::nullopt;
}

std::string VirtualModule::describe(const ChipEvent& event) {
  if (event.kind == ChipEvent::Kind::reset) {
    return "at " + at_time(event.time) + " reset by " + in_words(*event.cause);
  }
  std::string text = "at " + at_time(event.time) + " ";
  switch (event.kind) {
    case ChipEvent::Kind::fault:
      text += "fault of the program: ";
      break;
    case ChipEvent::Kind::locked_up:
      text += "locked up: ";
      break;
    default:
      text += "stands still, beyond the model: ";
      break;
  }
  text += event.text + registers_in_words(event.registers);
  for (const std::string& line : trace(event)) {
    text += "\n    " + line;
  }
  return text;
}

std::vector<std::string> VirtualModule::trace(const ChipEvent& event) const {
  const auto read = [this](std::uint32_t address, std::span<std::uint8_t> bytes) { chip_.read(address, bytes); };
  const std::uint32_t pc = event.registers[program_counter];
  if (options_.flash != nullptr && pc >= ChipMemory::flash_start && pc < flash_layout::slot_a) {
    return trace_back(options_.flash->bootloader, event.registers, read);
  }
  image::HeaderBytes header{};
  chip_.read(flash_layout::slot_a, header);
  const std::vector<std::uint8_t> image = image_.image();
  if (!std::equal(header.begin(), header.end(), image.begin())) {
    return {"no back trace: the image in the chip is not that of " + image_.file().string()};
  }
  return trace_back(image_.file(), event.registers, read);
}

// Signals of the board at the pins.

std::optional<bool> VirtualModule::pin(char port, unsigned number) {
  const stm32f405::Pin pin{port, number};
  const auto contact = std::ranges::find(board_.contacts, pin);
  if (contact != board_.contacts.end()) {
    // A pressed switch closes to ground, an open one leaves the pin to its pull-up.
    const bool pressed = ((unsigned{sensors_()} >> (contact - board_.contacts.begin())) & 1U) != 0;
    return pressed ? std::optional(false) : std::nullopt;
  }
  return std::nullopt;
}

std::uint32_t VirtualModule::analog_uv(unsigned channel) {
  if (board_.servo_current && channel == analog_channel_of(*board_.servo_current)) {
    return std::min<std::uint32_t>(readings_().current_ma * microvolts_per_ma, max_uv);
  }
  if (board_.feedback && channel == analog_channel_of(*board_.feedback)) {
    constexpr std::int64_t quarter_turn = std::int64_t{1} << 30U;
    constexpr std::int64_t codes = 4096;
    const std::int64_t angle = readings_().angle.value_or(0);
    const std::int64_t span = Potentiometer::at_plus_90 - Potentiometer::at_minus_90;
    const std::int64_t part = (Potentiometer::at_minus_90 * 2 * quarter_turn + (angle + quarter_turn) * span) / codes;
    const std::int64_t uv = part * max_uv / (2 * quarter_turn);
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(uv, 0, max_uv));
  }
  return 0;
}

std::int32_t VirtualModule::chip_temperature() { return readings_().temperature_c * 1000; }

void VirtualModule::serial_output(unsigned /*usart*/, std::uint8_t byte) {
  if (byte == '\n') {
    if (options_.console) {
      report([this, line = line_] { options_.console(line); });
    }
    line_.clear();
  } else if (byte != '\r') {
    line_.push_back(static_cast<char>(byte));
  }
}

}  // namespace proleg::sim
