// run_in_virtual_time LIBRARY PROGRAM [ARGUMENT]...: runs a program, and all that it starts, in virtual time. LIBRARY
// is that of clock.cpp. Time stands still while any thread of these programs runs or can run. When all of them wait, it
// becomes the end of the wait that ends first.
//
// Linux says whether a thread waits (proc(5)): its state, in which function of the kernel it waits, and how often it
// was given a processor. The state alone does not suffice: a thread may lose the processor when it has the state of a
// sleeper already, or still, for example while it ends. It waits for a processor then, in no function of the kernel. A
// thread that was asleep in a function of the kernel once, and was given no processor since, has only the state to
// show.
//
// The keeper notes the turns of all threads, and then looks at each of them: it sleeps, and has had no turn since. Then
// all of them slept when the last turns had been noted and no thread had been looked at yet, and none can wake another.
//
// Exit status: that of the program; 1 if all threads wait and no wait has an end. Processes that it leaves behind are
// killed.

#include <dirent.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/virtual_time/shared_clock.hpp"

namespace {

using namespace proleg::virtual_time;

/// A descriptor that is closed at the end.
class File {
 public:
  explicit File(const std::string& path) : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~File() {
    if (descriptor_ >= 0) {
      close(descriptor_);
    }
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  /// What the file contains now, up to a kilobyte; empty if it cannot be read.
  [[nodiscard]] std::string_view read(std::array<char, 1024>& buffer) const {
    const ssize_t length = descriptor_ < 0 ? -1 : pread(descriptor_, buffer.data(), buffer.size(), 0);
    return {buffer.data(), length < 0 ? 0 : static_cast<std::size_t>(length)};
  }

 private:
  int descriptor_;
};

class Thread {
 public:
  Thread(int process, int thread)
      : folder_(path(process, thread)),
        stat_(folder_ + "/stat"),
        wchan_(folder_ + "/wchan"),
        schedstat_(folder_ + "/schedstat") {}

  static std::string path(int process, int thread) {
    return "/proc/" + std::to_string(process) + "/task/" + std::to_string(thread);
  }
  /// Notes how often it was given a processor.
  void note_turns() { noted_turns_ = read_turns(); }
  [[nodiscard]] bool has_noted_turns() const { return noted_turns_.has_value(); }
  /// Whether it sleeps now, or is stopped, or has ended.
  [[nodiscard]] bool is_asleep() {
    std::array<char, 1024> buffer{};
    const std::string_view stat = stat_.read(buffer);
    const std::size_t name_end = stat.rfind(')');
    const char state = name_end == std::string_view::npos ? 'X' : stat[name_end + 2];
    has_ended_ = state == 'Z' || state == 'X';
    if (!has_ended_ && std::strchr("TSI", state) == nullptr) {
      return false;
    }
    turns_ = read_turns();
    is_stopped_ = state == 'T';
    return has_ended_ || is_stopped_ || waits_in_kernel();
  }
  /// Whether it was given a processor between the last note_turns() and the last is_asleep().
  [[nodiscard]] bool had_a_turn() const { return noted_turns_ != turns_; }
  /// When it was asleep last. Such a thread can remain until its parent asks for its status.
  [[nodiscard]] bool has_ended() const { return has_ended_; }
  /// When it was asleep last: by a signal, so that no wait of it ends.
  [[nodiscard]] bool is_stopped() const { return is_stopped_; }

 private:
  using Turns = std::array<char, 64>;  ///< time on and in front of the processors, number of turns, as text

  [[nodiscard]] Turns read_turns() const {
    Turns turns{};
    std::array<char, 1024> buffer{};
    schedstat_.read(buffer).copy(turns.data(), turns.size());
    return turns;
  }
  /// Whether a thread with the state of a sleeper waits in a function of the kernel, so that it does not wait for a
  /// processor. Always true if this kernel does not say where threads wait.
  [[nodiscard]] bool waits_in_kernel() {
    static bool is_said = false;  // whether the kernel has said it of any thread
    if (turns_of_wait_ == turns_) {
      return true;
    }
    std::array<char, 1024> buffer{};
    const std::string_view function = wchan_.read(buffer);
    if (!function.empty() && function != "0") {
      is_said = true;
      turns_of_wait_ = turns_;
      return true;
    }
    return function.empty() || !is_said;
  }

  std::string folder_;
  File stat_;
  File wchan_;
  File schedstat_;
  bool has_ended_ = false;
  bool is_stopped_ = false;
  std::optional<Turns> noted_turns_;
  Turns turns_{};                       ///< when it was asleep last
  std::optional<Turns> turns_of_wait_;  ///< before the kernel named the function in which it waits
};

std::vector<int> numbers_in(std::string_view text) {
  std::vector<int> numbers;
  int number = 0;
  for (const char c : text) {
    if (c == ' ') {
      numbers.push_back(number);
      number = 0;
    } else {
      number = number * 10 + (c - '0');
    }
  }
  return numbers;
}

/// All threads of the descendants of this process.
class Family {
 public:
  /// Looks for new threads, if the system has started any since the last time. A thread that is being started then may
  /// have its number and not be listed yet.
  void refresh() {
    std::array<char, 1024> buffer{};
    const std::string_view load = load_.read(buffer);
    const std::string last(load.substr(load.rfind(' ') + 1));
    if (last != last_started_ || last.empty()) {
      last_started_ = last;
      list();
    }
  }
  /// Whether the thread runs that was seen running last: the one that most probably does.
  [[nodiscard]] bool runs_on() {
    const auto last = threads_.find(runner_);
    return last != threads_.end() && !last->second->is_asleep();
  }
  /// Whether all threads sleep. A thread among `restless` may have had a turn.
  [[nodiscard]] bool sleeps(const std::vector<int>& restless) {
    for (const auto& [number, thread] : threads_) {
      thread->note_turns();
    }
    if (!is_complete_) {
      last_started_.clear();
    }
    refresh();
    for (const auto& [number, thread] : threads_) {
      if (!thread->is_asleep()) {
        runner_ = number;
        return false;
      }
      if (!thread->has_noted_turns() ||
          (thread->had_a_turn() && std::find(restless.begin(), restless.end(), number) == restless.end())) {
        return false;
      }
    }
    is_complete_ = true;  // no thread was starting another one during refresh()
    return true;
  }
  /// Ends all threads.
  void kill_all() {
    last_started_.clear();
    refresh();
    for (const auto& [number, thread] : threads_) {
      kill(number, SIGKILL);  // of a thread: its process
    }
  }
  [[nodiscard]] bool has_living(int thread) const {
    const auto found = threads_.find(thread);
    return found != threads_.end() && !found->second->has_ended();
  }
  [[nodiscard]] bool has_stopped(int thread) const {
    const auto found = threads_.find(thread);
    return found != threads_.end() && found->second->is_stopped();
  }

 private:
  void list() {
    is_complete_ = false;
    std::map<int, std::unique_ptr<Thread>> threads;
    add(getpid(), threads);
    threads_.swap(threads);
  }
  /// Adds the children of a process, which are listed by the thread that started them.
  void add(int process, std::map<int, std::unique_ptr<Thread>>& threads) {
    const std::string folder = "/proc/" + std::to_string(process) + "/task";
    DIR* tasks = opendir(folder.c_str());
    if (tasks == nullptr) {
      return;  // it has ended
    }
    while (const dirent* entry = readdir(tasks)) {
      const int thread = std::atoi(entry->d_name);
      if (thread == 0) {
        continue;
      }
      if (process != getpid()) {
        const auto known = threads_.find(thread);
        threads[thread] =
            known != threads_.end() ? std::move(known->second) : std::make_unique<Thread>(process, thread);
      }
      std::array<char, 1024> buffer{};
      for (const int child : numbers_in(File(folder + "/" + entry->d_name + "/children").read(buffer))) {
        add(child, threads);
      }
    }
    closedir(tasks);
  }

  File load_{"/proc/loadavg"};  // its last word is the number of the last thread that was started
  std::string last_started_;
  bool is_complete_ = false;
  std::map<int, std::unique_ptr<Thread>> threads_;
  int runner_ = 0;  ///< thread that was seen running last
};

/// The waits with an end, and their numbers.
std::vector<std::pair<const Wait*, std::uint32_t>> pending(const SharedClock& clock) {
  std::vector<std::pair<const Wait*, std::uint32_t>> waits;
  for (const Wait& wait : clock.wait) {
    if (wait.thread.load() != 0 && wait.end_ns.load() != never) {
      waits.emplace_back(&wait, wait.number.load());
    }
  }
  return waits;
}

class Keeper {
 public:
  explicit Keeper(SharedClock& clock) : clock_(clock) {}

  /// Lets time pass if all threads wait; otherwise it waits a little itself. False if all threads wait without an end.
  [[nodiscard]] bool look() {
    const std::uint32_t waits = clock_.waits.load();
    const bool is_quiet = all_wait();
    if (is_quiet && (hand_on_terminal_writes() || pass_time())) {
      pause_ns_ = shortest_pause_ns;
      endless_looks_ = 0;
      return true;
    }
    endless_looks_ = is_quiet ? endless_looks_ + 1 : 0;
    const timespec pause{0, pause_ns_};
    pause_ns_ = std::min(2 * pause_ns_, longest_pause_ns);
    syscall(SYS_futex, &clock_.waits, FUTEX_WAIT, waits, &pause, nullptr, 0);
    return endless_looks_ < most_endless_looks;
  }

  void kill_all() { family_.kill_all(); }

 private:
  static constexpr long shortest_pause_ns = 20'000;
  static constexpr long longest_pause_ns = 200'000;
  static constexpr int most_endless_looks = 20'000;

  bool all_wait() {
    if (family_.runs_on()) {
      return false;
    }
    const auto waits = pending(clock_);
    std::vector<int> restless;  // each may have looked at the time, but waits as before
    for (const auto& [wait, number] : waits) {
      if (wait->looks_again.load()) {
        restless.push_back(wait->thread.load());
      }
    }
    return family_.sleeps(restless) && pending(clock_) == waits;
  }

  /// Has all processes with terminals poll them if any was written to since the last time; false if none was.
  bool hand_on_terminal_writes() {
    const std::uint32_t writes = clock_.terminal_writes.load();
    if (writes == handed_on_) {
      return false;
    }
    handed_on_ = writes;
    std::set<int> processes;
    for (Terminal& terminal : clock_.terminal) {
      int process = terminal.process.load();
      if (process != 0 && !family_.has_living(process)) {
        terminal.process.compare_exchange_strong(process, 0);
      } else if (process != 0) {
        processes.insert(process);
      }
    }
    ++clock_.polls_wanted;
    std::uint32_t wanted = clock_.polls_made.load();
    for (const int process : processes) {
      wanted += kill(process, wake_signal) == 0 ? 1U : 0U;
    }
    // A process that is stopped, or ends, does not poll.
    constexpr int longest_waits = 1'000;
    constexpr timespec longest_wait{0, 1'000'000};
    for (int waits = 0; waits < longest_waits; ++waits) {
      const std::uint32_t made = clock_.polls_made.load();
      if (made == wanted) {
        break;
      }
      syscall(SYS_futex, &clock_.polls_made, FUTEX_WAIT, made, &longest_wait, nullptr, 0);
    }
    return true;
  }

  /// False if no wait has an end.
  bool pass_time() {
    std::int64_t next = never;
    for (Wait& wait : clock_.wait) {
      const int thread = wait.thread.load();
      if (thread > 0 && wait.end_ns.load() != never) {
        if (!family_.has_living(thread)) {
          wait.thread = 0;  // it was killed
        } else if (!family_.has_stopped(thread)) {
          next = std::min(next, wait.end_ns.load());
        }
      }
    }
    if (next == never) {
      return false;
    }
    clock_.now_ns = std::max(next, clock_.now_ns.load());
    for (Wait& wait : clock_.wait) {
      if (wait.thread.load() > 0 && wait.end_ns.load() <= next && !wait.looks_again.load()) {
        syscall(SYS_tgkill, wait.process.load(), wait.thread.load(), wake_signal);
      }
    }
    return true;
  }

  SharedClock& clock_;
  Family family_;
  long pause_ns_ = shortest_pause_ns;
  int endless_looks_ = 0;        ///< number of looks, one after the other, at which all threads waited without an end
  std::uint32_t handed_on_ = 0;  ///< number of writes to terminals that have been handed on
};

std::int64_t read_clock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// The shared memory, in a file without a name.
SharedClock& make_clock(std::string& path) {
  const int file = memfd_create("virtual_time", 0);
  void* memory = file < 0 || ftruncate(file, sizeof(SharedClock)) != 0
                     ? MAP_FAILED
                     : mmap(nullptr, sizeof(SharedClock), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (memory == MAP_FAILED) {
    std::perror("run_in_virtual_time: shared memory");
    std::exit(1);
  }
  path = "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(file);
  auto& clock = *new (memory) SharedClock;
  clock.now_ns = read_clock(CLOCK_MONOTONIC) / 1'000 * 1'000;
  clock.calendar_offset_ns = read_clock(CLOCK_REALTIME) / 1'000 * 1'000 - clock.now_ns;
  return clock;
}

volatile std::sig_atomic_t is_ended = 0;
volatile std::sig_atomic_t has_child_ended = 0;

void end(int) { is_ended = 1; }
void note_child(int) { has_child_ended = 1; }

/// Starts the program with the library and the clock. Its process id.
int start(const char* library, const std::string& clock, char** command) {
  const int program = fork();
  if (program == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setenv(file_variable, clock.c_str(), 1);
    setenv("LD_PRELOAD", library, 1);
    execvp(command[0], command);
    std::perror(command[0]);
    _exit(127);
  }
  return program;
}

/// Lets time pass until the program ends. Its exit status.
int keep_time(Keeper& keeper, int program) {
  while (is_ended == 0) {
    if (!keeper.look()) {
      std::fputs("run_in_virtual_time: all threads wait, and no wait has an end\n", stderr);
      return 1;
    }
    if (has_child_ended == 0) {
      continue;
    }
    has_child_ended = 0;
    int status = 0;
    int ended = 0;
    while ((ended = waitpid(-1, &status, WNOHANG)) > 0 && ended != program) {
    }
    if (ended == program) {
      return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    if (ended < 0 && errno == ECHILD) {
      break;
    }
  }
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("run_in_virtual_time: found no program, expected LIBRARY PROGRAM [ARGUMENT]...\n", stderr);
    return 2;
  }
  std::string path;
  SharedClock& clock = make_clock(path);
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // processes whose parent ends become children of this one
  prctl(PR_SET_TIMERSLACK, 1);
  std::signal(SIGTERM, end);
  std::signal(SIGINT, end);
  std::signal(SIGCHLD, note_child);
  Keeper keeper(clock);
  const int program = start(argv[1], path, argv + 2);
  const int status = keep_time(keeper, program);
  keeper.kill_all();
  return status;
}
