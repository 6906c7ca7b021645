#pragma once

// Programs of their own that viewers have started, such as searches and sweeps: each has a folder, and in it a file
// that it writes under a lock (sim/optimize/evaluation/store_file.hpp).

#include <chrono>
#include <filesystem>
#include <functional>
#include <list>
#include <string>
#include <string_view>
#include <vector>

#include "host/server/robot_session.hpp"
#include "tools/proleg/common/detached_program.hpp"
#include "tools/proleg/ui/seat_limits.hpp"

namespace proleg::tools {

class BegunPrograms {
 public:
  using Clock = std::chrono::steady_clock;

  struct Kind {
    std::string what;     ///< "search", for messages
    std::string written;  ///< name of the file that it writes
    std::string log;      ///< name of the file with what it prints
    /// Why the program in this folder has failed; empty: it does not say.
    std::function<std::string(const std::filesystem::path& folder)> failure;
    /// Whether it has left anything there that is worth keeping.
    std::function<bool(const std::filesystem::path& folder)> has_results;
    /// One that does not begin in this time is not waited for any more.
    std::chrono::seconds longest_start;
  };

  /// share, output: must outlive this.
  BegunPrograms(Kind kind, ProgramShare& share, host::SessionOutput& output)
      : kind_(std::move(kind)), share_(share), output_(output) {}

  /// Starts a program, if the share has room for it. The request is answered with the name when it has begun, or
  /// refused. directory: in which it runs. is_new: the folder is removed if it does not begin. Throws
  /// std::runtime_error.
  void begin(host::RequestId request, const std::string& name, const std::filesystem::path& folder, bool is_new,
             const std::vector<std::string>& command, const std::filesystem::path& directory);
  /// Answers those that have begun, or have failed to. Returns whether one has begun.
  bool look();
  /// Whether one has been started in this folder, and has not begun yet.
  [[nodiscard]] bool begins(const std::filesystem::path& folder) const;
  /// Has it stop, when it begins. Returns false if none with this name has been started.
  bool stop(const std::string& name);
  void refuse_all(const std::string& why);
  /// The program ends: nobody is left who would stop those that are to stop.
  void close();

  /// Whether a request waits for its answer.
  [[nodiscard]] bool has_waiting() const;
  [[nodiscard]] bool is_empty() const { return beginnings_.empty() && running_.empty(); }
  [[nodiscard]] const ProgramShare& share() const { return share_; }

 private:
  struct Beginning {
    host::RequestId request;
    std::string name;
    std::filesystem::path folder;
    DetachedProgram program;
    Clock::time_point until;
    bool is_new;
    bool stops = false;        ///< a viewer has asked it to stop meanwhile
    bool is_answered = false;  ///< it is late: the request was refused
  };

  struct Running {
    DetachedProgram program;
    std::filesystem::path written;
  };

  [[nodiscard]] std::filesystem::path written_in(const std::filesystem::path& folder) const;
  /// Whether it has begun, or has failed to.
  bool look_at(Beginning& beginning, bool& has_begun);
  /// Why one has not begun whose program has ended with this status.
  [[nodiscard]] std::string refusal_of(const std::filesystem::path& folder, int status) const;

  Kind kind_;
  ProgramShare& share_;
  host::SessionOutput& output_;
  std::list<Beginning> beginnings_;
  std::list<Running> running_;  ///< whose end must be taken note of
};

/// Makes a new folder in the folder `parent` of a project, which is made if there is none. Throws InputError for
/// `name`, or FileError.
[[nodiscard]] std::filesystem::path make_new_folder(const std::filesystem::path& parent, const std::string& name);

}  // namespace proleg::tools
