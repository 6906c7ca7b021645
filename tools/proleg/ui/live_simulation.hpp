#pragma once

// A simulation that a person changes while it runs. Every change takes effect at a tick, so the run can be repeated:
// command_line() is the command that does.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/authoring/actuation_edit.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/parameter_edits.hpp"
#include "tools/proleg/ui/repeated_run.hpp"

namespace proleg::tools {

class LiveSimulation {
 public:
  /// What the parameters are at tick 0 of a new run.
  enum class StartValues : std::uint8_t { wanted, file };

  /// file: the scenario as its files have it. settings: words of --set that the runs begin with. losses: must outlive
  /// this. Throws as Simulation does, and InputError for a setting.
  LiveSimulation(sim::Scenario file, std::vector<std::string> settings, const sim::Losses* losses);
  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;

  /// Words as for --set, without a tick; all of them take effect at one tick, which is returned: the coming one, or a
  /// later one if a module would have to keep too many values. Throws InputError, and then changes nothing. gesture:
  /// changes with the same number are one entry of the history.
  std::uint32_t set(const std::vector<std::string>& words, std::optional<std::uint64_t> gesture);
  /// False if there is nothing to undo.
  bool undo();
  bool redo();
  /// Exchanges what is wanted with the other of two sets of values, which begins with those of the file.
  void swap_sets();
  [[nodiscard]] char set_name() const { return is_set_b_ ? 'B' : 'A'; }
  /// The parameters at these places are wanted as the file has them.
  void reset(const std::vector<ParameterPlace>& places);
  /// The places that names mean, of each joint; without names all (ParameterEdits::places_of()).
  [[nodiscard]] std::vector<ParameterPlace> places_of(const std::optional<std::vector<std::string>>& names) const {
    return edits_.places_of(names);
  }

  /// What the actuation file lacks of the wanted parameters.
  [[nodiscard]] std::vector<sim::ActuationEdit> file_edits() const;
  /// Writes some of file_edits() into the actuation file. Throws as write_actuation() does.
  void apply_to_file(std::span<const sim::ActuationEdit> edits);
  /// Copies the files with all file_edits() into a new folder; from then on they are the files of this simulation.
  /// Throws as write_copy() does.
  void save_as(const std::filesystem::path& folder);

  /// Puts the robot elsewhere at the present tick. place: X,Y,Z,DEGREES as for --move. Throws InputError, and then
  /// moves nothing.
  void move(const std::string& place);

  /// The tick at which the robot was put elsewhere last, in the run up to now.
  [[nodiscard]] std::optional<std::uint32_t> last_move() const;

  /// A new run, from tick 0, to which the same will be done as to an earlier one.
  void repeat(const RunInputs& inputs);
  /// A new run, from tick 0, with the newest versions of algorithms (take_newest_algorithms()). Returns the names of
  /// those whose newer version cannot be used.
  std::vector<std::string> restart(StartValues values);
  /// One tick. Throws PhysicsError; then only restart() is possible.
  void advance();

  /// Records the run from tick 0 on, whenever it is called: the ticks up to now are computed again, and are the same
  /// bits. Ends the recording before. goes_on: asked after each tick that is computed again; false: the recording is
  /// given up, and record() returns false. Throws FileError if the file cannot be written.
  bool record(const std::filesystem::path& path, const std::string& program, const std::string& build_id,
              const std::function<bool()>& goes_on);
  /// Without a recording it does nothing. restart() ends a recording, too. Throws FileError.
  void end_recording();
  [[nodiscard]] bool is_recording() const { return recorder_ != nullptr; }
  /// Why the recording has ended by itself, once; the simulation goes on. For example, the disk is full.
  [[nodiscard]] std::optional<std::string> take_recording_failure() {
    return std::exchange(recording_failure_, std::nullopt);
  }

  [[nodiscard]] const sim::Simulation& simulation() const { return *simulation_; }
  /// How the joints followed the gait in the last four seconds, from the head.
  [[nodiscard]] std::vector<sim::ServoTracking> recent_servos() const;
  /// The sample of the last tick (Simulation::sample()).
  [[nodiscard]] sim::TickSample sample() { return simulation_->sample(); }
  [[nodiscard]] const sim::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const sim::Scenario& file() const { return file_; }
  [[nodiscard]] const ParameterTable& parameters() const { return edits_.parameters(); }
  [[nodiscard]] const ChangeHistory& history() const { return edits_.history(); }
  [[nodiscard]] bool differs_from_file() const { return edits_.differs_from_file(); }
  /// Counts what changes parameters(), history() or set_name().
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// The words for `proleg simulate FILE` that repeat the run up to now, after the settings that the runs begin with
  /// and without the options that `file` was read with.
  [[nodiscard]] std::vector<std::string> repeating_words() const;
  /// The words of --move that repeat the moves of the robot up to now.
  [[nodiscard]] std::vector<std::string> repeating_moves() const;

 private:
  struct LiveSetting {
    std::uint32_t tick;
    Setting setting;
  };

  /// The last tick of the simulation, and its change.
  static void record_tick(sim::Recorder& recorder, sim::Simulation& simulation, const Change* change);
  void use_file(sim::Scenario file);
  /// Keeps what recent_servos() subtracts later.
  void keep_servos();
  /// Forgets what was done to the run before.
  void clear_run();
  void begin();
  /// Whether a change for this tick or a later one sets the parameter.
  [[nodiscard]] bool was_asked_for(const ParameterPlace& place, std::uint32_t from_tick) const;
  [[nodiscard]] bool fits(std::uint32_t tick, const std::vector<Setting>& settings) const;
  void schedule(std::uint32_t tick, const Setting& setting);
  /// Schedules each of them as soon as possible.
  void schedule_each(const std::vector<Setting>& settings);
  void add_words(std::vector<LiveSetting> settings, bool with_tick, std::vector<std::string>& words) const;

  sim::Scenario file_;
  std::vector<std::string> settings_;
  sim::Scenario given_;  ///< file_ with settings_
  const sim::Losses* losses_;
  sim::Scenario scenario_;  ///< of the present run, with all changes
  std::unique_ptr<sim::Simulation> simulation_;
  std::unique_ptr<sim::Recorder> recorder_;
  std::optional<std::string> recording_failure_;
  std::uint64_t lost_frames_ = 0;  ///< in the present run
  /// What recent_servos() subtracts: states of all servos in intervals of half a second, the oldest first.
  std::deque<std::vector<sim::ServoTracking>> earlier_servos_;
  ParameterEdits edits_;
  std::vector<std::int32_t> other_set_;  ///< in the order of places()
  bool is_set_b_ = false;
  std::vector<LiveSetting> live_;           ///< of the present run, by ascending tick
  std::vector<sim::RobotMove> live_moves_;  ///< of the present run, by ascending tick
  std::uint64_t revision_ = 1;
};

}  // namespace proleg::tools
