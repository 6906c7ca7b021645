#pragma once

// The robots of a class: a program for each seat, started when somebody comes, and started again when it ends by
// itself.

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/server/robot_session.hpp"
#include "host/server/seats.hpp"
#include "tools/proleg/ui/class_register.hpp"
#include "tools/proleg/ui/hand_out.hpp"
#include "tools/proleg/ui/seat_limits.hpp"
#include "tools/proleg/ui/seat_program.hpp"

namespace proleg::tools {

struct ClassRoomOptions {
  std::filesystem::path folder;
  unsigned most_robots = 1;               ///< of learners that run at a time
  std::vector<std::string> command;       ///< of the program of a seat, with the options that all have
  std::optional<HandOut> first_scenario;  ///< with which all begin
  bool may_write_code = false;            ///< learners may write algorithms
  std::string page_program;               ///< build id of the program that serves the page
  bool may_teacher_write_code = true;
  bool is_open_to_network = false;
  SeatLimits limits{};  ///< of each learner
  std::size_t most_seats_of_address = ClassRegister::most_learners;
};

/// All functions may be called from any thread; none of them waits.
class ClassRoom final : public host::SeatDirectory {
 public:
  using Clock = std::chrono::steady_clock;

  /// A STOP is answered after this time, with the robots that have confirmed it by then.
  static constexpr std::chrono::milliseconds longest_stop{500};
  /// A person who is away for so long makes room for another one, if the class is full.
  static constexpr std::chrono::minutes kept_for_absent{2};

  struct Stopped {
    host::RequestId request = 0;
    unsigned confirmed = 0;
    unsigned of = 0;
    double ms = 0;
  };
  /// The folder of somebody who has come since this program started.
  struct Folder {
    host::SeatNumber seat = 0;
    std::string name;
    std::filesystem::path path;
  };

  /// Starts the robot of the teacher. Throws InputError, FileError, std::runtime_error.
  explicit ClassRoom(ClassRoomOptions options);
  ~ClassRoom() override;
  ClassRoom(const ClassRoom&) = delete;
  ClassRoom& operator=(const ClassRoom&) = delete;

  // SeatDirectory
  [[nodiscard]] std::optional<Seat> find(host::SeatNumber number) override;
  void wake(host::SeatNumber number) override;
  void connected(host::SeatNumber number) override;
  void disconnected(host::SeatNumber number) override;
  void stop(host::SeatNumber number) override;
  void join(const std::string& body, const std::string& from, AnswerTo answer) override;
  /// Who still waits for an answer gets none: their connections end before this object.
  void forget_joins();

  /// Stops all robots. poll() gives the answer.
  void stop_all(host::RequestId request);
  /// Looks what the programs have done, starts those again that have ended by themselves, and answers what waits.
  /// Returns the STOPs that are answered.
  [[nodiscard]] std::vector<Stopped> poll();
  /// When poll() must be called again.
  [[nodiscard]] Clock::time_point next_poll() const;
  /// What changed for viewers since the last call, each one line.
  [[nodiscard]] std::vector<std::string> take_news();

  void lock(bool is_locked);
  // These throw InputError if the seat is not that of a learner, and FileError, as lock() does.
  void let_in(host::SeatNumber number);
  void restart(host::SeatNumber number);
  void remove(host::SeatNumber number);
  /// Gives a line to the program of a seat (SeatProgram). False: it does not run.
  bool tell(host::SeatNumber number, const nlohmann::json& line);

  [[nodiscard]] std::vector<Folder> folders() const;
  [[nodiscard]] std::filesystem::path folder() const { return register_.folder(); }
  /// The document `class` (docs/page-interface.md), without what only the session knows.
  [[nodiscard]] nlohmann::json document() const;

 private:
  struct Place {
    std::unique_ptr<SeatProgram> program;
    unsigned connections = 0;
    Clock::time_point absent_since;
    std::deque<Clock::time_point> restarts;  ///< of the last minute
  };
  struct WaitingJoin {
    host::SeatNumber seat = 0;
    AnswerTo answer;
  };
  struct WaitingStop {
    host::RequestId request = 0;
    std::uint64_t number = 0;
    Clock::time_point since;
    std::set<host::SeatNumber> missing;
    unsigned confirmed = 0;
    unsigned of = 0;
  };

  // With the mutex:

  /// The place of a learner, with a program that runs. Throws JoinRefusal if the class is full.
  Place& start_place(host::SeatNumber number);
  void start_program(const Learner& learner, Place& place, bool is_paused);
  /// Ends the robot of somebody who is away, if this learner (null: a new one) has none that runs and there is no room.
  /// Throws JoinRefusal.
  void require_room(const Learner* learner);
  [[nodiscard]] std::filesystem::path folder_of(const Learner& learner) const;
  void poll_place(host::SeatNumber number, Place& place, Clock::time_point now);
  void answer_joins();
  void restart_program(host::SeatNumber number);
  [[nodiscard]] static nlohmann::json seat_json(const Learner& learner, const Place& place);

  const ClassRoomOptions options_;
  mutable std::mutex mutex_;
  ClassRegister register_;
  std::map<host::SeatNumber, Place> places_;
  std::map<host::SeatNumber, unsigned> departed_;    ///< connections of learners who were removed; they end soon
  std::list<std::unique_ptr<SeatProgram>> leaving_;  ///< programs that have been asked to end
  std::list<WaitingJoin> joins_;
  std::list<WaitingStop> stops_;
  std::uint64_t last_stop_ = 0;
  std::vector<std::string> news_;
};

}  // namespace proleg::tools
