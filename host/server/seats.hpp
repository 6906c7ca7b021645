#pragma once

// Programs of this computer that a server makes reachable for others, each below a path of its own: the seats of a
// class (docs/page-interface.md, "A class").

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "host/server/request_policy.hpp"

namespace proleg::host {

/// Number of a seat, in its path: "/robots/3/".
using SeatNumber = unsigned;

/// What a server does not know itself about the seats behind it. The server calls these functions in its own thread, so
/// they return at once.
class SeatDirectory {
 public:
  struct Seat {
    std::optional<std::uint16_t> port;  ///< on 127.0.0.1; nothing: the program does not run, or is not ready
    AccessToken token;
  };
  struct Answer {
    unsigned status = 0;
    std::string json;
  };
  /// May be called once, in any thread.
  using AnswerTo = std::function<void(Answer)>;

  virtual ~SeatDirectory() = default;

  /// Nothing: there is no such seat.
  [[nodiscard]] virtual std::optional<Seat> find(SeatNumber number) = 0;
  /// Somebody wants a seat whose program does not run.
  virtual void wake(SeatNumber number) = 0;
  /// A person's connection to a seat has begun or ended. Connections of those who only look on are not reported.
  virtual void connected(SeatNumber number) = 0;
  virtual void disconnected(SeatNumber number) = 0;
  /// POST /stop of a seat, whose token was right.
  virtual void stop(SeatNumber number) = 0;
  /// POST /join. from: the address of the computer that asks. The answer must come, also an error.
  virtual void join(const std::string& body, const std::string& from, AnswerTo answer) = 0;
};

/// The path of a request: of a seat, or of the server itself.
struct SeatPath {
  std::optional<SeatNumber> seat;
  std::string_view target;  ///< with "?..."; of a seat without its "/robots/N"
};
/// Nothing for a path that begins as that of a seat and is none, such as "/robots/03/".
[[nodiscard]] std::optional<SeatPath> seat_path(std::string_view target);

/// Whether the target has "?look": the connection is of somebody who only looks on.
[[nodiscard]] bool only_looks(std::string_view target);

/// What one computer may still send to one seat: enough for meshes and for every slider, and not enough to keep a
/// processor busy. A state machine; the time is an argument.
class SendingBudget {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Bytes that may come at once, more than the largest mesh (docs/page-interface.md, "Meshes that viewers send").
  static constexpr double most_bytes = 32.0 * 1024 * 1024;
  static constexpr double bytes_per_second = 256.0 * 1024;

  explicit SendingBudget(Time now) : time_(now) {}
  /// Takes note of bytes. Returns how long the sender must wait before the next ones.
  [[nodiscard]] std::chrono::milliseconds spend(Time now, std::size_t bytes);
  /// Whether as much may come as at the beginning.
  [[nodiscard]] bool is_full(Time now) const;

 private:
  [[nodiscard]] double left(Time now) const;

  Time time_;
  double left_ = most_bytes;  ///< at time_
};

/// The computers that are connected to seats, with their budgets.
class SeatVisitors {
 public:
  /// Of one computer to one seat.
  static constexpr unsigned max_connections = 8;

  /// A connection's part. It counts as open as long as this object exists.
  class Visit {
   public:
    explicit Visit(std::shared_ptr<std::pair<unsigned, SendingBudget>> share) : share_(std::move(share)) {
      ++share_->first;
    }
    ~Visit() { --share_->first; }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;
    [[nodiscard]] SendingBudget& budget() { return share_->second; }

   private:
    std::shared_ptr<std::pair<unsigned, SendingBudget>> share_;
  };

  /// Null: this computer has as many connections to the seat as it may have.
  [[nodiscard]] std::unique_ptr<Visit> begin(SeatNumber seat, const std::string& address, SendingBudget::Time now);

 private:
  std::map<std::pair<SeatNumber, std::string>, std::shared_ptr<std::pair<unsigned, SendingBudget>>> shares_;
};

}  // namespace proleg::host
