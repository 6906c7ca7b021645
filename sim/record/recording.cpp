#include "sim/record/recording.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <sstream>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/kernel.hpp"
#include "sim/record/recorded_run.hpp"
#include "sim/record/recording_rows.hpp"
#include "sim/record/schema.hpp"

namespace proleg::sim {
namespace {

/// An internal value of an algorithm.
struct ValueName {
  std::string name;
  Unit unit;
};

/// The pose in columns 2 to 8.
Pose pose_of(const Statement& row) {
  return {{finite(row, 2), finite(row, 3), finite(row, 4)},
          {finite(row, 5), finite(row, 6), finite(row, 7), finite(row, 8)}};
}

}  // namespace

class Recording::Tables {
 public:
  explicit Tables(const std::filesystem::path& path) : database(path, SQLITE_OPEN_READONLY) {
    // One read transaction for everything, which does not see what a running recorder adds meanwhile.
    database.execute("BEGIN");
    if (number("PRAGMA application_id") != std::int64_t{recording_application_id}) {
      throw Damage("a database of another program");
    }
    if (const std::int64_t format = number("PRAGMA user_version"); format != std::int64_t{recording_format}) {
      throw Damage("recording format " + std::to_string(format) +
                   ", of another version of this program; this version reads format " +
                   std::to_string(recording_format));
    }
    require_whole_file(database, path);
    // All commands refuse such a file, also those that do not need the sources.
    if (number("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = 'source'") == 0) {
      throw Damage("a recording without the table 'source'");
    }
  }

  [[nodiscard]] std::string run_value(const std::string& key) {
    Statement query(database, "SELECT value FROM run WHERE key = ?1");
    query.bind_all(std::string_view(key));
    return query.step() ? query.text(0) : std::string();
  }

  Database database;

 private:
  std::int64_t number(const char* sql) {
    Statement query(database, sql);
    return query.step() ? query.integer(0) : 0;
  }
};

Recording::Recording(const std::filesystem::path& path) : path_(path) {
  if (const std::optional<std::string> found = found_instead_of_file(path)) {
    throw InputError(path.string(), 0, *found, recording_expected);
  }
  std::error_code error;
  if (std::filesystem::is_empty(path, error)) {  // which SQLite takes for a new database
    throw InputError(path.string(), 0, "an empty file", recording_expected);
  }
  reading(path_, [&] {
    tables_ = std::make_unique<Tables>(path);
    read_run();
    read_robot();
    read_slots();
    sensors_ = read_sensor_tables(tables_->database, links_.size());
  });
}

Recording::~Recording() = default;

void Recording::read_run() {
  finished_ = tables_->run_value("finished") == "1";
  tick_period_us_ = number(tables_->run_value("tick_us"), "tick_us");
  if (tick_period_us_ == 0) {
    throw Damage("a tick of 0 us");
  }
  Statement result(tables_->database, "SELECT name, value FROM result ORDER BY position");
  while (result.step()) {
    results_.emplace_back(result.text(0), result.text(1));
  }
  Statement range(tables_->database, "SELECT (SELECT min(tick) FROM sample), (SELECT max(tick) FROM sample)");
  if (!range.step() || !range.is_integer(0)) {
    throw Damage("no tick (the run ended before the first was written)");
  }
  first_tick_ = natural(range, 0);
  last_tick_ = natural(range, 1);
  if (last_tick_ < first_tick_) {  // in a damaged index
    throw Damage("tick " + std::to_string(last_tick_) + " after tick " + std::to_string(first_tick_));
  }
}

void Recording::read_robot() {
  Statement joint(tables_->database, "SELECT joint, name, file_index, lower_raw, upper_raw FROM joint ORDER BY joint");
  while (joint.step()) {
    if (natural(joint, 0) != joints_.size()) {
      throw Damage("joints that are not numbered from 0");
    }
    joints_.push_back({joint.text(1), natural(joint, 2), raw(joint, 3), raw(joint, 4)});
  }
  Statement link(tables_->database, "SELECT link, name FROM link ORDER BY link");
  while (link.step()) {
    if (natural(link, 0) != links_.size()) {
      throw Damage("links that are not numbered from 0");
    }
    links_.push_back(link.text(1));
  }
  // A recording of an older program of this format has no such table (schema.hpp). One of a real robot has no poses.
  if (Statement(tables_->database, "SELECT 1 FROM sqlite_schema WHERE name = 'object'").step() &&
      Statement(tables_->database, "SELECT 1 FROM object_pose LIMIT 1").step()) {
    Statement object(tables_->database, "SELECT object, name FROM object ORDER BY object");
    while (object.step()) {
      if (natural(object, 0) != objects_.size()) {
        throw Damage("objects that are not numbered from 0");
      }
      objects_.push_back(object.text(1));
    }
  }
  if (joints_.empty() || joints_.size() > max_joints || links_.size() != joints_.size() + 1) {
    throw Damage(std::to_string(joints_.size()) + " joints and " + std::to_string(links_.size()) + " links");
  }
}

void Recording::read_slots() {
  Statement slot(tables_->database, "SELECT slot, algorithm, joint_group FROM slot ORDER BY slot");
  Statement name(tables_->database,
                 "SELECT value_index, name, unit FROM internal_value_name WHERE slot = ?1 ORDER BY value_index");
  while (slot.step()) {
    RecordedSlot read{natural(slot, 0), slot.text(1), {}};
    if (read.slot >= max_slots) {
      throw Damage("slot " + std::to_string(read.slot) + " of " + std::to_string(max_slots));
    }
    for (const char c : slot.text(2)) {
      read.joint_group.push_back(c == '1');
    }
    if (read.joint_group.size() != joints_.size()) {
      throw Damage("a joint group that does not name every joint");
    }
    JointMask group;
    for (std::uint32_t joint = 0; joint < joints_.size(); ++joint) {
      if (read.joint_group[joint]) {
        group.insert(joint);
      }
    }
    std::vector<ValueName> names;
    for (name.bind_all(read.slot); name.step();) {
      if (natural(name, 0) != names.size()) {
        throw Damage("internal values that are not numbered from 0");
      }
      names.push_back({name.text(1), unit_of(name.text(2))});
    }
    for_each_internal_value_of_slot(
        static_cast<unsigned>(joints_.size()), group, static_cast<std::uint32_t>(names.size()),
        [&](unsigned joint, unsigned number) {
          internal_values_.push_back({read.slot, joint, number, names[number].name, names[number].unit});
        });
    slots_.push_back(std::move(read));
  }
}

std::uint8_t Recording::joint_number(const Statement& row, int column) const {
  const std::uint32_t joint = natural(row, column);
  if (joint >= joints_.size()) {
    throw Damage("joint " + std::to_string(joint) + " of " + std::to_string(joints_.size()));
  }
  return static_cast<std::uint8_t>(joint);
}

std::uint32_t Recording::slot_number(const Statement& row, int column) const {
  const std::uint32_t slot = natural(row, column);
  if (std::ranges::find(slots_, slot, &RecordedSlot::slot) == slots_.end()) {
    throw Damage("slot " + std::to_string(slot) + ", which has no algorithm");
  }
  return slot;
}

std::string Recording::run_value(const std::string& key) const {
  return reading(path_, [&] { return tables_->run_value(key); });
}

std::vector<RecordedSetting> Recording::parameters() const {
  return read_settings("SELECT tick, slot, joint, name, unit, raw, origin = 'commit' FROM parameter ORDER BY position");
}

std::vector<RecordedSetting> Recording::distortions() const {
  return read_settings("SELECT tick, slot, joint, name, unit, raw, 1 FROM distortion ORDER BY position");
}

std::vector<RecordedSetting> Recording::read_settings(const char* sql) const {
  return reading(path_, [&] {
    std::vector<RecordedSetting> settings;
    Statement row(tables_->database, sql);
    while (row.step()) {
      settings.push_back({natural(row, 0), row.integer(6) != 0, slot_number(row, 1), joint_number(row, 2), row.text(3),
                          unit_of(row.text(4)), raw(row, 5)});
    }
    return settings;
  });
}

std::vector<RecordedRestart> Recording::restarts() const {
  return reading(path_, [&] {
    std::vector<RecordedRestart> restarts;
    Statement row(tables_->database, "SELECT tick, joint, event = 'joined' FROM restart ORDER BY tick, joint");
    while (row.step()) {
      restarts.push_back({natural(row, 0), joint_number(row, 1), row.integer(2) != 0});
    }
    return restarts;
  });
}

std::vector<RobotMove> Recording::moves() const {
  return reading(path_, [&] {
    std::vector<RobotMove> moves;
    // A recording of an older program of this format has no such table (schema.hpp).
    if (!Statement(tables_->database, "SELECT 1 FROM sqlite_schema WHERE name = 'move'").step()) {
      return moves;
    }
    Statement row(tables_->database, "SELECT tick, x_m, y_m, z_m, turn_deg FROM move ORDER BY tick, position");
    while (row.step()) {
      moves.push_back({natural(row, 0), {finite(row, 1), finite(row, 2), finite(row, 3)}, finite(row, 4)});
    }
    return moves;
  });
}

std::vector<RecordedMotionHash> Recording::motion_hashes() const {
  return reading(path_, [&] {
    std::vector<RecordedMotionHash> hashes;
    // A recording of an older program of this format has no such table (schema.hpp).
    if (!Statement(tables_->database, "SELECT 1 FROM sqlite_schema WHERE name = 'motion_hash'").step()) {
      return hashes;
    }
    Statement row(tables_->database, "SELECT tick, hash FROM motion_hash ORDER BY tick");
    while (row.step()) {
      hashes.push_back({natural(row, 0), row.text(1)});
    }
    return hashes;
  });
}

std::vector<RecordedLosses> Recording::losses_in_parts(std::uint32_t parts) const {
  return reading(path_, [&] {
    std::vector<RecordedLosses> losses;
    Statement row(tables_->database,
                  "SELECT min(tick), count(*) FROM (SELECT tick FROM loss ORDER BY tick LIMIT 1000000) "
                  "GROUP BY (tick - ?1) / ?2 ORDER BY 1");
    const std::uint64_t ticks = std::uint64_t{last_tick_} - first_tick_ + 1;
    row.bind_all(first_tick_, static_cast<std::int64_t>((ticks + parts - 1) / parts));
    while (row.step()) {
      losses.push_back({natural(row, 0), static_cast<std::uint64_t>(row.integer(1))});
    }
    return losses;
  });
}

std::vector<RecordedFault> Recording::faults() const {
  return reading(path_, [&] {
    std::vector<RecordedFault> faults;
    Statement row(
        tables_->database,
        "SELECT start_us, end_us IS NULL, ifnull(end_us, 0), joint IS NULL, ifnull(joint, 0), text FROM fault "
        "ORDER BY start_us, position");
    while (row.step()) {
      RecordedFault& fault = faults.emplace_back();
      fault.start_us = time(row, 0);
      if (row.integer(1) == 0) {
        fault.end_us = time(row, 2);
      }
      if (row.integer(3) == 0) {
        fault.joint = joint_number(row, 4);
      }
      fault.text = row.text(5);
    }
    return faults;
  });
}

std::optional<std::uint32_t> Recording::first_fault_tick() const {
  const std::vector<RecordedFault> all = faults();
  if (all.empty()) {
    return std::nullopt;
  }
  constexpr std::uint64_t max_tick = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::min(all.front().start_us / tick_period_us_, max_tick));
}

std::vector<std::pair<std::string, std::string>> Recording::sources() const {
  return reading(path_, [&] {
    std::vector<std::pair<std::string, std::string>> sources;
    Statement row(tables_->database, "SELECT path, text FROM source ORDER BY position");
    while (row.step()) {
      sources.emplace_back(row.text(0), row.text(1));
    }
    return sources;
  });
}

void Recording::read_ticks(std::uint32_t first, std::uint32_t last,
                           const std::function<void(const RecordedTick&)>& use) const {
  Database& database = tables_->database;
  RecordedTick tick;
  tick.setpoints.resize(joints_.size());
  tick.servo_commands.resize(joints_.size());
  tick.joint_angles.resize(joints_.size());
  tick.motor_torques.resize(joints_.size());
  tick.servo_currents.resize(joints_.size());
  tick.internal_values.resize(internal_values_.size());
  tick.link_poses.resize(links_.size());
  tick.latched_contacts.resize(links_.size());
  tick.contact_forces.resize(links_.size());
  tick.object_poses.resize(objects_.size());

  std::optional<Rows> samples;
  std::optional<Rows> values;
  std::optional<Rows> poses;
  std::optional<Rows> contacts;
  std::optional<Rows> objects;
  std::optional<SensorRows> sensors;
  std::optional<ReadingRows> readings;
  reading(path_, [&] {
    samples.emplace(
        database, "sample",
        "SELECT tick, joint, setpoint_raw, servo_command, angle_rad, motor_torque_nm, servo_current_ma FROM sample "
        "WHERE tick BETWEEN ?1 AND ?2 ORDER BY tick, joint",
        first, last);
    values.emplace(database, "internal_value",
                   "SELECT tick, slot, joint, value_index, raw FROM internal_value "
                   "WHERE tick BETWEEN ?1 AND ?2 ORDER BY tick, slot, joint, value_index",
                   first, last);
    poses.emplace(database, "pose",
                  "SELECT tick, link, x_m, y_m, z_m, qw, qx, qy, qz FROM pose "
                  "WHERE tick BETWEEN ?1 AND ?2 ORDER BY tick, link",
                  first, last);
    contacts.emplace(database, "contact",
                     "SELECT tick, link, rear, front, normal_force_n FROM contact "
                     "WHERE tick BETWEEN ?1 AND ?2 ORDER BY tick, link",
                     first, last);
    if (!objects_.empty()) {
      objects.emplace(database, "object_pose",
                      "SELECT tick, object, x_m, y_m, z_m, qw, qx, qy, qz FROM object_pose "
                      "WHERE tick BETWEEN ?1 AND ?2 ORDER BY tick, object",
                      first, last);
    }
    sensors.emplace(database, sensors_, first, last, tick.sensor_values);
    readings.emplace(database, joints_.size(), first, last, tick.readings);
  });
  for (tick.tick = first; tick.tick <= last; ++tick.tick) {
    reading(path_, [&] {
      for (std::uint32_t joint = 0; joint < joints_.size(); ++joint) {
        const Statement& row = samples->expect(tick.tick, joint);
        tick.setpoints[joint] = raw(row, 2);
        tick.servo_commands[joint] = raw(row, 3);
        tick.joint_angles[joint] = finite(row, 4);
        tick.motor_torques[joint] = finite(row, 5);
        tick.servo_currents[joint] = finite(row, 6);
      }
      for (std::size_t i = 0; i < internal_values_.size(); ++i) {
        const RecordedInternalValue& value = internal_values_[i];
        tick.internal_values[i] = raw(values->expect(tick.tick, value.slot, value.joint, value.number), 4);
      }
      for (std::uint32_t link = 0; link < links_.size(); ++link) {
        tick.link_poses[link] = pose_of(poses->expect(tick.tick, link));
        const Statement& contact = contacts->expect(tick.tick, link);
        tick.latched_contacts[link] =
            static_cast<std::uint8_t>((natural(contact, 2) & 1U) | (natural(contact, 3) & 1U) << 1U);
        tick.contact_forces[link] = finite(contact, 4);
      }
      for (std::uint32_t object = 0; object < objects_.size(); ++object) {
        tick.object_poses[object] = pose_of(objects->expect(tick.tick, object));
      }
      sensors->read(tick.tick, tick.sensor_values);
      readings->read(tick.tick, tick.readings);
    });
    use(tick);
  }
}

ServoPulseReader::ServoPulseReader(const Recording& recording)
    : recording_(recording), row_(reading(recording.path(), [&] {
        return std::make_unique<Statement>(recording.tables_->database,
                                           "SELECT time_us, joint, command FROM servo ORDER BY time_us, joint");
      })) {}

ServoPulseReader::~ServoPulseReader() = default;

std::optional<ServoPulse> ServoPulseReader::next() {
  return reading(recording_.path(), [this]() -> std::optional<ServoPulse> {
    if (!row_->step()) {
      return std::nullopt;
    }
    return ServoPulse{time(*row_, 0), recording_.joint_number(*row_, 1), raw(*row_, 2)};
  });
}

LossReader::LossReader(const Recording& recording)
    : recording_(recording), row_(reading(recording.path(), [&] {
        return std::make_unique<Statement>(recording.tables_->database,
                                           "SELECT tick, sender, channel, receiver FROM loss ORDER BY 1, 2, 3, 4");
      })) {}

LossReader::~LossReader() = default;

std::optional<Loss> LossReader::next() {
  return reading(recording_.path(), [this]() -> std::optional<Loss> {
    if (!row_->step()) {
      return std::nullopt;
    }
    const std::uint32_t channel = natural(*row_, 2);
    if (channel >= max_channels) {
      throw Damage("a loss on channel " + std::to_string(channel));
    }
    return Loss{natural(*row_, 0), recording_.joint_number(*row_, 1), static_cast<std::uint8_t>(channel),
                recording_.joint_number(*row_, 3)};
  });
}

std::string name_of(const MotionDifference& difference, const Recording& recording) {
  return difference.is_object ? "object " + in_quotes(recording.objects()[difference.part])
                              : "link " + in_quotes(recording.links()[difference.part]);
}

std::string remark_on_unfinished_run(const Recording& recording) {
  if (recording.finished()) {
    return {};
  }
  std::ostringstream remark;
  remark << recording.path().string() << ": the run is not finished; the recording has "
         << recording.time_s(recording.last_tick()) << " s";
  return remark.str();
}

}  // namespace proleg::sim
