// Several programs that start to record into one file at the same moment.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <map>
#include <vector>

#include "sim/record/recording.hpp"
#include "small_run.hpp"

namespace proleg::sim {
namespace {

enum class Outcome : char { recording = 'r', refused = 'f', other_error = 'e' };

constexpr int programs = 6;

/// Two ends of a pipe, closed at the end.
struct Pipe {
  Pipe() { EXPECT_EQ(pipe(ends.data()), 0); }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(std::size_t end) {
    if (ends[end] >= 0) {
      close(ends[end]);
      ends[end] = -1;
    }
  }
  std::array<int, 2> ends{};
};

/// The child process: waits for the end of `start`, opens a recorder, reports, waits for the end of `stop`, records.
[[noreturn]] void record_when_started(const std::filesystem::path& path, Pipe& start, Pipe& stop, Pipe& report) {
  start.close_end(1);
  stop.close_end(1);
  const auto wait_for_end_of = [](const Pipe& pipe) {
    char byte = 0;
    static_cast<void>(!read(pipe.ends[0], &byte, 1));
  };
  const auto send = [&report](Outcome outcome) { static_cast<void>(!write(report.ends[1], &outcome, 1)); };
  const Scenario scenario = small_scenario();
  wait_for_end_of(start);
  try {
    Recorder recorder(path, scenario, "test", "build");
    send(Outcome::recording);
    wait_for_end_of(stop);
    run_small(scenario, 20, [&](const TickSample& sample, const Change* /*change*/) { recorder.record_tick(sample); });
    recorder.finish({});
  } catch (const FileError& error) {
    const bool refused =
        std::string(error.what()).find("another program is recording into this file") != std::string::npos;
    send(refused ? Outcome::refused : Outcome::other_error);
    _exit(2);
  }
  _exit(0);
}

/// Starts the programs and lets the recorders finish when all have reported. Gives the number of each outcome.
std::map<Outcome, int> record_in_parallel(const std::filesystem::path& path) {
  Pipe start;
  Pipe stop;
  Pipe report;
  std::vector<pid_t> children;
  for (int i = 0; i < programs; ++i) {
    children.push_back(fork());
    if (children.back() == 0) {
      record_when_started(path, start, stop, report);
    }
  }
  start.close_end(1);
  std::map<Outcome, int> outcomes;
  for (int i = 0; i < programs; ++i) {
    Outcome outcome{};
    EXPECT_EQ(read(report.ends[0], &outcome, 1), 1);
    ++outcomes[outcome];
  }
  stop.close_end(1);
  int finished = 0;
  for (const pid_t child : children) {
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    finished += WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 1 : 0;
  }
  EXPECT_EQ(finished, 1) << "the recorder that claimed the file came to its end";
  return outcomes;
}

TEST(ParallelRecorders, OneRecordsAndAllOthersAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "run.sqlite";
  for (int round = 0; round < 21; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    if (round % 3 == 0) {  // no file; later an empty one, and the recording of the round before
      std::filesystem::remove(path);
    } else if (round % 3 == 1) {
      std::ofstream(path).flush();
    }
    const std::map<Outcome, int> expected{{Outcome::recording, 1}, {Outcome::refused, programs - 1}};
    ASSERT_EQ(record_in_parallel(path), expected);
    const Recording recording(path);
    EXPECT_TRUE(recording.finished());
    EXPECT_EQ(recording.last_tick(), 19U);
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"run.sqlite"}));
  }
}

}  // namespace
}  // namespace proleg::sim
