#include "sim/mesh/import_process.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "shared/computer/child_process/leave_parent.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/mesh/mesh_checks.hpp"

namespace proleg::sim {
namespace {

using Clock = std::chrono::steady_clock;

#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define PROLEG_HAS_SHADOW_MEMORY
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
#define PROLEG_HAS_SHADOW_MEMORY
#endif
/// AddressSanitizer reserves terabytes: a limit of the address space would end the child at once. The parent then
/// watches how much memory the child has in use.
#ifdef PROLEG_HAS_SHADOW_MEMORY
constexpr bool has_shadow_memory = true;
#else
constexpr bool has_shadow_memory = false;
#endif

// The messages of the child.
constexpr std::uint8_t asks_companion = 1;  ///< the name of a file; the parent answers with 0, or with 1 and its bytes
constexpr std::uint8_t has_mesh = 2;        ///< vertices, colours, triangles
constexpr std::uint8_t has_refusal = 3;     ///< what was found and expected

// Exit statuses of the child, which no program uses for something else.
constexpr int out_of_memory = 101;
constexpr int failed = 102;

constexpr std::size_t longest_name = 4096;       // bytes, of a path
constexpr std::size_t longest_line = 1U << 16U;  // bytes, of a message
constexpr std::chrono::milliseconds tick{20};
constexpr int sleeping_ticks = 50;  // of a child that works: a wait for the disk is another state
constexpr int attempts = 4;

// Stream has read(void*, std::size_t) and write(const void*, std::size_t), for all bytes.

template <typename Value, typename Stream>
Value receive_value(Stream& stream) {
  Value value{};
  stream.read(&value, sizeof value);
  return value;
}

template <typename Value, typename Stream>
void send_value(Stream& stream, Value value) {
  stream.write(&value, sizeof value);
}

/// A std::string or std::vector. Nothing if it has more than `most` items.
template <typename List, typename Stream>
std::optional<List> receive_list(Stream& stream, std::uint64_t most) {
  const auto size = receive_value<std::uint64_t>(stream);
  if (size > most) {
    return std::nullopt;
  }
  List list;
  list.resize(size);
  stream.read(list.data(), size * sizeof(typename List::value_type));
  return list;
}

template <typename List, typename Stream>
void send_list(Stream& stream, const List& list) {
  send_value(stream, std::uint64_t{list.size()});
  stream.write(list.data(), list.size() * sizeof(typename List::value_type));
}

/// The child's end of the socket. Without its parent the child ends.
class ChildStream {
 public:
  explicit ChildStream(int socket) : socket_(socket) {}

  void read(void* bytes, std::size_t size) const {
    for (auto* next = static_cast<char*>(bytes); size > 0;) {
      const ssize_t count = recv(socket_, next, size, 0);
      if (count == 0 || (count < 0 && errno != EINTR)) {
        _exit(failed);
      }
      next += std::max<ssize_t>(count, 0);
      size -= static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    }
  }
  void write(const void* bytes, std::size_t size) const {
    for (const auto* next = static_cast<const char*>(bytes); size > 0;) {
      const ssize_t count = ::send(socket_, next, size, MSG_NOSIGNAL);
      if (count < 0 && errno != EINTR) {
        _exit(failed);
      }
      next += std::max<ssize_t>(count, 0);
      size -= static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    }
  }

 private:
  int socket_;
};

/// Bytes of memory of a process: reserved, and in use.
struct Memory {
  std::size_t reserved = 0;
  std::size_t used = 0;
};

Memory memory_of(const std::string& process) {
  std::ifstream file("/proc/" + process + "/statm");
  Memory pages;
  file >> pages.reserved >> pages.used;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return {pages.reserved * page, pages.used * page};
}

/// Whether a process waits for a signal, another process or a lock: state S of proc(5).
bool is_asleep(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t name_end = line.rfind(')');
  return name_end != std::string::npos && line.substr(name_end).starts_with(") S");
}

void lower_limit(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
  rlimit limit{};
  getrlimit(resource, &limit);
  limit.rlim_max = std::min(limit.rlim_max, hard);
  limit.rlim_cur = std::min({limit.rlim_cur, limit.rlim_max, soft});
  setrlimit(resource, &limit);
}

/// Makes a process of its own of the child: without the parent's files, signal handlers and terminal, and with limits.
void prepare_child(int socket, pid_t parent, const Memory& before, const ImportLimits& limits) {
  for (int signal = 1; signal < NSIG; ++signal) {
    std::signal(signal, SIG_DFL);
  }
  leave_parent(std::array{socket}, parent);
  std::signal(SIGQUIT, SIG_IGN);
  if (!has_shadow_memory) {
    dup2(STDOUT_FILENO, STDERR_FILENO);  // to nowhere
  }
  prctl(PR_SET_DUMPABLE, 0);  // RLIMIT_CORE does not hold for a program that takes the cores
  lower_limit(RLIMIT_CORE, 0, 0);
  const auto seconds = static_cast<rlim_t>(limits.processor.count());
  lower_limit(RLIMIT_CPU, seconds, seconds + 1);  // at the first SIGXCPU, at the second SIGKILL
  if (!has_shadow_memory) {
    const rlim_t size = before.reserved + (limits.memory_gib << 30U);
    lower_limit(RLIMIT_AS, size, size);
  }
  // Before an exception, which Assimp might catch.
  std::set_new_handler([] { _exit(out_of_memory); });
}

template <typename Import>
[[noreturn]] void work_in_child(int socket, const Import& import) {
  ChildStream stream(socket);
  try {
    const TriangleMesh mesh = import([&stream](const std::string& name) -> std::optional<std::string> {
      if (name.size() > longest_name) {
        return std::nullopt;
      }
      send_value(stream, asks_companion);
      send_list(stream, name);
      if (receive_value<std::uint8_t>(stream) == 0) {
        return std::nullopt;
      }
      return receive_list<std::string>(stream, SIZE_MAX);
    });
    send_value(stream, has_mesh);
    send_list(stream, mesh.vertices);
    send_list(stream, mesh.colours);
    send_list(stream, mesh.triangles);
  } catch (const MeshError& error) {
    send_value(stream, has_refusal);
    send_list(stream, error.found);
    send_list(stream, error.expected);
  } catch (...) {
    _exit(failed);
  }
  // Not exit(): the child must not flush or close what the parent has open, buffered or registered.
  _exit(0);
}

/// The error for a child that another child can replace: it sleeps for sleeping_ticks and asked for nothing.
struct ChildSleeps {};

/// The child, as its parent sees it. All functions throw MeshError if the child ends or exceeds a limit, and
/// ChildSleeps if `is_last` is false.
class ImportProcess {
 public:
  template <typename Import>
  ImportProcess(const std::string& name, const ImportLimits& limits, Clock::time_point deadline, bool is_last,
                const Import& import)
      : name_(name), limits_(limits), before_(memory_of("self")), deadline_(deadline), is_last_(is_last) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw no_process(errno);
    }
    const pid_t parent = getpid();
    process_ = fork();
    if (process_ == 0) {
      prepare_child(ends[1], parent, before_, limits);
      work_in_child(ends[1], import);
    }
    const int error = errno;
    close(ends[1]);
    socket_ = ends[0];
    if (process_ < 0) {
      close(socket_);
      throw no_process(error);
    }
  }
  ~ImportProcess() {
    if (is_running_) {
      kill(process_, SIGKILL);
      take_status(0);
    }
    close(socket_);
  }
  ImportProcess(const ImportProcess&) = delete;
  ImportProcess& operator=(const ImportProcess&) = delete;

  void read(void* bytes, std::size_t size) {
    for (auto* next = static_cast<char*>(bytes); size > 0;) {
      const ssize_t count = recv(socket_, next, size, MSG_DONTWAIT);
      if (count > 0) {
        next += count;
        size -= static_cast<std::size_t>(count);
        sleeps_ = 0;
      } else {
        wait_unless_ended(count == 0 || is_broken(errno), POLLIN);
        sleeps_ = is_running_ && is_asleep(process_) ? sleeps_ + 1 : 0;
        if (sleeps_ > sleeping_ticks && !is_last_) {
          throw ChildSleeps();
        }
      }
    }
  }
  void write(const void* bytes, std::size_t size) {
    for (const auto* next = static_cast<const char*>(bytes); size > 0;) {
      const ssize_t count = ::send(socket_, next, size, MSG_DONTWAIT | MSG_NOSIGNAL);
      if (count >= 0) {
        next += count;
        size -= static_cast<std::size_t>(count);
      } else {
        wait_unless_ended(is_broken(errno), POLLOUT);
      }
    }
  }

  [[nodiscard]] MeshError refusal(const std::string& found) const {
    return {"a file " + found + ", " + in_quotes(name_), "a mesh of triangles"};
  }
  /// The error for what the child sends only after the library damaged its memory.
  [[nodiscard]] MeshError damage() const { return refusal("at which the mesh library fails"); }

 private:
  static bool is_broken(int error) { return error != EAGAIN && error != EINTR; }

  [[nodiscard]] MeshError no_process(int error) const {
    return {"no process to read " + in_quotes(name_) + " (" + std::generic_category().message(error) + ")",
            "a computer that can start one"};
  }
  [[nodiscard]] MeshError time_refusal(std::chrono::milliseconds limit) const {
    return refusal("that takes longer than " +
                   std::to_string(std::chrono::duration_cast<std::chrono::seconds>(limit).count()) + " s");
  }
  [[nodiscard]] MeshError memory_refusal() const {
    return refusal("that needs more than " + std::to_string(limits_.memory_gib) + " GiB of memory");
  }

  /// Takes the status of the child: waits for its end, or with WNOHANG looks whether it has ended.
  void take_status(int options) {
    int status = 0;
    pid_t ended = 0;
    do {
      ended = waitpid(process_, &status, options);
    } while (ended < 0 && errno == EINTR);
    if (ended != 0) {
      is_running_ = false;
      // A program that ignores SIGCHLD gets no status.
      status_ = ended > 0 ? std::optional(status) : std::nullopt;
    }
  }

  /// Waits until the socket is ready, at most one tick. is_closed: at the child's end of the socket.
  void wait_unless_ended(bool is_closed, short event) {
    if (Clock::now() >= deadline_) {
      throw time_refusal(limits_.wall);
    }
    pollfd ready{.fd = socket_, .events = event, .revents = 0};
    if (is_closed) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } else if (poll(&ready, 1, static_cast<int>(tick.count())) > 0) {
      return;
    }
    if (has_shadow_memory && memory_of(std::to_string(process_)).used > before_.used + (limits_.memory_gib << 30U)) {
      throw memory_refusal();
    }
    // The socket alone does not show the end: a child that another thread forked meanwhile may hold it too.
    if (is_running_) {
      take_status(WNOHANG);
    }
    const bool may_have_sent = !is_closed && poll(&ready, 1, 0) > 0;
    if (!is_running_ && !may_have_sent) {
      throw end_refusal();
    }
  }

  [[nodiscard]] MeshError end_refusal() const {
    if (!status_) {
      return damage();
    }
    if (WIFSIGNALED(*status_)) {
      return WTERMSIG(*status_) == SIGXCPU
                 ? time_refusal(limits_.processor)
                 : refusal("at which the mesh library ends with signal " + std::to_string(WTERMSIG(*status_)));
    }
    if (WEXITSTATUS(*status_) == out_of_memory) {
      return memory_refusal();
    }
    return refusal("at which the mesh library ends with status " + std::to_string(WEXITSTATUS(*status_)));
  }

  const std::string& name_;
  const ImportLimits& limits_;
  Memory before_;
  Clock::time_point deadline_;
  bool is_last_;
  int sleeps_ = 0;  ///< ticks of the present read() in which the child slept
  pid_t process_ = -1;
  bool is_running_ = true;
  std::optional<int> status_;
  int socket_ = -1;
};

void answer_companion(ImportProcess& process, const MeshCompanion& companion) {
  const std::optional<std::string> name = receive_list<std::string>(process, longest_name);
  if (!name) {
    throw process.damage();
  }
  const std::optional<std::string> bytes = companion(*name);
  send_value(process, static_cast<std::uint8_t>(bytes ? 1 : 0));
  if (bytes) {
    send_list(process, *bytes);
  }
}

MeshError received_refusal(ImportProcess& process) {
  const std::optional<std::string> found = receive_list<std::string>(process, longest_line);
  if (!found) {
    return process.damage();
  }
  const std::optional<std::string> expected = receive_list<std::string>(process, longest_line);
  return expected ? MeshError(one_line(*found), one_line(*expected)) : process.damage();
}

/// The child may have damaged its memory: nothing in the mesh is trusted.
TriangleMesh received_mesh(ImportProcess& process) {
  const auto list = [&process]<typename Item>(std::vector<Item>& items, std::size_t most) {
    std::optional<std::vector<Item>> received = receive_list<std::vector<Item>>(process, most);
    if (!received) {
      throw process.damage();
    }
    items = std::move(*received);
  };
  TriangleMesh mesh;
  list(mesh.vertices, max_mesh_vertices);
  list(mesh.colours, mesh.vertices.size());
  list(mesh.triangles, max_triangles);
  const auto is_finite = [](const auto& each) { return each.allFinite(); };
  const auto is_in_range = [&mesh](const std::array<std::uint32_t, 3>& triangle) {
    return std::ranges::max(triangle) < mesh.vertices.size();
  };
  if (mesh.triangles.empty() || (!mesh.colours.empty() && mesh.colours.size() != mesh.vertices.size()) ||
      !std::ranges::all_of(mesh.vertices, is_finite) || !std::ranges::all_of(mesh.colours, is_finite) ||
      !std::ranges::all_of(mesh.triangles, is_in_range)) {
    throw process.damage();
  }
  return mesh;
}

TriangleMesh mesh_of(ImportProcess& process, const MeshCompanion& companion, const ImportLimits& limits) {
  for (std::size_t companions = 0;;) {
    switch (receive_value<std::uint8_t>(process)) {
      case asks_companion:
        if (++companions > limits.companions) {
          throw process.refusal("that names more than " + std::to_string(limits.companions) + " other files");
        }
        answer_companion(process, companion);
        break;
      case has_mesh:
        return received_mesh(process);
      case has_refusal:
        throw received_refusal(process);
      default:
        throw process.damage();
    }
  }
}

}  // namespace

TriangleMesh import_in_child(const std::string& name, const MeshCompanion& companion,
                             const std::function<TriangleMesh(const MeshCompanion& companion)>& import,
                             const ImportLimits& limits) {
  const Clock::time_point deadline = Clock::now() + limits.wall;
  for (int attempt = 1;; ++attempt) {
    try {
      ImportProcess process(name, limits, deadline, attempt == attempts, import);
      return mesh_of(process, companion, limits);
    } catch (const ChildSleeps&) {
      // Another thread held a lock at the fork().
    }
  }
}

}  // namespace proleg::sim
