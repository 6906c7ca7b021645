#pragma once

// The tables of a recording. The file contains the comments inside the SQL: `.schema` in the sqlite3 shell shows them.

#include <cstdint>

namespace proleg::sim {

/// "Prol", SQLite's application id, bytes 68 to 71 of the file: it marks a database as a recording.
inline constexpr std::uint32_t recording_application_id = 0x50726F6C;
/// SQLite's user_version. A new number for every change that a reader of the older format would misread or miss.
inline constexpr std::uint32_t recording_format = 6;

// Choices:
// - STRICT: a value of the wrong type is an error when it is written, not when it is read.
// - WITHOUT ROWID with the natural key: rows are in the order of time, and a search by tick needs no second index.
// - Angles as degrees and pulses as microseconds are generated columns: they take no space and always agree with the
//   raw value.
inline constexpr const char* recording_schema = R"sql(
CREATE TABLE run(
  -- What was run. finished: 1 if the run came to its planned end, 0 if it was interrupted or still goes on.
  key TEXT PRIMARY KEY,
  value TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE result(
  -- Figures of a finished run: displacement, hashes, ...
  position INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  value TEXT NOT NULL
) STRICT;

CREATE TABLE source(
  -- Every file that was read, the top-level file first.
  position INTEGER PRIMARY KEY,
  path TEXT NOT NULL,
  text TEXT NOT NULL
) STRICT;

CREATE TABLE joint(
  -- Joints are counted from the head, from 0; file_index is the place in the robot's file. Set-points stay within
  -- lower_raw and upper_raw (90 degrees = 2^30).
  joint INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  file_index INTEGER NOT NULL,
  lower_raw INTEGER NOT NULL,
  upper_raw INTEGER NOT NULL
) STRICT;

CREATE TABLE link(
  -- Links are counted from the head, from 0; joint j connects links j and j + 1.
  link INTEGER PRIMARY KEY,
  name TEXT NOT NULL
) STRICT;

CREATE TABLE slot(
  -- An actuation module on a group of joints. joint_group: '1' or '0' for each joint, the head's first.
  slot INTEGER PRIMARY KEY,
  algorithm TEXT NOT NULL,
  algorithm_id INTEGER NOT NULL,
  joint_group TEXT NOT NULL
) STRICT;

CREATE TABLE parameter(
  -- origin 'start': value at the start of the run; 'commit': value that took effect at SYNC tick.
  -- value_text: the shortest decimal number, in unit, that means exactly raw.
  position INTEGER PRIMARY KEY,
  tick INTEGER NOT NULL,
  origin TEXT NOT NULL,
  slot INTEGER NOT NULL,
  joint INTEGER NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  raw INTEGER NOT NULL,
  value_text TEXT NOT NULL
) STRICT;

CREATE TABLE distortion(
  -- Internal values that were overwritten before SYNC tick was computed.
  position INTEGER PRIMARY KEY,
  tick INTEGER NOT NULL,
  slot INTEGER NOT NULL,
  joint INTEGER NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  raw INTEGER NOT NULL,
  value_text TEXT NOT NULL
) STRICT;

CREATE TABLE internal_value_name(
  -- What the numbers in internal_value mean: raw * unit_per_step is the value in unit.
  slot INTEGER NOT NULL,
  value_index INTEGER NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  unit_per_step REAL NOT NULL,
  PRIMARY KEY(slot, value_index)
) STRICT, WITHOUT ROWID;

-- In sample, internal_value and pose, tick k is what was computed at SYNC k and holds at SYNC k + 1, which is
-- (k + 1) * tick_us / 1000000 seconds after the start.

CREATE TABLE sample(
  -- setpoint: where the joint is to be at SYNC tick + 1. servo_command: last pulse that the servo took before it (the
  -- table servo has them all), in twelfths of a microsecond. angle: where the joint was. motor_torque, servo_current:
  -- means over the tick before SYNC tick + 1; the current is an estimate.
  tick INTEGER NOT NULL,
  joint INTEGER NOT NULL,
  setpoint_raw INTEGER NOT NULL,
  servo_command INTEGER NOT NULL,
  angle_rad REAL NOT NULL,
  motor_torque_nm REAL NOT NULL,
  servo_current_ma REAL NOT NULL,
  setpoint_deg REAL AS (setpoint_raw * 45.0 / 536870912.0) VIRTUAL,
  servo_us REAL AS (servo_command / 12.0) VIRTUAL,
  angle_deg REAL AS (angle_rad * 57.295779513082323) VIRTUAL,
  PRIMARY KEY(tick, joint)
) STRICT, WITHOUT ROWID;

CREATE TABLE internal_value(
  tick INTEGER NOT NULL,
  slot INTEGER NOT NULL,
  joint INTEGER NOT NULL,
  value_index INTEGER NOT NULL,
  raw INTEGER NOT NULL,
  PRIMARY KEY(tick, slot, joint, value_index)
) STRICT, WITHOUT ROWID;

CREATE TABLE pose(
  -- Of the frame of a link, in the world; the orientation is a unit quaternion.
  tick INTEGER NOT NULL,
  link INTEGER NOT NULL,
  x_m REAL NOT NULL,
  y_m REAL NOT NULL,
  z_m REAL NOT NULL,
  qw REAL NOT NULL,
  qx REAL NOT NULL,
  qy REAL NOT NULL,
  qz REAL NOT NULL,
  PRIMARY KEY(tick, link)
) STRICT, WITHOUT ROWID;

CREATE TABLE object(
  -- Objects of the environment that move, in the order of its files.
  object INTEGER PRIMARY KEY,
  name TEXT NOT NULL
) STRICT;

CREATE TABLE object_pose(
  -- Of the frame of an object that moves, as pose has those of the links. A recording of an older program of this format
  -- has neither of the two tables: nothing but the robot moved.
  tick INTEGER NOT NULL,
  object INTEGER NOT NULL,
  x_m REAL NOT NULL,
  y_m REAL NOT NULL,
  z_m REAL NOT NULL,
  qw REAL NOT NULL,
  qx REAL NOT NULL,
  qy REAL NOT NULL,
  qz REAL NOT NULL,
  PRIMARY KEY(tick, object)
) STRICT, WITHOUT ROWID;

CREATE TABLE motion_hash(
  -- Of a simulated world: SHA-256 over all poses of links and then of objects, of ticks 0 to tick, in the order of pose
  -- and object_pose, eight bytes a number. A row where a second of the run ends, and one at its end. The same program
  -- gives the same on the same processor (both in the table run). A recording of an older program of this format has
  -- no such table.
  tick INTEGER PRIMARY KEY,
  hash TEXT NOT NULL
) STRICT;

CREATE TABLE contact(
  -- Touch sensors under a link as the modules were given them at SYNC tick, tick * tick_us / 1000000 seconds after the
  -- start: the state frames labelled tick + 1 say the same. rear is nearer to the tail, front nearer to the head.
  -- normal_force: of all contact points of the link, mean over the tick that begins at SYNC tick.
  tick INTEGER NOT NULL,
  link INTEGER NOT NULL,
  rear INTEGER NOT NULL,
  front INTEGER NOT NULL,
  normal_force_n REAL NOT NULL,
  PRIMARY KEY(tick, link)
) STRICT, WITHOUT ROWID;

CREATE TABLE loss(
  -- State frames that did not reach a joint: the frame of state tick, from sender (its channel 0 or 1), was kept from
  -- receiver when SYNC tick was computed.
  tick INTEGER NOT NULL,
  sender INTEGER NOT NULL,
  channel INTEGER NOT NULL,
  receiver INTEGER NOT NULL,
  PRIMARY KEY(tick, sender, channel, receiver)
) STRICT, WITHOUT ROWID;

CREATE TABLE restart(
  -- event 'stopped': from SYNC tick on the module of the joint computes nothing; 'joined': it computes again, from a
  -- state that it took from its neighbours. In between its row in sample repeats the last set-point.
  tick INTEGER NOT NULL,
  joint INTEGER NOT NULL,
  event TEXT NOT NULL,
  PRIMARY KEY(tick, joint)
) STRICT, WITHOUT ROWID;

CREATE TABLE fault(
  -- What was made to fail (docs/faults.md), in microseconds after SYNC 0. end_us: null if it lasts to the end of the
  -- run, or happens once. joint: whose module it befalls; null for the whole robot. text: as in a fault schedule. From
  -- the first fault on the gait in memory is no oracle: replay compares the ticks before it.
  position INTEGER PRIMARY KEY,
  start_us INTEGER NOT NULL,
  end_us INTEGER,
  joint INTEGER,
  text TEXT NOT NULL
) STRICT;

CREATE TABLE module_event(
  -- What modules did in a run with faults: states of their servos, and their messages.
  position INTEGER PRIMARY KEY,
  time_us INTEGER NOT NULL,
  joint INTEGER NOT NULL,
  text TEXT NOT NULL
) STRICT;

CREATE TABLE move(
  -- The robot was put elsewhere by hand before SYNC tick: as a rigid body, turned to the left by turn_deg about the
  -- vertical through the head's frame, which came to x_m, y_m, z_m (higher if it would have been in the ground), and at
  -- rest. A recording of an older program of this format has no such table: nothing was moved.
  position INTEGER PRIMARY KEY,
  tick INTEGER NOT NULL,
  x_m REAL NOT NULL,
  y_m REAL NOT NULL,
  z_m REAL NOT NULL,
  turn_deg REAL NOT NULL
) STRICT;

CREATE TABLE reading(
  -- What algorithms were given of the sensors of their joint's module at SYNC tick: servo current, pitch and roll of the
  -- link behind the joint (90 degrees = 2^30), its acceleration less gravity, in its axes, angle of the joint (90 degrees =
  -- 2^30). present: the sum of 1 (current), 2 (pitch and roll), 4 (acceleration), 8 (angle); what is not present is 0. A
  -- joint without present sensors has no row. A recording of an older program of this format has no such table, or one
  -- without angle_raw.
  tick INTEGER NOT NULL,
  joint INTEGER NOT NULL,
  present INTEGER NOT NULL,
  current_ma INTEGER NOT NULL,
  pitch_raw INTEGER NOT NULL,
  roll_raw INTEGER NOT NULL,
  acceleration_x_mm_s2 INTEGER NOT NULL,
  acceleration_y_mm_s2 INTEGER NOT NULL,
  acceleration_z_mm_s2 INTEGER NOT NULL,
  angle_raw INTEGER NOT NULL,
  PRIMARY KEY(tick, joint)
) STRICT, WITHOUT ROWID;

CREATE TABLE sensor(
  -- Sensors that the robot's file attaches, in its order. part: the link, of a ServoCurrent the joint; from the head. A
  -- recording of an older program of this format has none of the tables whose names begin with sensor: no sensors.
  sensor INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  type TEXT NOT NULL,
  part INTEGER NOT NULL
) STRICT;

CREATE TABLE sensor_channel(
  -- The numbers that a sensor gives. unit: empty for numbers without.
  sensor INTEGER NOT NULL,
  channel INTEGER NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  PRIMARY KEY(sensor, channel)
) STRICT, WITHOUT ROWID;

CREATE TABLE sensor_value(
  -- What a sensor measured at SYNC tick + 1. A laser has rows only for ticks with a scan; until the next its values hold.
  tick INTEGER NOT NULL,
  sensor INTEGER NOT NULL,
  channel INTEGER NOT NULL,
  value REAL NOT NULL,
  PRIMARY KEY(tick, sensor, channel)
) STRICT, WITHOUT ROWID;

CREATE TABLE servo(
  -- Every pulse for a servo, in twelfths of a microsecond, and when its interval starts: microseconds after SYNC 0.
  time_us INTEGER NOT NULL,
  joint INTEGER NOT NULL,
  command INTEGER NOT NULL,
  PRIMARY KEY(time_us, joint)
) STRICT, WITHOUT ROWID;

CREATE VIEW sample_by_name AS
  SELECT tick, (tick + 1) * (SELECT value FROM run WHERE key = 'tick_us') / 1e6 AS time_s, joint.name AS joint,
         setpoint_deg, servo_us, angle_deg, motor_torque_nm, servo_current_ma
  FROM sample JOIN joint USING (joint);

CREATE VIEW internal_value_by_name AS
  SELECT tick, (tick + 1) * (SELECT value FROM run WHERE key = 'tick_us') / 1e6 AS time_s, slot, joint.name AS joint,
         internal_value_name.name AS name, raw * unit_per_step AS value, unit
  FROM internal_value JOIN joint USING (joint) JOIN internal_value_name USING (slot, value_index);

CREATE VIEW sensor_value_by_name AS
  SELECT tick, (tick + 1) * (SELECT value FROM run WHERE key = 'tick_us') / 1e6 AS time_s, sensor.name AS sensor,
         sensor_channel.name AS channel, value, unit
  FROM sensor_value JOIN sensor USING (sensor) JOIN sensor_channel USING (sensor, channel);
)sql";

}  // namespace proleg::sim
