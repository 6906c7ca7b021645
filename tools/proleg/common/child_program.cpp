#include "tools/proleg/common/child_program.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "tools/proleg/common/program_start.hpp"

namespace proleg::tools {
ChildProgram::Pipe::Pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
  }
  end = ends[0];
  other_end = ends[1];
  fcntl(end, F_SETFL, O_NONBLOCK);
}

ChildProgram::Pipe::~Pipe() {
  close(end);
  close_other_end();
}

void ChildProgram::Pipe::close_other_end() {
  if (other_end >= 0) {
    close(other_end);
    other_end = -1;
  }
}

ChildProgram::ChildProgram(const std::vector<std::string>& command, const std::string& folder, Errors errors)
    : ChildProgram(command, folder, errors, false, -1) {}

std::unique_ptr<ChildProgram> ChildProgram::with_input(const std::vector<std::string>& command,
                                                       const std::string& folder, int inherited,
                                                       std::chrono::seconds time_to_end) {
  std::unique_ptr<ChildProgram> program(new ChildProgram(command, folder, Errors::apart, true, inherited));
  program->time_to_end_ = time_to_end;
  return program;
}

ChildProgram::ChildProgram(const std::vector<std::string>& command, const std::string& folder, Errors errors,
                           bool has_input, int inherited) {
  if (errors == Errors::apart) {
    errors_.emplace();
  }
  if (has_input) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw std::runtime_error(std::string("cannot make a pair of sockets: ") + std::strerror(errno));
    }
    input_.emplace(ends);
  }
  ProgramStart start;
  start.folder = folder;
  start.output = output_.other_end;
  start.errors = errors_ ? errors_->other_end : output_.other_end;
  start.input = input_ ? input_->other_end : -1;
  start.inherited = inherited;
  start.gives_way = !has_input;
  static std::atomic<unsigned> count = 0;
  mark_ = std::to_string(getpid()) + "." + std::to_string(Clock::now().time_since_epoch().count()) + "." +
          std::to_string(++count);
  start.mark = mark_;
  process_ = start_program(command, start);
  output_.close_other_end();
  for (std::optional<Pipe>* pipe : {&errors_, &input_}) {
    if (*pipe) {
      (*pipe)->close_other_end();
    }
  }
}

bool ChildProgram::write_line(std::string_view line) {
  const std::string text = std::string(line) + "\n";
  return input_ &&
         send(input_->end, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(text.size());
}

ChildProgram::~ChildProgram() {
  constexpr std::chrono::milliseconds period{10};
  if (!status()) {
    end();
    while (!status()) {
      std::this_thread::sleep_for(period);
    }
  }
}

std::string ChildProgram::read_from(int pipe) {
  std::string text;
  std::array<char, 4096> bytes{};
  while (text.size() < most_at_once) {
    const ssize_t length = ::read(pipe, bytes.data(), bytes.size());
    if (length > 0) {
      text.append(bytes.data(), static_cast<std::size_t>(length));
    } else if (length == 0 || errno != EINTR) {
      break;
    }
  }
  return text;
}

std::optional<int> ChildProgram::status() {
  if (status_) {
    return status_;
  }
  if (killed_at_ && Clock::now() >= *killed_at_) {
    kill(-process_, SIGKILL);
  }
  siginfo_t info{};
  if (waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == 0) {
    return std::nullopt;
  }
  // Until the program is waited for, no other group can have its number.
  kill(-process_, SIGKILL);
  if (killed_at_) {
    end_marked(mark_);
  }
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  status_ = exit_status_of(status);
  return status_;
}

void ChildProgram::end() {
  if (!status_ && !killed_at_) {
    kill(-process_, SIGTERM);
    killed_at_ = Clock::now() + time_to_end_;
  }
}

}  // namespace proleg::tools
