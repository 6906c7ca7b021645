#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/server/server_types.hpp"

namespace proleg::host {

/// The right of one viewer to drive (docs/page-interface.md, "The lease"). A state machine: what time does, advance()
/// does, and every other call does it first.
class ControlLease {
 public:
  /// A holder that does not answer a request for so long has granted it.
  static constexpr ServerTime answer_timeout{10'000};
  /// A holder is away if it gave no sign of life for so long.
  static constexpr ServerTime away_timeout{1'000};

  /// The result of an operation, decided now or some calls later.
  struct Result {
    ClientId client = 0;
    std::uint64_t operation = 0;
    std::string error;  ///< empty: done
  };

  void take(ServerTime now, ClientId client, const std::string& name, std::uint64_t operation);
  void answer(ServerTime now, ClientId client, std::uint64_t epoch, std::uint64_t operation, bool is_granted);
  void release(ServerTime now, ClientId client, std::uint64_t epoch, std::uint64_t operation);
  /// A sign of life. `age`: time since the viewer's main thread was last seen.
  void beat(ServerTime now, ClientId client, double age_ms);
  /// The viewer has gone. Its own request has no result.
  void leave(ServerTime now, ClientId client);
  void advance(ServerTime now);
  /// When advance() has something to do, if nothing happens before.
  [[nodiscard]] ServerTime deadline() const;

  /// Why an operation of a viewer that names this epoch is refused; empty if it is allowed.
  [[nodiscard]] std::string refusal(ClientId client, std::uint64_t epoch) const;
  [[nodiscard]] bool has_holder() const { return holder_.has_value(); }
  [[nodiscard]] bool is_away() const { return is_away_; }
  [[nodiscard]] std::uint64_t epoch() const { return epoch_; }

  /// The document `control`. It changes with revision(), except for the time that a request has left.
  [[nodiscard]] nlohmann::json document(ServerTime now) const;
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// The results since the last call.
  [[nodiscard]] std::vector<Result> take_results() { return std::exchange(results_, {}); }

 private:
  struct Party {
    ClientId client = 0;
    std::string name;
  };
  struct Request {
    Party from;
    std::uint64_t operation = 0;
    ServerTime deadline{};
  };

  [[nodiscard]] bool is_held_by(ClientId client) const { return holder_ && holder_->client == client; }
  void finish(ClientId client, std::uint64_t operation, std::string error = {});
  /// Nobody holds it any more, or whoever asked for it.
  void vacate(ServerTime now);
  void begin_epoch(ServerTime now, Party holder);

  std::uint64_t epoch_ = 0;
  std::optional<Party> holder_;
  bool is_away_ = false;
  ServerTime last_sign_{};
  std::optional<Request> request_;
  std::uint64_t revision_ = 1;
  std::vector<Result> results_;
};

}  // namespace proleg::host
