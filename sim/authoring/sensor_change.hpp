#pragma once

// Changes of the sensors that a robot of a draft carries.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "sim/robot/attached_sensor.hpp"
#include "sim/robot/pose.hpp"

namespace proleg::sim {

/// Where on a link a new sensor comes: on a side of the box around the link.
enum class SensorPlace : std::uint8_t { front, rear, left, right, above, below };

/// The names of the places, in the order of SensorPlace.
[[nodiscard]] const std::vector<std::string_view>& sensor_places();

/// sensor: position in RobotContents::sensors. Throws InputError for one that does not exist; the reader judges the
/// values.
class SensorChange {
 public:
  /// scenario, robot: of the draft, before the change.
  SensorChange(const Scenario& scenario, const RobotContents& robot, DraftChange& change)
      : scenario_(scenario), robot_(robot), change_(change) {}

  /// Adds a sensor. part: of the link, or of the joint for a servo_current; kernel order. A touch sensor covers the
  /// side; a laser looks away from it.
  void add(SensorKind kind, std::size_t part, SensorPlace place);
  void remove(std::size_t sensor);
  void rename(std::size_t sensor, const std::string& name);
  /// In the frame of the link.
  void place(std::size_t sensor, const Pose& pose);
  /// The sensor goes to another link, or joint.
  void set_part(std::size_t sensor, std::size_t part);
  /// Sets a tag of <sensor>, such as "maxrange"; an empty text removes it.
  void set_property(std::size_t sensor, std::string_view tag, const std::string& content);

 private:
  [[nodiscard]] const XmlText& xml() { return change_.xml(robot_.file); }
  [[nodiscard]] const SensorContents& at(std::size_t sensor) const;
  [[nodiscard]] const std::string& part_name(SensorKind kind, std::size_t part) const;

  const Scenario& scenario_;
  const RobotContents& robot_;
  DraftChange& change_;
};

}  // namespace proleg::sim
