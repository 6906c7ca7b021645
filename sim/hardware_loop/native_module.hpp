#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/module/module.hpp"
#include "sim/bus/bus.hpp"
#include "sim/hardware_loop/crystal.hpp"
#include "sim/hardware_loop/joint_module.hpp"
#include "sim/hardware_loop/native_line.hpp"
#include "sim/hardware_loop/native_program.hpp"

namespace proleg::sim {

/// A joint module on the simulated bus: the module's program as built for this computer, with a controller, a crystal,
/// a servo, touch sensors and measurements.
class NativeModule final : public JointModule,
                           private BusListener,
                           private firmware::ServoPort,
                           private firmware::ContactPort {
 public:
  /// Reads the touch sensors that are wired to the module, at this moment.
  using Sensors = std::function<std::uint8_t()>;
  /// Measurements of the servo and the chip, as firmware::SensorPort has them.
  using Readings = std::function<ServoReadings()>;
  /// A hook for tests between controller and program: delivers a frame, withholds it, or delivers another one.
  using Tamper = std::function<void(const CanFrame& frame, const std::function<void(const CanFrame&)>& deliver)>;

  /// Attaches to the bus, switched off. Without readings the module measures nothing. The board record in its flash has
  /// the identity's node id and says whether it measures the angle and is a gateway; with node id 0 there is none. The
  /// flash keeps its contents over power_on().
  NativeModule(Bus& bus, const firmware::ModuleIdentity& identity, Crystal crystal, Sensors sensors,
               Readings readings = {}, bool is_gateway = false);
  NativeModule(const NativeModule&) = delete;
  NativeModule& operator=(const NativeModule&) = delete;

  void power_on(BusTime now) override;
  [[nodiscard]] BusTime next_event() const override { return next_event_; }
  void advance_to(BusTime now, BusTime quiet_until) override;
  void run_out(BusTime now, BusTime until) override { advance_to(until, now); }
  void set_supply(BusTime now, std::uint32_t mv) override;
  void set_adc(BusTime /*now*/, bool converts) override { meters_.converts = converts; }
  void begin_serial_input(BusTime now, const SerialCharacter& character, BusTime bit) override {
    if (runs_program()) {  // else nobody reads the line
      line_.begin_input(now, character, bit);
      update_deadline();
    }
  }
  void set_serial_watch(SerialWatch watch) override { line_.watch(std::move(watch)); }
  [[nodiscard]] canopen::PowerState power() const override { return module_.power(); }
  void set_pulse_watch(PulseWatch watch) override { pulse_watch_ = std::move(watch); }
  void set_command_watch(CommandWatch watch) override { command_watch_ = std::move(watch); }
  [[nodiscard]] firmware::TickRecord last_tick() const override {
    return after_pause_ == AfterPause::starts ? firmware::TickRecord{} : module_.last_tick();
  }
  [[nodiscard]] std::optional<std::int32_t> pulse() const override { return pulse_; }
  [[nodiscard]] std::size_t controller() const override { return controller_.index(); }

  /// The node id in use; 0: none.
  [[nodiscard]] std::uint8_t node() const { return module_.node(); }

  /// The program with its slots and its bootloader. The module is to be off when they are changed.
  [[nodiscard]] NativeProgram& program() { return program_; }
  /// Default values and its node id, as a program writes them whose settings have this schema. The module is to be off,
  /// or about to start.
  void write_settings(std::uint8_t schema);

  /// Sets the time from power on to the start of the program, in which the bootloader listens; it is 0 without this
  /// call.
  void set_start_time(Microseconds time) { start_time_us_ = time; }

  void set_tamper(Tamper tamper) { tamper_ = std::move(tamper); }

 private:
  struct Meters final : firmware::SensorPort {
    explicit Meters(Readings readings) : source(std::move(readings)) {}
    [[nodiscard]] ServoReadings take_readings() override {
      // After a failure the program restarts the converter at a reading, and has new values at the next one.
      const bool are_new = has_converted;
      if (are_new) {
        last = source ? source() : ServoReadings{};
        last.feedback_reading = last.angle ? std::optional(Potentiometer::reading_of(*last.angle)) : std::nullopt;
      }
      last.are_new = are_new;
      has_converted = converts;
      return last;
    }
    Readings source;
    ServoReadings last{};
    bool converts = true;
    bool has_converted = true;  ///< it converted at the last call
  };

  /// The mailboxes as the driver of the chip uses them (firmware/stm32f405/can.hpp).
  class Port final : public CanPort {
   public:
    explicit Port(Controller& controller) : controller_(controller) {}
    [[nodiscard]] bool send(const CanFrame& frame) override;
    [[nodiscard]] CanStatus status() override;
    [[nodiscard]] CanErrors take_errors() override { return std::exchange(errors_, {}); }
    void recover() override { controller_.recover(); }
    void note_error();

   private:
    Controller& controller_;
    std::array<CanFrame, Controller::mailbox_count> frames_{};  ///< the last request of each mailbox
    CanErrors errors_;
  };

  /// Flash of the size that the board has for its settings.
  class Flash final : public firmware::FlashPort {
   public:
    [[nodiscard]] bool erase(unsigned sector) override;
    [[nodiscard]] bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) override;
    [[nodiscard]] std::span<const std::uint8_t> contents(unsigned sector) const override { return sectors_.at(sector); }

   private:
    static constexpr std::size_t sector_size = 16 * 1024;
    static constexpr std::uint8_t erased = 0xFF;
    std::array<std::vector<std::uint8_t>, 2> sectors_{std::vector<std::uint8_t>(sector_size, erased),
                                                      std::vector<std::uint8_t>(sector_size, erased)};
  };

  void received(BusTime time, const CanFrame& frame) override;
  void transmitted(BusTime time, const CanFrame& frame) override;
  void error_seen(BusTime time, bool was_sending) override;
  void error_state_changed(BusTime time) override;
  void pulse(std::int32_t width, std::uint32_t period_us) override;
  void off() override { pulse_.reset(); }
  [[nodiscard]] std::uint8_t read_contacts() override { return sensors_(); }
  /// What follows when the chip has written its flash, has computed a checksum, or has hung long enough.
  enum class AfterPause : std::uint8_t { goes_on, starts, resets, stays_deaf };

  void open_window(BusTime now);
  void start(BusTime now);
  void reset(BusTime now);
  void pause(BusTime now, Microseconds time, AfterPause after);
  void end_pause(BusTime now);
  [[nodiscard]] bool runs_program() { return pause_end_ == 0 && program_.bootloader() == nullptr; }
  /// To be called after each event: serves the line, and does what the program has requested.
  void finish_event(BusTime now);
  void update_deadline();

  Bus& bus_;
  Crystal crystal_;
  Sensors sensors_;
  Meters meters_;
  Flash flash_;
  Tamper tamper_;
  Controller& controller_;
  Port port_{controller_};
  NativeLine line_{bus_};
  NativeProgram program_;
  firmware::Module module_;
  std::optional<std::int32_t> pulse_;
  PulseWatch pulse_watch_;
  CommandWatch command_watch_;
  bool has_power_ = true;
  bool is_supply_low_ = false;
  Microseconds start_time_us_ = 0;
  Microseconds deadline_ = never;  ///< the program's, by its crystal
  BusTime deadline_time_ = never_on_bus;
  BusTime pause_end_ = 0;  ///< end of the pause in which the module does nothing; 0: there is no pause
  AfterPause after_pause_ = AfterPause::goes_on;
  /// The bootloader listens before it starts the program, until this time; 0: it does not listen.
  BusTime window_end_ = 0;
  BusTime next_event_ = never_on_bus;
};

}  // namespace proleg::sim
