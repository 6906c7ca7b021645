#include "sim/record/recorder.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/record/internal_values.hpp"
#include "sim/record/recording_file.hpp"
#include "sim/record/schema.hpp"

namespace proleg::sim {
namespace {

// Half of the second that may be lost, so that a commit that comes a little late is still in time.
constexpr std::chrono::milliseconds commit_interval{500};

/// The empty file, now with the tables of a recording, in a transaction that is still open.
class NewRecording : public Database {
 public:
  explicit NewRecording(const std::filesystem::path& path) : Database(path, SQLITE_OPEN_READWRITE) {
    // Nothing can be lost yet, so nothing is flushed or journalled. All this goes to the main file, not to the
    // write-ahead log, so that from the first moment the file says what it is.
    execute("PRAGMA journal_mode = MEMORY; PRAGMA synchronous = OFF; BEGIN IMMEDIATE");
    const std::string identity = "PRAGMA application_id = " + std::to_string(recording_application_id) +
                                 "; PRAGMA user_version = " + std::to_string(recording_format);
    execute(identity.c_str());
    execute(recording_schema);
  }
};

std::string_view solver_name(Solver solver) {
  switch (solver) {
    case Solver::automatic:
      return "automatic";
    case Solver::direct:
      return "direct";
    case Solver::iterative:
      break;
  }
  return "iterative";
}

/// Shortest text that reads back as the same number.
std::string shortest(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

bool is_finite(const Pose& pose) { return pose.position.allFinite() && pose.orientation.coeffs().allFinite(); }

}  // namespace

class Recorder::Storage {
 public:
  Storage(const std::filesystem::path& path, const Scenario& scenario, const std::string& program,
          const std::string& build_id)
      : path_(path), scenario_(scenario), database_(path) {
    write_run(program, build_id);
    write_robot();
    write_slots();
    database_.execute("COMMIT");
    // Write-ahead log, because a reader then never makes the recorder wait or fail, and a killed process leaves whole
    // transactions. synchronous = NORMAL flushes at checkpoints only: what the system holds survives the death of a
    // process, and a power failure may cost the latest transactions but never the file.
    database_.execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE");
  }

  ~Storage() {
    if (closed_ || failed_) {
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
        write_parameter(change.tick, "commit", setting.slot, setting.joint, setting.index, setting.value);
      }
    }
  }

  void write_restart(std::uint32_t tick, std::uint32_t joint, bool joined) {
    insert_restart_.run(tick, joint, std::string_view(joined ? "joined" : "stopped"));
  }

  void write_tick(const TickSample& sample) {
    require_finite(sample);
    const std::uint32_t tick = sample.tick;
    for (std::uint32_t joint = 0; joint < scenario_.robot.joints.size(); ++joint) {
      insert_sample_.run(tick, joint, sample.setpoints[joint], sample.servo_commands[joint],
                         sample.joint_angles[joint]);
    }
    for (std::size_t i = 0; i < internal_values_.size(); ++i) {
      const InternalValuePlace& place = internal_values_[i];
      insert_value_.run(tick, place.slot, place.joint, place.index, sample.internal_values[i]);
    }
    for (const Loss& loss : sample.lost) {
      insert_loss_.run(loss.tick, std::uint32_t{loss.sender}, std::uint32_t{loss.channel},
                       std::uint32_t{loss.receiver});
    }
    for (const ServoPulse& pulse : sample.servo_pulses) {
      insert_pulse_.run(pulse.time_us, pulse.joint, pulse.command);
    }
    for (std::uint32_t link = 0; link < scenario_.robot.links.size(); ++link) {
      const Eigen::Vector3d& position = sample.link_poses[link].position;
      const Eigen::Quaterniond& turn = sample.link_poses[link].orientation;
      insert_pose_.run(tick, link, position.x(), position.y(), position.z(), turn.w(), turn.x(), turn.y(), turn.z());
      const std::uint32_t contacts = sample.latched_contacts[link];
      insert_contact_.run(tick, link, contacts & 1U, (contacts >> 1U) & 1U);
    }
    commit_if_due();
  }

  void finish(const std::vector<std::pair<std::string, std::string>>& summary) {
    Statement result(database_, "INSERT INTO result(name, value) VALUES(?1, ?2)");
    for (const auto& [name, value] : summary) {
      result.run(std::string_view(name), std::string_view(value));
    }
    Statement(database_, "UPDATE run SET value = '1' WHERE key = 'finished'").run();
    close();
  }

  /// Does something with the file. SQLite may roll back the open transaction at an error, so that after one the
  /// recording has a gap: then all further requests fail, too.
  template <typename Action>
  void guard(const Action& action) {
    if (closed_ || failed_) {
      throw FileError(path_, closed_ ? "the recording is finished" : "recording stopped at an earlier error");
    }
    try {
      action();
    } catch (const SqliteError& error) {
      failed_ = true;
      throw FileError(path_, std::string("recording stopped: ") + error.what());
    }
  }

 private:
  struct InternalValuePlace {
    std::uint32_t slot;
    std::uint32_t joint;
    std::uint32_t index;
  };

  void write_run(const std::string& program, const std::string& build_id) {
    Statement insert(database_, "INSERT INTO run VALUES(?1, ?2)");
    const auto put = [&insert](std::string_view key, std::string_view value) { insert.run(key, value); };
    put("format", std::to_string(recording_format));
    put("program", program);
    put("build_id", build_id);
    std::array<char, 11> fingerprint{};
    std::snprintf(fingerprint.data(), fingerprint.size(), "0x%08X", core_fingerprint);
    put("core_fingerprint", fingerprint.data());
    put("scenario", scenario_.path);
    put("robot", scenario_.robot.name);
    put("joint_count", std::to_string(scenario_.robot.joints.size()));
    put("seed", std::to_string(scenario_.kernel.seed));
    put("tick_us", std::to_string(scenario_.kernel.tick_period_us));
    put("step_s", shortest(scenario_.step_s));
    put("solver", solver_name(scenario_.solver));
    put("planned_duration_s", shortest(scenario_.duration_s));
    put("servo_period_us", std::to_string(scenario_.robot.servo.period_us));
    put("servo_gain_per_s", shortest(scenario_.robot.servo.gain));
    put("finished", "0");

    Statement source(database_, "INSERT INTO source(path, text) VALUES(?1, ?2)");
    for (const SourceFile& file : scenario_.sources) {
      source.run(std::string_view(file.path), std::string_view(file.text));
    }
  }

  void write_robot() {
    Statement joint(database_, "INSERT INTO joint VALUES(?1, ?2, ?3, ?4, ?5)");
    for (std::size_t i = 0; i < scenario_.robot.joints.size(); ++i) {
      const JointLimits& limits = scenario_.joint_limits[i];
      joint.run(i, std::string_view(scenario_.robot.joints[i].name), scenario_.robot.joints[i].file_index, limits.lower,
                limits.upper);
    }
    Statement link(database_, "INSERT INTO link VALUES(?1, ?2)");
    for (std::size_t i = 0; i < scenario_.robot.links.size(); ++i) {
      link.run(i, std::string_view(scenario_.robot.links[i].name));
    }
  }

  void write_slots() {
    Statement insert_slot(database_, "INSERT INTO slot VALUES(?1, ?2, ?3, ?4)");
    Statement insert_name(database_, "INSERT INTO internal_value_name VALUES(?1, ?2, ?3, ?4, ?5)");
    for (std::uint32_t slot = 0; slot < max_slots; ++slot) {
      const Slot& place = scenario_.kernel.slots[slot];
      if (place.algorithm == nullptr) {
        continue;
      }
      const Declaration& declaration = place.algorithm->declaration();
      std::string group;
      for (unsigned joint = 0; joint < scenario_.kernel.joint_count; ++joint) {
        group += place.group.contains(joint) ? '1' : '0';
      }
      insert_slot.run(slot, declaration.name, std::uint32_t{declaration.id}, std::string_view(group));
      for (std::size_t i = 0; i < declaration.internal_values.size(); ++i) {
        const InternalValue& value = declaration.internal_values[i];
        const UnitScale scale = scale_of(value.unit);
        insert_name.run(slot, i, value.name, std::string_view(scale.symbol),
                        static_cast<double>(scale.denominator) / static_cast<double>(scale.numerator));
      }
      write_start_parameters(slot);
    }
    for_each_internal_value(scenario_.kernel, [this](unsigned slot, unsigned joint, unsigned number) {
      internal_values_.push_back({slot, joint, number});
    });
  }

  void write_start_parameters(std::uint32_t slot) {
    const Slot& place = scenario_.kernel.slots[slot];
    const std::span<const Parameter> parameters = place.algorithm->declaration().parameters;
    for (std::uint32_t joint = 0; joint < scenario_.kernel.joint_count; ++joint) {
      if (!place.group.contains(joint)) {
        continue;
      }
      for (std::uint32_t i = 0; i < parameters.size(); ++i) {
        std::int32_t value = parameters[i].default_value;
        for (const Setting& setting : scenario_.settings) {
          if (setting.slot == slot && setting.joint == joint && setting.index == i) {
            value = setting.value;
          }
        }
        write_parameter(0, "start", slot, joint, i, value);
      }
    }
  }

  void write_parameter(std::uint32_t tick, std::string_view origin, std::uint32_t slot, std::uint32_t joint,
                       std::uint32_t index, std::int32_t value) {
    const Parameter& parameter = scenario_.kernel.slots[slot].algorithm->declaration().parameters[index];
    insert_parameter_.run(tick, origin, slot, joint, parameter.name, std::string_view(scale_of(parameter.unit).symbol),
                          value, format_decimal(value, parameter.unit).view());
  }

  void write_distortion(std::uint32_t tick, const Setting& setting) {
    const InternalValue& value =
        scenario_.kernel.slots[setting.slot].algorithm->declaration().internal_values[setting.index];
    insert_distortion_.run(tick, std::uint32_t{setting.slot}, std::uint32_t{setting.joint}, value.name,
                           std::string_view(scale_of(value.unit).symbol), setting.value,
                           format_decimal(setting.value, value.unit).view());
  }

  void require_finite(const TickSample& sample) const {
    const bool finite = std::all_of(sample.joint_angles.begin(), sample.joint_angles.end(),
                                    [](double x) { return std::isfinite(x); }) &&
                        std::all_of(sample.link_poses.begin(), sample.link_poses.end(), is_finite);
    if (!finite) {
      throw FileError(path_, "at tick " + std::to_string(sample.tick) +
                                 " a pose or joint angle is not a finite number: the simulation has become unstable");
    }
  }

  void commit_if_due() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_commit_ >= commit_interval) {
      database_.execute("COMMIT; BEGIN IMMEDIATE");
      last_commit_ = now;
    }
  }

  void close() {
    database_.execute("COMMIT");
    closed_ = true;
    try {
      // Takes the log into the file and removes it, so that a recording is one file that opens anywhere, in a folder
      // without write permission, too.
      database_.execute("PRAGMA journal_mode = DELETE");
    } catch (const SqliteError& error) {
      // Someone is reading at this moment. All is written and stays valid as file and log; the next reader or recorder
      // that can write there finds both.
      if (error.code() != SQLITE_BUSY) {
        throw;
      }
    }
  }

  std::filesystem::path path_;
  const Scenario& scenario_;
  std::vector<InternalValuePlace> internal_values_;  ///< what TickSample::internal_values holds
  NewRecording database_;
  Statement insert_parameter_{database_,
                              "INSERT INTO parameter(tick, origin, slot, joint, name, unit, raw, value_text) "
                              "VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)"};
  Statement insert_distortion_{database_,
                               "INSERT INTO distortion(tick, slot, joint, name, unit, raw, value_text) "
                               "VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)"};
  Statement insert_sample_{database_, "INSERT INTO sample VALUES(?1, ?2, ?3, ?4, ?5)"};
  Statement insert_value_{database_, "INSERT INTO internal_value VALUES(?1, ?2, ?3, ?4, ?5)"};
  Statement insert_pulse_{database_, "INSERT INTO servo VALUES(?1, ?2, ?3)"};
  Statement insert_pose_{database_, "INSERT INTO pose VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)"};
  Statement insert_contact_{database_, "INSERT INTO contact VALUES(?1, ?2, ?3, ?4)"};
  Statement insert_loss_{database_, "INSERT INTO loss VALUES(?1, ?2, ?3, ?4)"};
  Statement insert_restart_{database_, "INSERT INTO restart VALUES(?1, ?2, ?3)"};
  bool closed_ = false;
  bool failed_ = false;
  std::chrono::steady_clock::time_point last_commit_ = std::chrono::steady_clock::now();
};

Recorder::Recorder(const std::filesystem::path& path, const Scenario& scenario, const std::string& program,
                   const std::string& build_id) {
  claim_recording_file(path);
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

void Recorder::record_tick(const TickSample& sample) {
  storage_->guard([&] { storage_->write_tick(sample); });
}

void Recorder::finish(const std::vector<std::pair<std::string, std::string>>& summary) {
  storage_->guard([&] { storage_->finish(summary); });
}

}  // namespace proleg::sim
