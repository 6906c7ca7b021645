#include "sim/record/recorder.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/record/motion.hpp"
#include "sim/record/recorded_run.hpp"
#include "sim/record/recording_file.hpp"
#include "sim/record/run_tables.hpp"
#include "sim/record/schema.hpp"

namespace proleg::sim {
namespace {

// Half of the second that may be lost, so that a commit may be a little late.
constexpr std::chrono::milliseconds commit_interval{500};

/// An empty file that gets the tables of a recording, in a transaction that remains open.
class NewRecording : public Database {
 public:
  explicit NewRecording(const std::filesystem::path& path) : Database(path, SQLITE_OPEN_READWRITE) {
    // Nothing can be lost yet, so nothing needs a flush or a journal. This goes into the main file, not into the
    // write-ahead log, so that the file is a recording from its first moment.
    execute("PRAGMA journal_mode = MEMORY; PRAGMA synchronous = OFF; BEGIN IMMEDIATE");
    const std::string identity = "PRAGMA application_id = " + std::to_string(recording_application_id) +
                                 "; PRAGMA user_version = " + std::to_string(recording_format);
    execute(identity.c_str());
    execute(recording_schema);
  }
};

bool is_finite(const Pose& pose) { return pose.position.allFinite() && pose.orientation.coeffs().allFinite(); }

}  // namespace

class Recorder::Storage {
 public:
  Storage(const std::filesystem::path& path, const Scenario& scenario, const std::string& program,
          const std::string& build_id)
      : path_(path), scenario_(scenario), database_(path) {
    write_run_tables(database_, scenario_, program, build_id);
    for_each_internal_value(scenario_.kernel, [this](unsigned slot, unsigned joint, unsigned number) {
      internal_values_.push_back({slot, joint, number});
    });
    for (const AttachedSensor& sensor : scenario_.robot.sensors) {
      sensor_channels_.push_back(static_cast<std::uint32_t>(channels_of(sensor).size()));
    }
    database_.execute("COMMIT");
    // With a write-ahead log a reader never blocks the recorder, and a killed process leaves whole transactions.
    // synchronous = NORMAL flushes at checkpoints only: data that the system has survives the end of the process. A
    // power failure may cost the latest transactions but never the file.
    database_.execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL");
    database_.require_own_file();
    database_.execute("BEGIN IMMEDIATE");
  }

  ~Storage() {
    if (closed_ || !failure_.empty()) {
      return;
    }
    try {
      close();
    } catch (const SqliteError& error) {
      std::fprintf(stderr, "%s: the end of the recording is lost: %s\n", path_.c_str(), error.what());
    }
  }

  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;

  void write_change(const Change& change) {
    for (const Setting& setting : change.settings) {
      if (setting.internal) {
        write_distortion(change.tick, setting);
      } else {
        parameters_.add(change.tick, "commit", setting.slot, setting.joint, setting.number, setting.value);
      }
    }
  }

  void write_restart(std::uint32_t tick, std::uint32_t joint, bool joined) {
    insert_restart_.run(tick, joint, std::string_view(joined ? "joined" : "stopped"));
  }

  void write_faults(std::span<const RecordedFault> faults) {
    Statement with_end(database_, "INSERT INTO fault(start_us, text, end_us) VALUES(?1, ?2, ?3)");
    Statement without_end(database_, "INSERT INTO fault(start_us, text) VALUES(?1, ?2)");
    Statement at_joint(database_, "UPDATE fault SET joint = ?1 WHERE position = (SELECT max(position) FROM fault)");
    for (const RecordedFault& fault : faults) {
      if (fault.end_us) {
        with_end.run(fault.start_us, std::string_view(fault.text), *fault.end_us);
      } else {
        without_end.run(fault.start_us, std::string_view(fault.text));
      }
      if (fault.joint) {
        at_joint.run(*fault.joint);
      }
    }
  }

  void write_module_event(std::uint64_t time_us, std::uint32_t joint, const std::string& text) {
    insert_event_.run(time_us, joint, std::string_view(text));
  }

  void write_tick(const TickSample& sample) {
    require_finite(sample);
    const std::uint32_t tick = sample.tick;
    for (std::uint32_t joint = 0; joint < scenario_.robot.joints.size(); ++joint) {
      insert_sample_.run(tick, joint, sample.setpoints[joint], sample.servo_commands[joint], sample.joint_angles[joint],
                         sample.motor_torques[joint], sample.servo_currents[joint]);
    }
    for (std::size_t i = 0; i < internal_values_.size(); ++i) {
      const InternalValueKey& key = internal_values_[i];
      insert_value_.run(tick, key.slot, key.joint, key.index, sample.internal_values[i]);
    }
    for (const Loss& loss : sample.lost) {
      insert_loss_.run(loss.tick, std::uint32_t{loss.sender}, std::uint32_t{loss.channel},
                       std::uint32_t{loss.receiver});
    }
    for (const RobotMove& move : sample.moves) {
      const Eigen::Vector3d& position = move.position;
      insert_move_.run(move.tick, position.x(), position.y(), position.z(), move.turn_deg);
    }
    for (const ServoPulse& pulse : sample.servo_pulses) {
      insert_pulse_.run(pulse.time_us, pulse.joint, pulse.command);
    }
    for (std::uint32_t link = 0; link < scenario_.robot.links.size(); ++link) {
      const Eigen::Vector3d& position = sample.link_poses[link].position;
      const Eigen::Quaterniond& turn = sample.link_poses[link].orientation;
      insert_pose_.run(tick, link, position.x(), position.y(), position.z(), turn.w(), turn.x(), turn.y(), turn.z());
      const std::uint32_t contacts = sample.latched_contacts[link];
      insert_contact_.run(tick, link, contacts & 1U, (contacts >> 1U) & 1U, sample.contact_forces[link]);
    }
    for (std::uint32_t object = 0; object < sample.object_poses.size(); ++object) {
      const Eigen::Vector3d& position = sample.object_poses[object].position;
      const Eigen::Quaterniond& turn = sample.object_poses[object].orientation;
      insert_object_pose_.run(tick, object, position.x(), position.y(), position.z(), turn.w(), turn.x(), turn.y(),
                              turn.z());
    }
    for (std::uint32_t joint = 0; joint < sample.readings.size(); ++joint) {
      const JointReadings& read = sample.readings[joint];
      if (read.present != 0) {
        insert_reading_.run(tick, joint, std::uint32_t{read.present}, read.current_ma, read.pitch, read.roll,
                            read.acceleration_mm_s2[0], read.acceleration_mm_s2[1], read.acceleration_mm_s2[2],
                            read.angle);
      }
    }
    write_sensors(sample);
    if (sample.has_world) {
      add_motion(sample);
    }
    commit_if_due();
  }

  void finish(const std::vector<std::pair<std::string, std::string>>& summary) {
    if (last_unhashed_) {
      write_motion_hash(*last_unhashed_);
    }
    Statement result(database_, "INSERT INTO result(name, value) VALUES(?1, ?2)");
    for (const auto& [name, value] : summary) {
      result.run(std::string_view(name), std::string_view(value));
    }
    Statement(database_, "UPDATE run SET value = '1' WHERE key = 'finished'").run();
    close();
  }

  /// Runs an action on the file. At an error SQLite may roll back the open transaction. The recording then has a gap,
  /// so all further actions fail with the same message.
  template <typename Action>
  void guard(const Action& action) {
    if (closed_) {
      throw FileError(path_, "the recording is already finished");
    }
    if (failure_.empty()) {
      try {
        action();
        return;
      } catch (const SqliteError& error) {
        failure_ = error.what();
      }
    }
    throw FileError(path_, "recording stopped: " + failure_);
  }

 private:
  struct InternalValueKey {
    std::uint32_t slot;
    std::uint32_t joint;
    std::uint32_t index;
  };

  void add_motion(const TickSample& sample) {
    motion_hash_.append(sample.link_poses, sample.object_poses);
    last_unhashed_ = sample.tick;
    if (ends_second(sample.tick, scenario_.kernel.tick_period_us)) {
      write_motion_hash(sample.tick);
    }
  }

  void write_motion_hash(std::uint32_t tick) {
    insert_motion_.run(tick, std::string_view(motion_hash_.hex()));
    last_unhashed_.reset();
  }

  void write_sensors(const TickSample& sample) {
    std::size_t position = 0;
    for (std::uint32_t sensor = 0; sensor < sample.measured_sensors.size(); ++sensor) {
      for (std::uint32_t channel = 0; channel < sensor_channels_[sensor]; ++channel, ++position) {
        if (sample.measured_sensors[sensor] != 0) {
          insert_sensor_value_.run(sample.tick, sensor, channel, sample.sensor_values[position]);
        }
      }
    }
  }

  void write_distortion(std::uint32_t tick, const Setting& setting) {
    const InternalValue& value =
        scenario_.kernel.slots[setting.slot].algorithm->declaration().internal_values[setting.number];
    insert_distortion_.run(tick, std::uint32_t{setting.slot}, std::uint32_t{setting.joint}, value.name,
                           std::string_view(scale_of(value.unit).symbol), setting.value,
                           format_decimal(setting.value, value.unit).view());
  }

  void require_finite(const TickSample& sample) const {
    const bool finite = std::all_of(sample.joint_angles.begin(), sample.joint_angles.end(),
                                    [](double x) { return std::isfinite(x); }) &&
                        std::all_of(sample.link_poses.begin(), sample.link_poses.end(), is_finite) &&
                        std::all_of(sample.object_poses.begin(), sample.object_poses.end(), is_finite);
    if (!finite) {
      throw FileError(path_, "at tick " + std::to_string(sample.tick) +
                                 " a pose or joint angle is not a finite number: the simulation has become unstable");
    }
  }

  void commit_if_due() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_commit_ >= commit_interval) {
      database_.execute("COMMIT");
      database_.require_own_file();
      database_.execute("BEGIN IMMEDIATE");
      last_commit_ = now;
    }
  }

  void close() {
    database_.execute("COMMIT");
    closed_ = true;
    database_.require_own_file();
    try {
      // Merges the log into the file and removes it, so that the recording is one file, which opens even in a folder
      // without write permission.
      database_.execute("PRAGMA journal_mode = DELETE");
    } catch (const SqliteError& error) {
      // A program is reading at this moment. Everything is written and remains valid as file and log; the next program
      // that can write there merges them.
      if (error.code() != SQLITE_BUSY) {
        throw;
      }
    }
  }

  std::filesystem::path path_;
  const Scenario& scenario_;
  std::vector<InternalValueKey> internal_values_;  ///< what TickSample::internal_values holds
  std::vector<std::uint32_t> sensor_channels_;     ///< number, by sensor
  NewRecording database_;
  ParameterTable parameters_{database_, scenario_};
  Statement insert_distortion_{database_,
                               "INSERT INTO distortion(tick, slot, joint, name, unit, raw, value_text) "
                               "VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)"};
  Statement insert_sample_{database_, "INSERT INTO sample VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)"};
  Statement insert_value_{database_, "INSERT INTO internal_value VALUES(?1, ?2, ?3, ?4, ?5)"};
  Statement insert_pulse_{database_, "INSERT INTO servo VALUES(?1, ?2, ?3)"};
  Statement insert_pose_{database_, "INSERT INTO pose VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)"};
  Statement insert_object_pose_{database_, "INSERT INTO object_pose VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)"};
  Statement insert_contact_{database_, "INSERT INTO contact VALUES(?1, ?2, ?3, ?4, ?5)"};
  Statement insert_move_{database_, "INSERT INTO move(tick, x_m, y_m, z_m, turn_deg) VALUES(?1, ?2, ?3, ?4, ?5)"};
  Statement insert_reading_{database_, "INSERT INTO reading VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)"};
  Statement insert_sensor_value_{database_, "INSERT INTO sensor_value VALUES(?1, ?2, ?3, ?4)"};
  Statement insert_loss_{database_, "INSERT INTO loss VALUES(?1, ?2, ?3, ?4)"};
  Statement insert_restart_{database_, "INSERT INTO restart VALUES(?1, ?2, ?3)"};
  Statement insert_event_{database_, "INSERT INTO module_event(time_us, joint, text) VALUES(?1, ?2, ?3)"};
  Statement insert_motion_{database_, "INSERT INTO motion_hash VALUES(?1, ?2)"};
  MotionHash motion_hash_;
  std::optional<std::uint32_t> last_unhashed_;  ///< the last tick with a world, if the table has no hash until it
  bool closed_ = false;
  std::string failure_;  ///< the first error; empty without one
  std::chrono::steady_clock::time_point last_commit_ = std::chrono::steady_clock::now();
};

Recorder::Recorder(const std::filesystem::path& path, const Scenario& scenario, const std::string& program,
                   const std::string& build_id, EarlierFile earlier)
    : claim_(std::make_unique<RecordingClaim>(path, earlier)) {
  try {
    storage_ = std::make_unique<Storage>(path, scenario, program, build_id);
  } catch (const SqliteError& error) {
    std::error_code ignored;  // the error that is reported is the first
    std::filesystem::remove(path, ignored);
    throw FileError(path, std::string("cannot be written: ") + error.what());
  }
}

Recorder::~Recorder() = default;

void Recorder::record_change(const Change& change) {
  storage_->guard([&] { storage_->write_change(change); });
}

void Recorder::record_restart(std::uint32_t tick, std::uint32_t joint, bool joined) {
  storage_->guard([&] { storage_->write_restart(tick, joint, joined); });
}

void Recorder::record_faults(std::span<const RecordedFault> faults) {
  storage_->guard([&] { storage_->write_faults(faults); });
}

void Recorder::record_module_event(std::uint64_t time_us, std::uint32_t joint, const std::string& text) {
  storage_->guard([&] { storage_->write_module_event(time_us, joint, text); });
}

void Recorder::record_tick(const TickSample& sample) {
  storage_->guard([&] { storage_->write_tick(sample); });
}

void Recorder::finish(const std::vector<std::pair<std::string, std::string>>& summary) {
  storage_->guard([&] { storage_->finish(summary); });
}

}  // namespace proleg::sim
