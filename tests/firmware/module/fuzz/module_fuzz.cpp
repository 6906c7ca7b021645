// Gives two modules, one of them configured, arbitrary frames and arbitrary times. An input is a sequence of events;
// most of them are meaningful, so that the modules move. After every event: the servo has pulses only when the rules
// allow it and within its range, and the next deadline is later than now.

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <span>

#include "firmware/module/module.hpp"
#include "shared/broadcast/transfer_frame.hpp"
#include "shared/computer/master/setup_list.hpp"
#include "shared/fixed/little_endian.hpp"
#include "shared/gait/registry.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using canopen::NmtState;
using canopen::PowerState;
using test::FuzzInput;
using test::require;

/// A robot of three joints with two slots on one of them.
class Setup {
 public:
  Setup() {
    robot.kernel.joint_count = 3;
    robot.kernel.slots[0] = {find_algorithm("PatternGenerator_coupled_oscillator"), JointMask(0b111)};
    robot.kernel.slots[1] = {find_algorithm("PatternGenerator_sinusoidal_extended"), JointMask(0b010)};
    robot.servo_period_us = 3'000;
    robot.nodes = nodes_;
    robot.limits = limits_;
  }
  static constexpr unsigned joint = 1;
  [[nodiscard]] std::uint8_t node(unsigned of_joint) const { return nodes_[of_joint]; }

  canopen::RobotSetup robot;

 private:
  std::array<std::uint8_t, 3> nodes_{4, 9, 2};
  std::array<AngleLimits, 3> limits_{{{-1 << 29, 1 << 30}, {-1 << 30, 1 << 29}, {-1 << 30, 1 << 30}}};
};

struct Meters final : firmware::SensorPort {
  ServoReadings take_readings() override { return readings; }
  ServoReadings readings;
};

class Flash final : public firmware::FlashPort {
 public:
  bool erase(unsigned sector) override {
    sectors_.at(sector).fill(0xFF);
    return true;
  }
  bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) override {
    std::copy(bytes.begin(), bytes.end(), sectors_.at(sector).begin() + offset);
    return true;
  }
  [[nodiscard]] std::span<const std::uint8_t> contents(unsigned sector) const override { return sectors_.at(sector); }

 private:
  static constexpr std::array<std::uint8_t, 128> erased_ = [] {
    std::array<std::uint8_t, 128> bytes{};
    bytes.fill(0xFF);
    return bytes;
  }();
  std::array<std::array<std::uint8_t, 128>, 2> sectors_{erased_, erased_};
};

/// Two modules share the buffer, which does not matter: its contents are the host's.
class Program final : public firmware::ProgramPort {
 public:
  std::span<std::uint8_t> buffer() override { return buffer_; }
  [[nodiscard]] std::span<const std::uint8_t> header() const override { return header_; }
  [[nodiscard]] bool has_bootloader() const override { return true; }
  [[nodiscard]] bool is_confirmed() const override { return is_confirmed_; }
  void confirm() override { is_confirmed_ = true; }
  void note_good_start() override {}
  void install(const firmware::Installation& what) override {
    require(what.size > 0 && what.size <= buffer_.size() && what.session != 0, "an image of a session is installed");
    ++restarts;
  }
  void enter_bootloader() override { ++restarts; }

  unsigned restarts = 0;

 private:
  std::array<std::uint8_t, 64> buffer_{};
  std::array<std::uint8_t, 512> header_{};
  bool is_confirmed_ = false;
};

class World final : CanPort, firmware::ServoPort, firmware::ContactPort {
 public:
  explicit World(const Setup& setup)
      : setup_(setup), module({0, 1, {7, 8, 9}}, {*this, *this, *this, meters_, flash_, nullptr, &program_}) {
    firmware::BoardRecord board;
    board.node = setup.node(Setup::joint);
    require(firmware::append(flash_, board) == firmware::AppendResult::ok, "the flash keeps a record");
  }

  void power_on() {
    off_ = asked_ = false;
    module.power_on(now_);
    run_for(20'000);
  }
  /// As a host does it.
  void configure() {
    const canopen::SetupList list(setup_.robot, Setup::joint);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const canopen::SdoRequest entry = list.at(i);
      write(entry.address, entry.size, entry.value);
    }
    receive(encode(canopen::NmtRequest{canopen::NmtCommand::start, 0}));
  }

  void handle(std::uint8_t event, FuzzInput& input);

 private:
  // The ports.
  bool send(const CanFrame& frame) override {
    require(frame.length <= 8 && frame.identifier <= CanFrame::max_identifier, "frames are frames");
    const unsigned node = module.node();  // LSS may have changed it
    const unsigned base = frame.identifier - node;
    const bool own = base == 0x080 || base == 0x180 || base == 0x280 || base == 0x380 || base == 0x580 || base == 0x700;
    const bool is_answer =
        frame.identifier == canopen::identifier::lss_answer || frame.identifier == broadcast::module_identifier;
    require(is_answer || node != 0, "a module without a node id sends answers of LSS and updates only");
    require(own || is_answer || frame.identifier == canopen::identifier::sync ||
                frame.identifier == canopen::identifier::tick,
            "a module sends on its own identifiers, SYNC, TICK, LSS and updates");
    require(!off_, "nothing is handed to a controller that is bus-off");
    const bool is_twice = std::any_of(mailboxes_.begin(), mailboxes_.end(),
                                      [&](const CanFrame& other) { return other.identifier == frame.identifier; });
    if (closed_ || is_twice || mailboxes_.size() == mailbox_count) {
      return false;
    }
    mailboxes_.push_back(frame);
    return true;
  }
  void pulse(std::int32_t width, std::uint32_t period_us) override {
    require(period_us >= 100 && period_us <= 100'000, "pulses have a servo's period");
    require(width >= 6'000 && width <= 30'000, "pulses are within the servo's range");
    require(module.state() == NmtState::operational, "pulses are sent in Operational only");
    const bool enabled = module.power() == PowerState::operation_enabled && module.synchronised();
    require(enabled || (module.power() == PowerState::quick_stop_active && pulsing_),
            "pulses begin when the drive is enabled and the tick is known");
    pulsing_ = true;
  }
  void off() override { pulsing_ = false; }
  void recover() override {
    require(off_, "a module asks to come back only in bus-off");
    asked_ = true;
  }
  std::uint8_t read_contacts() override { return sensors_; }

  // Events.
  void check() const {
    const bool may = module.state() == NmtState::operational &&
                     ((module.power() == PowerState::operation_enabled && module.synchronised()) ||
                      module.power() == PowerState::quick_stop_active);
    require(may || !pulsing_, "without power there are no pulses");
    require(!module.synchronised() || module.state() == NmtState::operational, "the tick is known in Operational");
  }
  void receive(const CanFrame& frame) {
    if (!off_) {
      module.receive(now_, frame);
      check();
    }
  }
  void write(canopen::Address address, std::uint8_t size, std::uint32_t value) {
    CanFrame frame{static_cast<std::uint16_t>(canopen::identifier::sdo_request + setup_.node(Setup::joint)), 8, {}};
    frame.data = {static_cast<std::uint8_t>(0x23U | (4U - size) << 2U),
                  static_cast<std::uint8_t>(address.index),
                  static_cast<std::uint8_t>(address.index >> 8U),
                  address.sub,
                  static_cast<std::uint8_t>(value),
                  static_cast<std::uint8_t>(value >> 8U),
                  static_cast<std::uint8_t>(value >> 16U),
                  static_cast<std::uint8_t>(value >> 24U)};
    receive(frame);
  }
  /// Of an algorithm that is in one of the slots; the slot may be another.
  static canopen::ValueAddress value_address(FuzzInput& input) {
    const auto kind = static_cast<canopen::ValueKind>(input.byte() % 3U);
    const auto algorithm = static_cast<std::uint8_t>(3U + input.byte() % 2U);
    const auto number = static_cast<std::uint8_t>(input.byte() % 8U);
    return {kind, algorithm, number, static_cast<std::uint8_t>(input.byte() % 3U)};
  }
  void poll() {
    module.poll(now_);
    require(module.next_deadline() > now_, "the next deadline is later than now");
    check();
  }
  void run_for(Microseconds time) {
    const Microseconds end = now_ + time;
    for (unsigned polls = 0; module.next_deadline() <= end; ++polls) {
      require(polls < 20'000, "deadlines are not that close");
      now_ = module.next_deadline();
      poll();
      transmit();
    }
    now_ = end;
  }
  void handle_bus(std::uint8_t what) {
    if (what % 8U == 7) {
      mailboxes_.clear();
      off_ = true;
      module.bus_off(now_);
    } else if (asked_ || what % 8U == 6) {
      off_ = asked_ = false;
      module.bus_back(now_);
    }
    closed_ = what < 64;
    require(module.is_bus_off() == off_, "the module knows whether it is on the bus");
    check();
  }
  void transmit() {
    // Frames that are handed over meanwhile wait for the next call: the end of a SYNC may add more than one.
    for (std::size_t count = mailboxes_.size(); count > 0; --count) {
      const CanFrame frame = mailboxes_.front();
      mailboxes_.pop_front();
      module.transmitted(now_, frame);
      check();
    }
  }

  static constexpr std::size_t mailbox_count = 3;

  const Setup& setup_;
  Microseconds now_ = 0;
  std::deque<CanFrame> mailboxes_;
  Meters meters_;
  Flash flash_;
  Program program_;
  bool closed_ = false;
  bool off_ = false;    ///< the bus
  bool asked_ = false;  ///< to come back
  bool pulsing_ = false;
  std::uint8_t sensors_ = 0;

 public:
  firmware::Module module;
};

void World::handle(std::uint8_t event, FuzzInput& input) {
  const std::uint32_t coming = module.kernel().tick();
  const std::uint32_t crc = canopen::configuration_crc(setup_.robot);
  const std::uint8_t node = setup_.node(Setup::joint);
  switch (event % 20U) {
    case 0:
      run_for(Microseconds{input.byte()} * 100);
      break;
    case 1:
      write(canopen::object::sync_identifier.address, 4,
            canopen::identifier::sync | (input.byte() % 4U == 0 ? 0U : canopen::produces_sync));
      break;
    case 2: {  // the program was not called for long
      now_ += Microseconds{input.half()} << (input.byte() % 12U);
      poll();
      break;
    }
    case 3:
    case 4:
      receive(canopen::encode_sync(coming + input.byte() % 4U % 3U));
      break;
    case 5: {
      const canopen::Address address = address_of(value_address(input));
      receive({static_cast<std::uint16_t>(canopen::identifier::sdo_request + node),
               8,
               {0x40, static_cast<std::uint8_t>(address.index), static_cast<std::uint8_t>(address.index >> 8U),
                address.sub}});
      break;
    }
    case 6:
      receive({canopen::identifier::sync, static_cast<std::uint8_t>(input.byte() % 3U), {input.byte()}});
      break;
    case 7:
      receive(encode(canopen::TickMessage{coming + input.byte() - 3U, crc}));
      break;
    case 8:
      receive(encode(canopen::TickMessage{0, crc}));
      receive(canopen::encode_sync(0));
      break;
    case 9:
      receive(encode(canopen::CommitMessage{input.byte(), coming + input.byte() - 8U, 1}));
      break;
    case 10: {
      constexpr std::array<std::uint16_t, 8> words{0x06, 0x07, 0x0F, 0x0F, 0x02, 0x80, 0x00, 0x8F};
      receive(encode(canopen::Command{node, words[input.byte() % 8U], static_cast<std::int32_t>(input.word())}));
      break;
    }
    case 11:
      for (const std::uint16_t word : {std::uint16_t{0x80}, std::uint16_t{6}, std::uint16_t{7}, std::uint16_t{15}}) {
        write(canopen::object::controlword.address, 2, word);
      }
      break;
    case 12: {
      constexpr std::array commands{canopen::NmtCommand::start, canopen::NmtCommand::stop,
                                    canopen::NmtCommand::enter_pre_operational, canopen::NmtCommand::reset_node};
      const std::uint8_t which = input.byte();
      receive(encode(
          canopen::NmtRequest{which >= 224 ? canopen::NmtCommand::reset_communication : commands[which % 4U], 0}));
      break;
    }
    case 13: {
      const std::span<const canopen::ObjectRow> rows = canopen::object_rows();
      const canopen::Object& entry = *rows[input.byte() % rows.size()].first;
      write({static_cast<std::uint16_t>(entry.address.index + input.byte() % 3U), entry.address.sub},
            std::max<std::uint8_t>(1, size_of(entry.type)), input.byte() < 128 ? input.byte() : input.word());
      break;
    }
    case 14: {
      const canopen::ValueAddress value = value_address(input);
      write(canopen::object::transaction.address, 2, input.byte());
      write(address_of(value), 4, input.word());
      break;
    }
    case 15: {
      const unsigned sender = input.byte() % 3U;
      const unsigned channel = input.byte() % 2U;
      CanFrame frame = canopen::encode_state(setup_.node(sender), channel, StateFrame{input.take<8>()});
      if (sender == Setup::joint) {
        frame.identifier =
            static_cast<std::uint16_t>(frame.identifier + 64U);  // its own identifier would be a collision
      }
      frame.data[7] = static_cast<std::uint8_t>(coming + frame.data[7] % 4U);
      receive(frame);
      break;
    }
    case 16: {
      const std::uint16_t half = input.half();
      const bool is_update = half >= 0x8000U;
      const auto identifier = is_update ? broadcast::host_identifier : static_cast<std::uint16_t>(half % 0x800U);
      const auto length = static_cast<std::uint8_t>(input.byte() % 9U);
      CanFrame frame{identifier, length, input.take<8>()};
      if (is_update && length < CanFrame::max_length) {
        frame.data[0] %= 12U;  // a code, and one session or the serial number
        frame.data[1] = (half & 1U) == 0 ? 1 : frame.data[1];
        if (length == 5 || length == 6) {
          write_little_endian(frame.data, length - 4U, 4, firmware::serial_number({0, 1, {7, 8, 9}}));
        }
        if (frame.data[0] == static_cast<std::uint8_t>(broadcast::Code::begin)) {
          frame = broadcast::begin_frame(frame.data[1], frame.data[2] % 100U);
        }
      }
      const bool may_restart = module.power() != PowerState::operation_enabled && !pulsing_;
      const unsigned restarts = program_.restarts;
      for (std::size_t i = length; i < 8; ++i) {
        frame.data[i] = 0;
      }
      receive(frame);
      require(may_restart || program_.restarts == restarts, "a program ends only while its servo has no power");
      break;
    }
    case 17:
      sensors_ = input.byte();
      meters_.readings.current_ma = static_cast<std::uint16_t>(sensors_ << 4U);
      transmit();
      break;
    case 18:
      handle_bus(input.byte());
      receive(encode(canopen::Heartbeat{canopen::host_node, NmtState::operational}));
      break;
    default:
      receive(encode(canopen::NmtRequest{canopen::NmtCommand::enter_pre_operational, 0}));
      configure();
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Setup setup;
  World configured(setup);
  World unconfigured(setup);
  configured.power_on();
  configured.configure();
  require(configured.module.state() == NmtState::operational, "the set-up configures a module");
  unconfigured.power_on();
  FuzzInput first({data, size});
  while (!first.empty()) {
    const std::uint8_t event = first.byte();
    configured.handle(event, first);
  }
  FuzzInput second({data, size});
  while (!second.empty()) {
    const std::uint8_t event = second.byte();
    unconfigured.handle(event, second);
  }
  return 0;
}
