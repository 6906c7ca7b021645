#include "tools/proleg/ui/class_room.hpp"

#include <algorithm>
#include <exception>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::chrono::milliseconds fast_poll{5};  // while somebody waits
constexpr std::chrono::milliseconds slow_poll{50};
constexpr std::chrono::minutes restart_period{1};
constexpr std::size_t most_restarts = 3;  // in that period

/// Number of a STOP whose answer nobody waits for.
constexpr std::uint64_t unasked_stop = 0;

host::SeatDirectory::Answer refusal(unsigned status, const std::string& why) {
  return {status, json{{"error", why}}.dump(-1, ' ', false, json::error_handler_t::replace)};
}

json stop_line(std::uint64_t number, const std::string& by) { return {{"do", "stop"}, {"number", number}, {"by", by}}; }

bool runs(const std::unique_ptr<SeatProgram>& program) {
  return program != nullptr && program->state() != SeatProgram::State::ended;
}

}  // namespace

ClassRoom::ClassRoom(ClassRoomOptions options)
    : options_(std::move(options)), register_(options_.folder, options_.most_seats_of_address) {
  start_place(ClassRegister::teacher);
}

ClassRoom::~ClassRoom() {
  // All end at the same time; then their destructors wait for them.
  for (auto& [number, place] : places_) {
    if (place.program != nullptr) {
      place.program->end();
    }
  }
}

std::optional<host::SeatDirectory::Seat> ClassRoom::find(host::SeatNumber number) {
  const std::lock_guard lock(mutex_);
  const Learner* const learner = register_.find(number);
  if (learner == nullptr) {
    return std::nullopt;
  }
  const auto place = places_.find(number);
  const bool has_program = place != places_.end() && place->second.program != nullptr;
  return Seat{has_program ? place->second.program->port() : std::nullopt, learner->token};
}

void ClassRoom::wake(host::SeatNumber number) {
  const std::lock_guard lock(mutex_);
  const auto place = places_.find(number);
  if (place != places_.end() && place->second.program != nullptr) {
    return;  // it starts, or it has ended so often that somebody must look
  }
  try {
    start_place(number);
  } catch (const std::exception& error) {
    news_.push_back(one_line(error.what()));
  }
}

void ClassRoom::connected(host::SeatNumber number) {
  const std::lock_guard lock(mutex_);
  if (register_.find(number) == nullptr) {  // removed since the server asked for the seat
    ++departed_[number];
  } else {
    ++places_[number].connections;
  }
}

void ClassRoom::disconnected(host::SeatNumber number) {
  const std::lock_guard lock(mutex_);
  if (const auto departed = departed_.find(number); departed != departed_.end()) {
    if (--departed->second == 0) {
      departed_.erase(departed);
    }
    return;
  }
  const auto place = places_.find(number);
  if (place != places_.end() && place->second.connections > 0) {
    --place->second.connections;
    place->second.absent_since = Clock::now();
  }
}

void ClassRoom::stop(host::SeatNumber number) {
  const std::lock_guard lock(mutex_);
  const auto place = places_.find(number);
  if (place != places_.end() && runs(place->second.program)) {
    place->second.program->tell(stop_line(unasked_stop, "POST /stop"));
  }
}

void ClassRoom::stop_all(host::RequestId request) {
  const std::lock_guard lock(mutex_);
  WaitingStop stop{request, ++last_stop_, Clock::now(), {}, 0, 0};
  for (auto& [number, place] : places_) {
    if (!runs(place.program)) {
      continue;
    }
    ++stop.of;
    if (place.program->tell(stop_line(stop.number, "your teacher"))) {
      stop.missing.insert(number);
    }
  }
  stops_.push_back(std::move(stop));
}

void ClassRoom::join(const std::string& body, const std::string& from, AnswerTo answer) {
  const std::lock_guard lock(mutex_);
  std::string name;
  try {
    const JoinWish wish = JoinWish::parse(body);
    name = wish.name;
    const Learner& learner =
        register_.join(wish, from, Clock::now(), [this](const Learner* known) { require_room(known); });
    start_place(learner.seat);
    joins_.push_back({learner.seat, std::move(answer)});
  } catch (const JoinRefusal& why) {
    constexpr unsigned conflict = 409;
    if (const Learner* const known = why.status() == conflict ? register_.find(name) : nullptr) {
      places_[known->seat];  // the teacher sees who may be meant, and can let them in
    }
    answer(refusal(why.status(), why.what()));
  } catch (const std::exception& error) {
    news_.push_back(one_line(error.what()));
    answer(refusal(503, "the robot does not start; ask your teacher"));
  }
}

void ClassRoom::forget_joins() {
  std::list<WaitingJoin> joins;
  const std::lock_guard lock(mutex_);
  joins.swap(joins_);
}

ClassRoom::Place& ClassRoom::start_place(host::SeatNumber number) {
  const Learner* const learner = register_.find(number);
  if (learner == nullptr) {
    throw JoinRefusal(404, "nobody has seat " + std::to_string(number));
  }
  const auto known = places_.find(number);
  if (known != places_.end() && runs(known->second.program)) {
    return known->second;
  }
  require_room(learner);
  Place& place = places_[number];
  place.absent_since = Clock::now();
  start_program(*learner, place, false);
  return place;
}

void ClassRoom::require_room(const Learner* learner) {
  const auto known = learner == nullptr ? places_.end() : places_.find(learner->seat);
  const bool is_there = known != places_.end() && runs(known->second.program);
  if (is_there || (learner != nullptr && learner->seat == ClassRegister::teacher)) {
    return;
  }
  const auto is_learner = [](const auto& entry) {
    return entry.first != ClassRegister::teacher && runs(entry.second.program);
  };
  if (static_cast<unsigned>(std::ranges::count_if(places_, is_learner)) < options_.most_robots) {
    return;
  }
  auto longest = places_.end();
  for (auto place = places_.begin(); place != places_.end(); ++place) {
    if (is_learner(*place) && place->second.connections == 0 &&
        (longest == places_.end() || place->second.absent_since < longest->second.absent_since)) {
      longest = place;
    }
  }
  if (longest == places_.end() || Clock::now() < longest->second.absent_since + kept_for_absent) {
    throw JoinRefusal(
        503, "the class is full: " + std::to_string(options_.most_robots) + " robots run; your teacher can remove one");
  }
  longest->second.program->end();
  leaving_.push_back(std::move(longest->second.program));
}

fs::path ClassRoom::folder_of(const Learner& learner) const { return register_.folder() / learner.folder; }

void ClassRoom::start_program(const Learner& learner, Place& place, bool is_paused) {
  const fs::path folder = folder_of(learner);
  std::error_code error;
  fs::create_directories(folder, error);
  const bool is_teacher = learner.seat == ClassRegister::teacher;
  std::vector<std::string> command = options_.command;
  if (is_paused) {
    command.emplace_back("--paused");
  }
  if (options_.first_scenario) {
    command.push_back(options_.first_scenario->copy_once_to(folder).string());
  }
  const json settings{{"token", learner.token.text()},
                      {"name", learner.name},
                      {"is_teacher", is_teacher},
                      {"may_write_code", is_teacher ? options_.may_teacher_write_code : options_.may_write_code},
                      {"is_open_to_network", options_.is_open_to_network},
                      {"limits", is_teacher ? json() : limits_json(options_.limits)},
                      {"page_program", options_.page_program}};
  place.program = std::make_unique<SeatProgram>(command, folder, settings, Clock::now());
}

std::vector<ClassRoom::Stopped> ClassRoom::poll() {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  for (auto& [number, place] : places_) {
    if (place.program != nullptr) {
      poll_place(number, place, now);
    }
  }
  std::erase_if(leaving_, [now](const std::unique_ptr<SeatProgram>& program) {
    static_cast<void>(program->poll(now));
    return program->state() == SeatProgram::State::ended;
  });
  answer_joins();
  std::vector<Stopped> answered;
  std::erase_if(stops_, [&](const WaitingStop& stop) {
    if (!stop.missing.empty() && now < stop.since + longest_stop) {
      return false;
    }
    const std::chrono::duration<double, std::milli> duration = now - stop.since;
    answered.push_back({stop.request, stop.confirmed, stop.of, duration.count()});
    return true;
  });
  return answered;
}

void ClassRoom::poll_place(host::SeatNumber number, Place& place, Clock::time_point now) {
  const SeatProgram::State before = place.program->state();
  for (const SeatProgram::Stopped& answer : place.program->poll(now)) {
    const auto stop = std::ranges::find(stops_, answer.number, &WaitingStop::number);
    if (stop != stops_.end() && stop->missing.erase(number) > 0) {
      stop->confirmed += answer.confirmed == answer.of ? 1U : 0U;
    }
  }
  if (before == SeatProgram::State::ended || place.program->state() != SeatProgram::State::ended) {
    return;
  }
  for (WaitingStop& stop : stops_) {
    stop.confirmed += stop.missing.erase(number) > 0 ? 1U : 0U;  // what has ended moves nothing
  }
  const Learner* const learner = register_.find(number);
  const std::string name = learner == nullptr ? "seat " + std::to_string(number) : learner->name;
  news_.push_back(name + ": " + place.program->problem());
  while (!place.restarts.empty() && place.restarts.front() + restart_period <= now) {
    place.restarts.pop_front();
  }
  if (learner == nullptr || before != SeatProgram::State::ready || place.restarts.size() >= most_restarts) {
    return;
  }
  place.restarts.push_back(now);
  try {
    start_program(*learner, place, true);  // whatever it did before, such as a STOP
  } catch (const std::exception& error) {
    news_.push_back(name + ": " + one_line(error.what()));
  }
}

void ClassRoom::answer_joins() {
  std::erase_if(joins_, [this](const WaitingJoin& join) {
    const Learner* const learner = register_.find(join.seat);
    const auto place = places_.find(join.seat);
    if (learner == nullptr || place == places_.end() || !runs(place->second.program)) {
      join.answer(refusal(503, "the robot does not start; ask your teacher"));
      return true;
    }
    if (!place->second.program->port()) {
      return false;
    }
    join.answer({200, json{{"seat", learner->seat},
                           {"name", learner->name},
                           {"path", "/robots/" + std::to_string(learner->seat) + "/"},
                           {"token", learner->token.text()},
                           {"key", learner->key}}
                          .dump()});
    return true;
  });
}

ClassRoom::Clock::time_point ClassRoom::next_poll() const {
  const std::lock_guard lock(mutex_);
  const bool is_waited_for = !stops_.empty() || !joins_.empty() || std::ranges::any_of(places_, [](const auto& entry) {
    const auto& program = entry.second.program;
    return program != nullptr && program->state() == SeatProgram::State::starting;
  });
  return Clock::now() + (is_waited_for ? fast_poll : slow_poll);
}

std::vector<std::string> ClassRoom::take_news() {
  const std::lock_guard lock(mutex_);
  return std::exchange(news_, {});
}

void ClassRoom::lock(bool is_locked) {
  const std::lock_guard lock(mutex_);
  register_.lock(is_locked);
}

void ClassRoom::let_in(host::SeatNumber number) {
  const std::lock_guard lock(mutex_);
  register_.let_in(number);
  const auto place = places_.find(number);
  if (place != places_.end() && place->second.program != nullptr) {
    restart_program(number);
  }
}

void ClassRoom::restart(host::SeatNumber number) {
  const std::lock_guard lock(mutex_);
  if (register_.find(number) == nullptr) {
    throw InputError("seat", 0, std::to_string(number), "a seat of the class");
  }
  restart_program(number);
}

void ClassRoom::restart_program(host::SeatNumber number) {
  Place& place = places_[number];
  if (place.program != nullptr) {
    place.program->end();
    leaving_.push_back(std::move(place.program));
  }
  place.restarts.clear();
  start_place(number);
}

void ClassRoom::remove(host::SeatNumber number) {
  const std::lock_guard lock(mutex_);
  register_.remove(number);
  const auto place = places_.find(number);
  if (place == places_.end()) {
    return;
  }
  if (place->second.program != nullptr) {
    place->second.program->end();
    leaving_.push_back(std::move(place->second.program));
  }
  if (place->second.connections > 0) {
    departed_[number] += place->second.connections;
  }
  places_.erase(place);
}

bool ClassRoom::tell(host::SeatNumber number, const json& line) {
  const std::lock_guard lock(mutex_);
  const auto place = places_.find(number);
  return place != places_.end() && runs(place->second.program) && place->second.program->tell(line);
}

std::vector<ClassRoom::Folder> ClassRoom::folders() const {
  const std::lock_guard lock(mutex_);
  std::vector<Folder> folders;
  for (const auto& [number, place] : places_) {
    if (const Learner* const learner = register_.find(number)) {
      folders.push_back({number, learner->name, folder_of(*learner)});
    }
  }
  return folders;
}

json ClassRoom::seat_json(const Learner& learner, const Place& place) {
  const SeatProgram* const program = place.program.get();
  const bool is_ready = program != nullptr && program->state() == SeatProgram::State::ready;
  const bool is_starting = program != nullptr && program->state() == SeatProgram::State::starting;
  return {{"seat", learner.seat},
          {"name", learner.name},
          {"state", is_ready      ? "ready"
                    : is_starting ? "starting"
                                  : "ended"},
          {"problem", text_or_null(program == nullptr ? std::string() : program->problem())},
          {"connections", place.connections},
          {"path", "/robots/" + std::to_string(learner.seat) + "/"},
          {"token", learner.token.text()}};
}

json ClassRoom::document() const {
  const std::lock_guard lock(mutex_);
  json teacher;
  json learners = json::array();
  for (const auto& [number, place] : places_) {
    const Learner* const learner = register_.find(number);
    if (learner == nullptr) {
      continue;
    }
    json seat = seat_json(*learner, place);
    if (number == ClassRegister::teacher) {
      teacher = std::move(seat);
    } else {
      learners.push_back(std::move(seat));
    }
  }
  return {{"limit", options_.most_robots}, {"is_locked", register_.is_locked()},
          {"code", register_.code()},      {"folder", register_.folder().string()},
          {"teacher", std::move(teacher)}, {"learners", std::move(learners)}};
}

}  // namespace proleg::tools
