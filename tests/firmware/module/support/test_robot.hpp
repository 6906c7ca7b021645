#pragma once

// A robot of modules on a bus, driven the way a host drives it.

#include "robot.hpp"
#include "shared/computer/master/setup_list.hpp"
#include "test_bus.hpp"

namespace proleg::test {

inline constexpr std::array<std::uint16_t, 3> power_up{0x0006, 0x0007, 0x000F};

inline bool is_sync(const CanFrame& frame) { return frame.identifier == canopen::identifier::sync; }
inline canopen::Address parameter_address(const Kernel& kernel, std::uint8_t slot, std::string_view name,
                                          canopen::ValueKind kind = canopen::ValueKind::parameter) {
  const Declaration& declaration = kernel.configuration().slots[slot].algorithm->declaration();
  const unsigned number = kind == canopen::ValueKind::internal_value ? value_index(kernel, slot, name)
                                                                     : parameter_index(kernel, slot, name);
  return canopen::address_of({kind, declaration.id, static_cast<std::uint8_t>(number), slot});
}

class TestRobot {
 public:
  /// The modules have node ids in no order, and each its own clock.
  explicit TestRobot(const KernelConfiguration& kernel, std::uint32_t servo_period_us = 20'000)
      : nodes_{5, 1, 9, 3, 12, 77, 126, 2}, limits_(kernel.joint_count, {-quarter_turn, quarter_turn}) {
    nodes_.resize(kernel.joint_count);
    setup.kernel = kernel;
    setup.servo_period_us = servo_period_us;
    setup.nodes = nodes_;
    setup.limits = limits_;
    for (unsigned joint = 0; joint < kernel.joint_count; ++joint) {
      firmware::ModuleIdentity identity;
      identity.node = nodes_[joint];
      identity.unique_id = {joint * 77U + 1U, 0x12345678, 0x9ABCDEF0};
      identity.core_fingerprint = 0xC0DEC0DE;
      bus.add(identity, joint * Microseconds{123'456'789});
    }
  }

  [[nodiscard]] std::uint8_t node(unsigned joint) const { return nodes_[joint]; }
  [[nodiscard]] ModuleNode& at(unsigned joint) { return *bus.nodes[joint]; }
  [[nodiscard]] firmware::Module& module(unsigned joint) { return at(joint).module; }
  [[nodiscard]] const Kernel& kernel(unsigned joint) { return module(joint).kernel(); }
  [[nodiscard]] unsigned joints() const { return setup.kernel.joint_count; }
  void limit(unsigned joint, std::int32_t lower, std::int32_t upper) { limits_[joint] = {lower, upper}; }

  /// Switches the modules on, and runs until all boot-up messages were sent.
  void boot() {
    for (const auto& node : bus.nodes) {
      node->power_on(bus.now());
    }
    bus.run_for(20'000);
  }
  void configure(unsigned joint) {
    const canopen::SetupList list(setup, joint);
    ASSERT_GT(list.size(), 0U);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const canopen::SdoRequest write = list.at(i);
      ASSERT_EQ(bus.write(node(joint), write.address, write.size, write.value), canopen::AbortCode::none)
          << "joint " << joint << ": " << std::hex << write.address.index << ':' << int{write.address.sub} << " = "
          << write.value;
    }
  }
  /// Configures all modules.
  void set_up() {
    boot();
    for (unsigned joint = 0; joint < joints(); ++joint) {
      configure(joint);
    }
  }
  void command(canopen::NmtCommand command, std::uint8_t node = 0) {
    bus.deliver(encode(canopen::NmtRequest{command, node}));
  }
  void start() {
    command(canopen::NmtCommand::start);
    bus.run_for(10'000);
  }
  void produce_sync(unsigned joint = 0) {
    ASSERT_EQ(
        bus.write(node(joint), canopen::object::sync_identifier, canopen::produces_sync | canopen::identifier::sync),
        canopen::AbortCode::none);
  }
  /// Sets the modules up and starts them; SYNC 0 is the next one.
  void drive() {
    set_up();
    start();
    produce_sync();
  }
  void enable(unsigned joint) {
    for (const std::uint16_t controlword : power_up) {
      ASSERT_EQ(bus.write(node(joint), canopen::object::controlword, controlword), canopen::AbortCode::none);
    }
    ASSERT_EQ(module(joint).power(), canopen::PowerState::operation_enabled);
  }
  /// Runs until `count` SYNCs were sent from now on, and the modules have answered each.
  void run_syncs(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      ASSERT_TRUE(bus.run_until_sent(is_sync)) << "no SYNC";
    }
  }
  /// Runs until SYNC `tick` has come.
  void run_to(std::uint32_t tick) {
    while (kernel(0).tick() <= tick) {
      ASSERT_TRUE(bus.run_until_sent(is_sync)) << "no SYNC";
    }
  }

  TestBus bus;
  canopen::RobotSetup setup;

 private:
  std::vector<std::uint8_t> nodes_;
  std::vector<AngleLimits> limits_;
};

/// A single configured module. The test sends its SYNC and TICK; its neighbours do not exist.
class TestModule : public TestRobot {
 public:
  static constexpr unsigned joint = 0;
  static constexpr std::uint8_t node_id = 5;

  explicit TestModule(const KernelConfiguration& kernel = one_slot(algorithm(sinusoidal), 1),
                      std::uint32_t servo_period_us = 20'000)
      : TestRobot(kernel, servo_period_us) {
    bus.nodes.resize(1);
  }

  [[nodiscard]] ModuleNode& it() { return at(0); }
  [[nodiscard]] firmware::Module& module() { return it().module; }
  [[nodiscard]] const Kernel& kernel() { return module().kernel(); }
  [[nodiscard]] std::vector<canopen::Emergency> emergencies(std::size_t from = 0) const {
    return bus.emergencies(node_id, from);
  }
  [[nodiscard]] std::uint32_t crc() const { return canopen::configuration_crc(setup); }

  /// Configures the module and enters Operational.
  void set_up_and_start() {
    boot();
    configure(0);
    start();
  }
  /// Writes an object, which the module must accept.
  void write(const canopen::Object& entry, std::uint32_t value) {
    ASSERT_EQ(bus.write(node_id, entry, value), canopen::AbortCode::none) << std::hex << entry.address.index;
  }
  void write_controlword(std::uint16_t value) { write(canopen::object::controlword, value); }
  void tick(std::uint32_t tick) { bus.deliver(encode(canopen::TickMessage{tick, crc()})); }
  /// Sends SYNC a tick period after the one before, or now if that is later.
  void sync(std::uint32_t tick) {
    bus.run_until(std::max(bus.now(), next_sync_));
    next_sync_ = bus.now() + setup.kernel.tick_period_us;
    bus.deliver(canopen::encode_sync(tick));
  }
  /// Sends TICK, SYNC 0 and further SYNCs, up to and including SYNC `last`, a tick period apart.
  void run(std::uint32_t last) {
    tick(0);
    for (std::uint32_t k = 0; k <= last; ++k) {
      sync(k);
      bus.run_for(setup.kernel.tick_period_us - TestBus::frame_time_us);
    }
  }
  void run(std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t k = first; k <= last; ++k) {
      sync(k);
      bus.run_for(setup.kernel.tick_period_us - TestBus::frame_time_us);
    }
  }

 private:
  Microseconds next_sync_ = 0;
};

/// Node id of the module.
inline constexpr std::uint8_t node = TestModule::node_id;

}  // namespace proleg::test
