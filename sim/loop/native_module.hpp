#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "firmware/module/module.hpp"
#include "sim/bus/bus.hpp"
#include "sim/loop/crystal.hpp"

namespace proleg::sim {

/// A joint module on the simulated bus: the module's program as built for this computer, with a controller, a crystal,
/// a servo and touch sensors.
class NativeModule final : private BusListener, private firmware::ServoPort, private firmware::ContactPort {
 public:
  /// Reads the touch sensors that are wired to the module, as they are at this moment.
  using Sensors = std::function<std::uint8_t()>;
  /// What stands between controller and program in tests: hands on a frame, or does not, or something else.
  using Tamper = std::function<void(const CanFrame& frame, const std::function<void(const CanFrame&)>& deliver)>;

  /// Attaches to the bus. The module is off.
  NativeModule(Bus& bus, const firmware::Board& board, Crystal crystal, Sensors sensors);
  NativeModule(const NativeModule&) = delete;
  NativeModule& operator=(const NativeModule&) = delete;

  /// Switches it on, or restarts it: nothing is known but the board, the servo goes limp.
  void power_on(BusTime now);
  /// When it wants to do something next.
  [[nodiscard]] BusTime next_event() const { return next_event_; }
  /// Does what is due.
  void advance_to(BusTime now);

  [[nodiscard]] const Kernel& kernel() const { return module_.kernel(); }
  /// Whether the joint's kernel has computed this tick and is waiting for the next one.
  [[nodiscard]] bool has_computed(unsigned joint, std::uint32_t tick) const;
  /// The pulse that the servo gets; none if it is off.
  [[nodiscard]] std::optional<std::int32_t> pulse() const { return pulse_; }
  /// Index of its controller.
  [[nodiscard]] std::size_t controller() const { return controller_.index(); }

  void set_tamper(Tamper tamper) { tamper_ = std::move(tamper); }

 private:
  void received(BusTime time, const CanFrame& frame) override;
  void transmitted(BusTime time, const CanFrame& frame) override;
  void pulse(std::int32_t width) override { pulse_ = width; }
  void off() override { pulse_.reset(); }
  [[nodiscard]] std::uint8_t read() override { return sensors_(); }
  void update_deadline() { next_event_ = crystal_.when(module_.next_deadline()); }

  Crystal crystal_;
  Sensors sensors_;
  Tamper tamper_;
  Controller& controller_;
  firmware::Module module_;
  std::optional<std::int32_t> pulse_;
  BusTime next_event_ = never_on_bus;
};

}  // namespace proleg::sim
