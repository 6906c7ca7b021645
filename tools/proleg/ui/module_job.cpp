#include "tools/proleg/ui/module_job.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "host/transport/open_transport.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/program_start.hpp"
#include "tools/proleg/ui/command_sequence.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr int first_signal_status = 128;
constexpr std::size_t longest_line = 500;

/// The two ends of a bus between two programs.
std::array<host::Descriptor, 2> connected_ends() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error(std::string("no socket pair: ") + std::strerror(errno));
  }
  return {host::Descriptor(ends[0]), host::Descriptor(ends[1])};
}

std::string inherited_bus() { return "fd:" + std::to_string(inherited_number); }

/// The whole lines of a text, which loses them. What follows the last one stays.
std::vector<std::string> take_lines(std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  text.erase(0, begin);
  return lines;
}

}  // namespace

ModuleJob::ModuleJob(unsigned number, ModuleJobPlan plan, std::string address, BusSharing& sharing)
    : number_(number), plan_(std::move(plan)), address_(std::move(address)), sharing_(sharing) {
  if (!sharing_.begin_job(plan_.longest_loss, plan_.gives_way)) {
    throw std::runtime_error("the servos have power; switch it off first");
  }
  try {
    start();
  } catch (...) {
    sharing_.end_job();
    throw;
  }
}

ModuleJob::~ModuleJob() {
  program_.reset();
  if (!status_) {
    sharing_.end_job();
  }
}

void ModuleJob::start() {
  std::vector<std::string> command{(program_folder() / ("proleg-" + plan_.words.front())).string(), "--bus",
                                   plan_.opens_bus ? address_ : inherited_bus()};
  command.insert(command.end(), plan_.words.begin() + 1, plan_.words.end());
  std::array<host::Descriptor, 2> ends;
  if (!plan_.opens_bus) {
    ends = connected_ends();
  }
  const std::string folder = plan_.files ? plan_.files->path().string() : plan_.folder;
  program_ = ChildProgram::with_input(command, folder, ends[0].number());
  if (ends[1].is_open()) {
    sharing_.add_program(std::move(ends[1]));
  }
}

bool ModuleJob::look() {
  if (status_) {
    return false;
  }
  const std::optional<int> status = program_->status();
  const bool has_output = take_output();
  const bool has_errors = take_errors();
  if (!status) {
    return has_output || has_errors;
  }
  status_ = status;
  finish();
  sharing_.end_job();
  return true;
}

bool ModuleJob::take_output() {
  const std::string text = program_->read();
  if (output_.size() + text.size() > most_output) {
    output_.clear();  // no program of ours prints so much
  }
  output_ += text;
  if (plan_.output != ModuleJobPlan::Output::events) {
    return false;
  }
  const std::vector<std::string> lines = take_lines(output_);
  for (const std::string& line : lines) {
    take_event(line);
  }
  return !lines.empty();
}

void ModuleJob::take_event(const std::string& line) {
  json event = json::parse(line, nullptr, false);
  if (!event.is_object() || !event.contains("event") || !event["event"].is_string()) {
    return;
  }
  const auto name = event["event"].get<std::string>();
  event.erase("event");
  if (name == "result") {
    result_ = std::move(event["value"]);
  } else if (name == "question") {
    question_ = std::move(event);
    question_["number"] = ++questions_;
  } else if (name == "ended") {
    add_ended(event);
  } else {
    latest_[name] = std::move(event);
  }
}

/// An update may have several parts, one module first: who comes later finds all modules that have ended.
void ModuleJob::add_ended(const json& event) {
  json& modules = latest_["ended"]["modules"];
  for (const json& module : event.value("modules", json::array())) {
    const auto same = std::find_if(modules.begin(), modules.end(), [&module](const json& one) {
      return one.value("serial", json()) == module.value("serial", json());
    });
    if (same == modules.end()) {
      modules.push_back(module);
    } else {
      *same = module;
    }
  }
}

bool ModuleJob::take_errors() {
  errors_ += program_->read_errors();
  const std::vector<std::string> lines = take_lines(errors_);
  for (const std::string& line : lines) {
    if (!trimmed(line).empty()) {
      lines_.push_back(shortened(with_address(one_line(trimmed(line))), longest_line));
    }
  }
  while (lines_.size() > most_lines) {
    lines_.pop_front();
  }
  return !lines.empty();
}

void ModuleJob::finish() {
  errors_ += '\n';
  take_errors();
  question_ = json();
  if (plan_.output == ModuleJobPlan::Output::object) {
    if (json object = json::parse(output_, nullptr, false); object.is_object()) {
      result_ = std::move(object);
    }
  } else if (plan_.output == ModuleJobPlan::Output::text) {
    result_ = with_address(std::string(trimmed(output_)));
  }
  if (result_.is_object() && result_.contains("bus")) {
    result_["bus"] = address_;
  }
  output_.clear();
}

std::optional<int> ModuleJob::status() const {
  return status_ && *status_ < first_signal_status ? status_ : std::nullopt;
}

std::string ModuleJob::failure() const {
  if (!status_ || *status_ == 0) {
    return {};
  }
  if (!lines_.empty()) {
    return without_program_name(lines_.back());
  }
  return *status_ < first_signal_status
             ? "the program has ended with status " + std::to_string(*status_)
             : "signal " + std::to_string(*status_ - first_signal_status) + " has ended the program";
}

void ModuleJob::answer(std::uint64_t question, const std::string& word) {
  if (question_.is_null() || question_["number"] != question) {
    throw std::runtime_error("this question has been answered");
  }
  if (!program_->write_line(one_line(word))) {
    throw std::runtime_error("the program takes no answer now");
  }
  question_ = json();
  latest_.erase("refused");
}

void ModuleJob::end(const std::string& by) {
  if (ended_by_.empty() && !status_) {
    ended_by_ = by;
    program_->end();
  }
}

std::string ModuleJob::with_address(std::string text) const {
  const std::string inherited = inherited_bus();
  for (std::size_t at = text.find(inherited); at != std::string::npos; at = text.find(inherited, at)) {
    text.replace(at, inherited.size(), address_);
    at += address_.size();
  }
  return text;
}

json ModuleJob::document() const {
  return {{"number", number_},
          {"kind", plan_.kind},
          {"state", status_             ? "ended"
                    : ended_by_.empty() ? "running"
                                        : "ending"},
          {"by", plan_.by},
          {"command", plan_.shown},
          {"latest", latest_},
          {"question", question_},
          {"lines", lines_},
          {"result", result_},
          {"status", status() ? json(*status()) : json()},
          {"error", result_.is_object() ? json() : text_or_null(failure())},
          {"ended_by", text_or_null(ended_by_)}};
}

}  // namespace proleg::tools
