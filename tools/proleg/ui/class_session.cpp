#include "tools/proleg/ui/class_session.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/ui/class_files.hpp"
#include "tools/proleg/ui/folder_walk.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::chrono::seconds count_period{3};
constexpr std::size_t most_message_characters = 200;

host::SeatNumber seat_in(const json& arguments) {
  return required_argument<host::SeatNumber>(arguments, "seat", "the seat of a learner");
}

unsigned recordings_in(const fs::path& folder) {
  unsigned count = 0;
  for_each_path(
      folder, [&count](const fs::path& path) { count += path.extension() == ".proleg" ? 1U : 0U; },
      [](const fs::path& path) { return !path.filename().string().starts_with('.'); });
  return count;
}

}  // namespace

void ClassRouter::operate(const host::OperationRequest& request) {
  const std::vector<std::string> with_files = ClassFiles::operations();
  const bool has_files = std::ranges::find(with_files, request.name) != with_files.end();
  (has_files ? files_ : session_).operate(request);
}

void ClassRouter::stop(const host::StopRequest& request) {
  room_.stop_all(request.request);
  session_.holder_changed(false, false);  // wakes the thread that looks for the answers
}

ClassSession::ClassSession(ClassRoom& room, std::string address, SessionRequests& requests, host::SessionOutput& output)
    : SessionThread(requests, output), room_(room), address_(std::move(address)) {
  begin_thread();
}

ClassSession::~ClassSession() { end_thread(); }

void ClassSession::serve() {
  static_cast<void>(requests_.take_holder());
  take_operations();
  for (const ClassRoom::Stopped& stopped : room_.poll()) {
    output_.stopped(stopped.request, stopped.confirmed, stopped.of, stopped.ms);
  }
  for (const std::string& news : room_.take_news()) {
    output_.notice(host::NoticeLevel::warning, news);
  }
  if (Clock::now() >= count_at_) {
    count_recordings();
    count_at_ = Clock::now() + count_period;
  }
  publish();
  requests_.wait_until(room_.next_poll());
}

void ClassSession::count_recordings() {
  recordings_.clear();
  for (const ClassRoom::Folder& folder : room_.folders()) {
    recordings_[folder.seat] = recordings_in(folder.path);
  }
}

void ClassSession::publish() {
  json document = room_.document();
  document["address"] = address_;
  const auto complete = [this](json& seat) {
    const auto count = recordings_.find(seat.at("seat").get<host::SeatNumber>());
    seat["recordings"] = count == recordings_.end() ? 0 : count->second;
  };
  if (!document["teacher"].is_null()) {
    complete(document["teacher"]);
  }
  for (json& learner : document["learners"]) {
    complete(learner);
  }
  if (document != published_) {
    output_.publish("class", document);
    published_ = std::move(document);
  }
}

json ClassSession::carry_out(const host::OperationRequest& operation) {
  using Handler = json (ClassSession::*)(const json&);
  static const std::map<std::string_view, Handler> handlers{{"class.message", &ClassSession::send_message},
                                                            {"class.lock", &ClassSession::lock},
                                                            {"class.let_in", &ClassSession::let_in},
                                                            {"class.restart", &ClassSession::restart},
                                                            {"class.remove", &ClassSession::remove}};
  return (this->*handler_of(handlers, operation.name))(operation.arguments);
}

json ClassSession::send_message(const json& arguments) {
  const auto text = required_argument<std::string>(arguments, "text", "a message");
  if (trimmed(text).empty() || shortened(text, most_message_characters) != text || find_invalid_utf8(text)) {
    throw InputError("text", 0, in_quotes(one_line(text)), "1 to 200 characters");
  }
  const auto seats = argument<std::vector<host::SeatNumber>>(arguments, "seats", "numbers of seats");
  for (const ClassRoom::Folder& learner : room_.folders()) {
    const bool is_meant =
        seats ? std::ranges::find(*seats, learner.seat) != seats->end() : learner.seat != ClassRegister::teacher;
    if (is_meant) {
      static_cast<void>(room_.tell(learner.seat, {{"do", "notice"}, {"text", "Your teacher: " + one_line(text)}}));
    }
  }
  return json::object();
}

json ClassSession::lock(const json& arguments) {
  room_.lock(required_argument<bool>(arguments, "locked", "true or false"));
  return json::object();
}

json ClassSession::let_in(const json& arguments) {
  room_.let_in(seat_in(arguments));
  return json::object();
}

json ClassSession::restart(const json& arguments) {
  room_.restart(seat_in(arguments));
  return json::object();
}

json ClassSession::remove(const json& arguments) {
  room_.remove(seat_in(arguments));
  return json::object();
}

}  // namespace proleg::tools
