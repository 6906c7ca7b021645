#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/dynamixel/chain_settings.hpp"
#include "host/dynamixel/servo_bus.hpp"
#include "host/dynamixel/standstill.hpp"

namespace proleg::host {

/// The servos of a robot in the order of its joints. The class has no clock of its own: it uses that of the line.
class ServoChain {
 public:
  using Show = std::function<void(const std::string&)>;

  /// line: must outlive the chain. show: receives what the user should know, one line each.
  ServoChain(Line& line, ChainSettings settings, Show show);

  // All functions end by the deadline, a time of the line's clock. They throw ServoError and LineError.
  /// Finds all servos, switches their power off, prepares them and reads their angles. Nothing is written before each
  /// id has been answered once. Measures how long answers take, and throws if that is too long for a tick.
  void connect(std::uint64_t deadline_us);
  /// Switches the power on: the goal of each servo is its position, or the nearest limit of its joint. From now on the
  /// servos stop by themselves if nothing is sent for the time of the watchdog.
  void switch_on(std::uint64_t deadline_us);
  /// Switches the power off; also that of the other servos if one does not answer.
  void switch_off(std::uint64_t deadline_us);
  /// Sends joint angles in degrees, then reads as many servos as the rest of the tick allows, in turn: mostly angles,
  /// and in each fourth tick the state that a servo loses if it restarts or if another program writes to it. If a servo
  /// has failed, it sends the angles nevertheless and throws. Shows a joint that stands still and a low voltage.
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
  /// Reads an item; the joint is named if that fails.
  std::vector<std::uint8_t> read(std::size_t joint, TableItem item);
  void find_all();
  void take_power(std::size_t joint);
  void choose_reads_per_tick();
  std::uint64_t measure_read(std::size_t count);
  void prepare(std::size_t joint);
  void prepare_modes(std::size_t joint);
  void check_position_limits(std::size_t joint);
  void require_healthy(std::size_t joint);
  void require_healthy(std::size_t joint, std::uint8_t hardware_error) const;
  void read_all_angles();

  /// What is read in a tick.
  struct TickRead {
    TableItem item;
    void (ServoChain::*take)(std::size_t joint, std::span<const std::uint8_t> bytes);  ///< takes the answer
    std::size_t order = 0;                                                             ///< index in next_joints_
  };
  TickRead next_tick_read();
  void read_some(std::uint64_t deadline_us);
  void count_answer(std::size_t joint);
  void require_answers(std::size_t joint) const;
  void store(std::size_t joint, std::span<const std::uint8_t> block);
  void require_one_turn(std::size_t joint, std::int32_t position);
  void check_voltage(std::size_t joint, std::uint32_t voltage);
  void check_movement(std::size_t joint, std::int32_t position);
  void check_torque(std::size_t joint, std::span<const std::uint8_t> block);
  void check_watchdog(std::size_t joint, std::span<const std::uint8_t> value);
  void check_modes(std::size_t joint, std::span<const std::uint8_t> block);
  /// The joint whose servo has this id.
  std::size_t joint_of(std::uint8_t id) const;

  ChainSettings settings_;
  Show show_;
  ServoBus bus_;
  std::vector<std::uint8_t> ids_;
  std::vector<Reading> readings_;
  /// What is known of a joint's servo from one tick to the next.
  struct Watched {
    unsigned missed = 0;               ///< answers in a row that did not come in time
    ServoBus::UselessAnswers useless;  ///< before the last answer that came in time
    std::uint32_t damaged = 0;         ///< damaged answers of all servos before it
    std::uint32_t min_voltage = 0;     ///< 0.1 V; 0: not checked
    std::int32_t goal = 0;             ///< steps
    Standstill standstill;
  };
  std::vector<Watched> watched_;
  std::size_t reads_per_tick_ = 1;
  std::array<std::size_t, 5> next_joints_{};  ///< joint with which the next read of each kind begins
  std::uint32_t ticks_ = 0;
  std::uint32_t return_delay_us_ = 0;
  bool is_connected_ = false;
  bool has_power_ = false;  ///< the servos have had torque since switch_on()
};

}  // namespace proleg::host
