#include "gdb_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <array>
#include <fstream>
#include <stdexcept>

namespace proleg::sim {

GdbProcess::GdbProcess(const std::string& image, unsigned port, const std::vector<std::string>& commands) {
  std::vector<std::string> words{PROLEG_GDB, "-nx", "-nh", "-q", "-batch"};
  const auto execute = [&](const std::string& command) {
    words.emplace_back("-ex");
    words.push_back(command);
  };
  execute("set confirm off");
  execute("set pagination off");
  execute("set width 0");
  execute("set remotetimeout 300");  // 2 s are little for a server that waits for a processor
  words.push_back(image);
  execute("target remote 127.0.0.1:" + std::to_string(port));
  for (const std::string& command : commands) {
    execute(command);
  }
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  pipe_ = ends[0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  const int error = posix_spawn(&process_, PROLEG_GDB, &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error != 0) {
    close(pipe_);
    throw std::runtime_error(PROLEG_GDB ": cannot be started");
  }
  reader_ = std::thread([this] {
    std::array<char, 4096> bytes{};
    ssize_t length = 0;
    while ((length = read(pipe_, bytes.data(), bytes.size())) > 0) {
      output_.append(bytes.data(), static_cast<std::size_t>(length));
    }
    ended_ = true;
  });
}

GdbProcess::~GdbProcess() {
  kill();
  if (reader_.joinable()) {
    reader_.join();
  }
  waitpid(process_, nullptr, 0);
  close(pipe_);
}

void GdbProcess::interrupt() const { ::kill(process_, SIGINT); }

bool GdbProcess::is_waiting() const {
  // The state follows the name of the program, which is in parentheses (proc(5)).
  std::ifstream file("/proc/" + std::to_string(process_) + "/stat");
  std::string text;
  std::getline(file, text);
  const std::size_t name_end = text.rfind(") ");
  return name_end != std::string::npos && text.compare(name_end + 2, 1, "S") == 0;
}

void GdbProcess::kill() const { ::kill(process_, SIGKILL); }

const std::string& GdbProcess::output() {
  if (reader_.joinable()) {
    reader_.join();
  }
  return output_;
}

}  // namespace proleg::sim
