#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/dynamixel/chain_settings.hpp"
#include "host/dynamixel/servo_bus.hpp"

namespace proleg::host {

/// The servos of a robot in the order of its joints. The class has no clock of its own: it uses that of the line.
class ServoChain {
 public:
  using Show = std::function<void(const std::string&)>;

  /// line: must outlive the chain. show: receives what the user should know, one line each.
  ServoChain(Line& line, ChainSettings settings, Show show);

  // All functions end by the deadline, a time of the line's clock. They throw ServoError and LineError.
  /// Finds all servos, switches their power off, prepares them and reads their angles.
  void connect(std::uint64_t deadline_us);
  /// Switches the power on: the goal of each servo is its position, or the nearest limit of its joint. From now on the
  /// servos stop by themselves if nothing is sent for the time of the watchdog.
  void switch_on(std::uint64_t deadline_us);
  /// Switches the power off; also that of the other servos if one does not answer.
  void switch_off(std::uint64_t deadline_us);
  /// Sends joint angles in degrees, then reads as many servos as the rest of the tick allows, in turn. If a servo has
  /// failed, it sends the angles nevertheless and throws.
  void send_goals(std::span<const double> joint_deg, std::uint64_t deadline_us);
  /// Throws unless each servo answers.
  void test(std::uint64_t deadline_us);
  void discard_input() { bus_.discard_input(); }

  // The values that were received last.
  struct Reading {
    double angle_deg = 0.0;
    double current = 0.0;        ///< in the servo's unit
    double temperature_c = 0.0;  ///< degrees Celsius
  };
  [[nodiscard]] std::span<const Reading> readings() const { return readings_; }
  [[nodiscard]] bool is_connected() const { return is_connected_; }
  /// Number of servos that are read in each tick.
  [[nodiscard]] std::size_t reads_per_tick() const { return reads_per_tick_; }
  [[nodiscard]] const ChainSettings& settings() const { return settings_; }

 private:
  std::string name_of(std::size_t joint) const;
  void find_all();
  void prepare(std::size_t joint);
  void prepare_modes(std::size_t joint);
  void check_position_limits(std::size_t joint);
  void require_healthy(std::size_t joint);
  void read_all_angles();
  void store(std::size_t joint, std::span<const std::uint8_t> block);
  void read_some(std::uint64_t deadline_us);
  void check_watchdog(std::uint64_t deadline_us);
  /// The joint whose servo has this id.
  std::size_t joint_of(std::uint8_t id) const;

  ChainSettings settings_;
  Show show_;
  ServoBus bus_;
  std::vector<std::uint8_t> ids_;
  std::vector<Reading> readings_;
  std::vector<unsigned> missed_;  ///< answers in a row that did not come, by joint
  std::size_t reads_per_tick_ = 1;
  std::size_t next_read_ = 0;      ///< joint with which the next read begins
  std::size_t next_watchdog_ = 0;  ///< joint whose watchdog is read next
  std::uint32_t ticks_ = 0;
  std::uint32_t return_delay_us_ = 0;
  bool is_connected_ = false;
};

}  // namespace proleg::host
