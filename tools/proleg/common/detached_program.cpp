#include "tools/proleg/common/detached_program.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "tools/proleg/common/program_start.hpp"

namespace proleg::tools {

DetachedProgram::DetachedProgram(const std::vector<std::string>& command, const std::string& folder,
                                 const std::filesystem::path& log) {
  const int output = open(log.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (output < 0) {
    throw std::runtime_error(log.string() + ": cannot be written: " + std::strerror(errno));
  }
  try {
    process_ = start_program(command, {folder, output, output, ProgramStart::Life::its_own});
  } catch (...) {
    close(output);
    throw;
  }
  close(output);
}

std::optional<int> DetachedProgram::status() {
  int status = 0;
  if (!status_ && waitpid(process_, &status, WNOHANG) == process_) {
    status_ = exit_status_of(status);
  }
  return status_;
}

void DetachedProgram::interrupt() const { kill(process_, SIGINT); }

}  // namespace proleg::tools
