#include "tools/proleg/search/side_by_side.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/terminal.hpp"

namespace proleg::tools {
namespace {

[[noreturn]] void fail() { throw std::system_error(errno, std::generic_category(), "starting a process"); }

/// The two ends of a pipe, closed with this object.
struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
      fail();
    }
    std::tie(read_end, write_end) = std::pair(ends[0], ends[1]);
  }
  ~Pipe() {
    close_end(read_end);
    close_end(write_end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  static void close_end(int& end) {
    if (end >= 0) {
      close(std::exchange(end, -1));
    }
  }

  int read_end = -1;
  int write_end = -1;
};

/// Writes all numbers into a pipe, from which each is read by one process. A pipe has room for 64 KiB, which is enough
/// for all repetitions.
void fill(Pipe& numbers, std::span<const std::uint32_t> values) {
  for (const std::uint32_t value : values) {
    if (write(numbers.write_end, &value, sizeof value) != static_cast<ssize_t>(sizeof value)) {
      fail();
    }
  }
  Pipe::close_end(numbers.write_end);
}

std::optional<std::uint32_t> take(const Pipe& numbers) {
  std::uint32_t value = 0;
  ssize_t size = -1;
  do {
    size = read(numbers.read_end, &value, sizeof value);
  } while (size < 0 && errno == EINTR && !interrupted());
  return size == static_cast<ssize_t>(sizeof value) && !interrupted() ? std::optional(value) : std::nullopt;
}

class Process {
 public:
  template <typename Work>
  explicit Process(const Work& work) {
    const pid_t parent = getpid();
    id_ = fork();
    if (id_ < 0) {
      fail();
    }
    if (id_ == 0) {
      run(work, parent);
    }
    Pipe::close_end(lines_.write_end);
    Pipe::close_end(progress_.write_end);
  }
  ~Process() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void interrupt() const { kill(id_, SIGTERM); }

  [[nodiscard]] std::array<pollfd, 2> sockets() const {
    return {{{lines_.read_end, POLLIN, 0}, {progress_.read_end, POLLIN, 0}}};
  }
  /// Reads the available text. Returns whole lines of standard output, and keeps the last line of standard error.
  std::string receive(bool has_lines, bool has_progress) {
    std::string lines;
    if (has_lines && read_from(lines_, lines_begun_)) {
      const std::size_t end = lines_begun_.rfind('\n') + 1;
      lines = lines_begun_.substr(0, end);
      lines_begun_.erase(0, end);
    }
    if (has_progress && read_from(progress_, progress_begun_)) {
      const std::size_t end = progress_begun_.rfind('\n') + 1;
      new_progress_ = progress_begun_.substr(0, end);
      progress_begun_.erase(0, end);
      if (end > 1) {
        const std::size_t start = new_progress_.rfind('\n', end - 2) + 1;  // npos + 1 is 0
        latest_ = new_progress_.substr(start, end - 1 - start);
      }
    }
    return lines;
  }
  [[nodiscard]] bool has_ended() const { return lines_.read_end < 0 && progress_.read_end < 0; }
  [[nodiscard]] const std::string& latest() const { return latest_; }
  [[nodiscard]] std::string take_progress() { return std::exchange(new_progress_, {}); }

 private:
  template <typename Work>
  [[noreturn]] void run(const Work& work, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) {
      _exit(exit_failed);
    }
    dup2(lines_.write_end, STDOUT_FILENO);
    dup2(progress_.write_end, STDERR_FILENO);
    int status = exit_success;
    try {
      work();
    } catch (const std::exception& error) {
      std::cout << error.what() << std::endl;
      status = exit_failed;
    }
    std::fflush(stdout);
    std::cout.flush();
    _exit(status);  // exit() would close files that the parent has open
  }

  /// Reads from a pipe; at its end closes it and returns false.
  static bool read_from(Pipe& pipe, std::string& text) {
    std::array<char, 4096> bytes{};
    const ssize_t size = read(pipe.read_end, bytes.data(), bytes.size());
    if (size > 0) {
      text.append(bytes.data(), static_cast<std::size_t>(size));
    } else if (size == 0) {
      Pipe::close_end(pipe.read_end);
    }
    return size > 0;
  }

  pid_t id_ = -1;
  Pipe lines_;
  Pipe progress_;
  std::string lines_begun_;
  std::string progress_begun_;
  std::string new_progress_;
  std::string latest_;
};

/// Prints and draws the output of the processes, until they end.
class Relay {
 public:
  explicit Relay(std::vector<std::unique_ptr<Process>>& processes) : processes_(processes) {}

  void run() {
    while (wait()) {
      for (std::size_t i = 0; i < processes_.size(); ++i) {
        const std::string lines = processes_[i]->receive(ready_[2 * i].revents != 0, ready_[2 * i + 1].revents != 0);
        if (!lines.empty()) {
          terminal_line_.erase();
          std::cerr << lines << std::flush;
        }
      }
      show();
      if (interrupted() && !std::exchange(has_interrupted_, true)) {
        for (const auto& process : processes_) {
          process->interrupt();
        }
      }
    }
  }

 private:
  /// Waits for output; returns false when all processes have ended.
  bool wait() {
    constexpr int look_at_interrupts_ms = 200;
    ready_.clear();
    bool is_over = true;
    for (const auto& process : processes_) {
      for (const pollfd& socket : process->sockets()) {
        ready_.push_back(socket);  // poll() ignores closed ones (-1)
      }
      is_over = is_over && process->has_ended();
    }
    if (!is_over && poll(ready_.data(), ready_.size(), look_at_interrupts_ms) < 0) {
      for (pollfd& socket : ready_) {
        socket.revents = 0;  // a signal interrupted poll()
      }
    }
    return !is_over;
  }

  void show() {
    std::string all;
    for (const auto& process : processes_) {
      const std::string progress = process->take_progress();
      if (!terminal_line_.is_visible()) {
        std::cerr << progress << std::flush;
      }
      all += (all.empty() || process->latest().empty() ? "" : " | ") + process->latest();
    }
    if (processes_.size() > 2) {
      const auto running = std::ranges::count_if(processes_, [](const auto& each) { return !each->has_ended(); });
      all = std::to_string(running) + " side by side: " + all;
    }
    if (terminal_line_.is_due()) {
      terminal_line_.draw(std::string_view(all).substr(0, TerminalLine::max_width()));
    }
  }

  std::vector<std::unique_ptr<Process>>& processes_;
  std::vector<pollfd> ready_;
  TerminalLine terminal_line_{std::chrono::milliseconds(0)};
  bool has_interrupted_ = false;
};

}  // namespace

void work_side_by_side(std::uint32_t processes, std::span<const std::uint32_t> numbers,
                       const std::function<void(std::uint32_t process, const NextNumber& next)>& work,
                       const std::function<void()>& started) {
  Pipe pipe;
  fill(pipe, numbers);
  std::cout.flush();
  std::fflush(stdout);
  std::vector<std::unique_ptr<Process>> all;
  for (std::uint32_t i = 0; i < processes; ++i) {
    try {
      all.push_back(std::make_unique<Process>([&, i] { work(i, [&] { return take(pipe); }); }));
    } catch (const std::system_error&) {
      if (all.empty()) {
        throw;
      }
      break;  // the processes that have started do the work
    }
  }
  started();
  Relay(all).run();
}

}  // namespace proleg::tools
