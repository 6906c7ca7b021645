#include "sim/optimize/evaluation/message.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <concepts>
#include <string>
#include <system_error>
#include <utility>

namespace proleg::optimize {
namespace {

class Writer {
 public:
  template <std::unsigned_integral Integer>
  void write(Integer value) {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      bytes_.push_back(static_cast<std::byte>(value >> (8 * i)));
    }
  }
  void write(double value) { write(std::bit_cast<std::uint64_t>(value)); }
  void write(bool value) { bytes_.push_back(std::byte{value}); }
  void write(const std::string& text) {
    write(text.size());
    const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void write(const Candidate& candidate) {
    write(candidate.size());
    for (const std::uint32_t index : candidate) {
      write(index);
    }
  }

  [[nodiscard]] Bytes release() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

/// After the end of the bytes or an invalid value, every value reads as 0 or empty, and ok() is false.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <std::unsigned_integral Integer>
  void read(Integer& value) {
    value = 0;
    const std::span<const std::byte> bytes = next_bytes(sizeof value);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value |= static_cast<Integer>(std::to_integer<Integer>(bytes[i]) << (8 * i));
    }
  }
  void read(double& value) {
    std::uint64_t pattern = 0;
    read(pattern);
    value = std::bit_cast<double>(pattern);
  }
  void read(bool& value) {
    const std::span<const std::byte> bytes = next_bytes(1);
    value = !bytes.empty() && bytes[0] == std::byte{1};
    ok_ = ok_ && (value || bytes[0] == std::byte{0});
  }
  void read(std::string& text) {
    const std::span<const std::byte> bytes = next_bytes(read_count(1));
    text.clear();
    for (const std::byte byte : bytes) {
      text.push_back(std::to_integer<char>(byte));
    }
  }
  void read(Candidate& candidate) {
    candidate.resize(read_count(sizeof(std::uint32_t)));
    for (std::uint32_t& index : candidate) {
      read(index);
    }
  }

  /// A number of items that fits the rest of the bytes, so that a wrong one allocates no memory.
  std::size_t read_count(std::size_t item_size) {
    std::uint64_t count = 0;
    read(count);
    ok_ = ok_ && count <= rest_.size() / item_size;
    return ok_ ? count : 0;
  }

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] bool finished() const { return ok_ && rest_.empty(); }

 private:
  std::span<const std::byte> next_bytes(std::size_t count) {
    if (!ok_ || count > rest_.size()) {
      ok_ = false;
      return {};
    }
    const std::span<const std::byte> bytes = rest_.first(count);
    rest_ = rest_.subspan(count);
    return bytes;
  }

  std::span<const std::byte> rest_;
  bool ok_ = true;
};

// The order of the fields, for writing and reading: `field` is called for each.

template <typename Visit, typename TaskType>
void each_field(TaskType& task, const Visit& field) {
  field(task.run);
  field(task.number);
  field(task.trial);
  field(task.candidate);
}

template <typename Visit, typename ResultType>
void each_result_field(ResultType& result, const Visit& field) {
  for (auto& value : result.measures.all()) {
    field(value);
  }
  field(result.simulated_s);
  field(result.wall_s);
  field(result.given_up);
  field(result.failure);
  field(result.limited_joints);
}

void write_item(Writer& writer, const Task& task) {
  each_field(task, [&](const auto& value) { writer.write(value); });
  writer.write(task.hopeless_below.has_value());
  writer.write(task.hopeless_below.value_or(0.0));
}

void read_item(Reader& reader, Task& task) {
  each_field(task, [&](auto& value) { reader.read(value); });
  bool has_limit = false;
  double hopeless_below = 0.0;
  reader.read(has_limit);
  reader.read(hopeless_below);
  if (has_limit) {
    task.hopeless_below = hopeless_below;
  }
}

void write_item(Writer& writer, const TrialResult& result) {
  each_result_field(result, [&](const auto& value) { writer.write(value); });
}

void read_item(Reader& reader, TrialResult& result) {
  each_result_field(result, [&](auto& value) { reader.read(value); });
}

template <typename Item>
Bytes bytes_of(std::span<const Item> items) {
  Writer writer;
  writer.write(items.size());
  for (const Item& item : items) {
    write_item(writer, item);
  }
  return writer.release();
}

template <typename Item>
std::optional<std::vector<Item>> items_from(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  std::vector<Item> items;
  for (std::size_t left = reader.read_count(1); left > 0 && reader.ok(); --left) {
    read_item(reader, items.emplace_back());
  }
  return reader.finished() ? std::optional(std::move(items)) : std::nullopt;
}

/// Bytes. The largest batch of candidates with the most dimensions takes a quarter of a million; the system's default
/// is less.
constexpr int max_message = 400'000;

}  // namespace

Bytes to_bytes(std::span<const Task> tasks) { return bytes_of(tasks); }
Bytes to_bytes(std::span<const TrialResult> results) { return bytes_of(results); }

std::optional<std::vector<Task>> tasks_from(std::span<const std::byte> bytes) { return items_from<Task>(bytes); }
std::optional<std::vector<TrialResult>> results_from(std::span<const std::byte> bytes) {
  return items_from<TrialResult>(bytes);
}

std::pair<int, int> make_message_sockets() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "opening a socket");
  }
  for (const int end : ends) {
    if (setsockopt(end, SOL_SOCKET, SO_SNDBUF, &max_message, sizeof max_message) != 0) {
      const int error = errno;
      std::ranges::for_each(ends, close);
      throw std::system_error(error, std::generic_category(), "giving a socket its room");
    }
  }
  return {ends[0], ends[1]};
}

Bytes receive_message(int socket) {
  while (true) {
    std::byte none{};
    const ssize_t size = recv(socket, &none, 1, MSG_PEEK | MSG_TRUNC);
    if (size > 0) {
      Bytes message(static_cast<std::size_t>(size));
      const ssize_t received = recv(socket, message.data(), message.size(), 0);
      if (received == size) {
        return message;
      }
    } else if (size == 0 || errno != EINTR) {
      return {};
    }
  }
}

bool send_message(int socket, const Bytes& message) {
  ssize_t sent = -1;
  do {
    sent = ::send(socket, message.data(), message.size(), MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent < 0 && errno == EMSGSIZE) {
    throw std::system_error(errno, std::generic_category(),
                            "sending " + std::to_string(message.size()) + " bytes to a process");
  }
  return sent == static_cast<ssize_t>(message.size());
}

}  // namespace proleg::optimize
