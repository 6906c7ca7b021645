#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "firmware/module/module.hpp"
#include "sim/bus/bus.hpp"
#include "sim/loop/crystal.hpp"
#include "sim/loop/joint_module.hpp"

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
  /// Measurements of the servo and the chip, at this moment.
  using Readings = std::function<firmware::ServoReadings()>;
  /// For tests, between controller and program: delivers a frame, withholds it, or delivers another one.
  using Tamper = std::function<void(const CanFrame& frame, const std::function<void(const CanFrame&)>& deliver)>;

  /// Attaches to the bus, switched off. Without readings the module measures nothing.
  NativeModule(Bus& bus, const firmware::ModuleIdentity& identity, Crystal crystal, Sensors sensors,
               Readings readings = {});
  NativeModule(const NativeModule&) = delete;
  NativeModule& operator=(const NativeModule&) = delete;

  void power_on(BusTime now) override;
  [[nodiscard]] BusTime next_event() const override { return next_event_; }
  void advance_to(BusTime now, BusTime quiet_until) override;
  void run_out(BusTime now, BusTime until) override { advance_to(until, now); }
  [[nodiscard]] firmware::TickRecord last_tick() const override { return module_.last_tick(); }
  [[nodiscard]] std::optional<std::int32_t> pulse() const override { return pulse_; }
  [[nodiscard]] std::size_t controller() const override { return controller_.index(); }

  void set_tamper(Tamper tamper) { tamper_ = std::move(tamper); }

 private:
  /// A separate object, because read() of ContactPort has the same name.
  struct Meters final : firmware::SensorPort {
    explicit Meters(Readings readings) : source(std::move(readings)) {}
    [[nodiscard]] firmware::ServoReadings take_readings() override {
      return source ? source() : firmware::ServoReadings{};
    }
    Readings source;
  };

  void received(BusTime time, const CanFrame& frame) override;
  void transmitted(BusTime time, const CanFrame& frame) override;
  void error_state_changed(BusTime time) override;
  void pulse(std::int32_t width, std::uint32_t /*period_us*/) override { pulse_ = width; }
  void off() override { pulse_.reset(); }
  [[nodiscard]] std::uint8_t read() override { return sensors_(); }
  void update_deadline() { next_event_ = crystal_.when(module_.next_deadline()); }

  Crystal crystal_;
  Sensors sensors_;
  Meters meters_;
  Tamper tamper_;
  Controller& controller_;
  firmware::Module module_;
  std::optional<std::int32_t> pulse_;
  BusTime next_event_ = never_on_bus;
};

}  // namespace proleg::sim
