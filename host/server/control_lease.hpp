#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/server/robot_session.hpp"

namespace proleg::host {

/// The right of one viewer to drive (docs/page-interface.md, "The lease"). A state machine: advance() performs the
/// changes that are due at a time, and every other call does so first.
class ControlLease {
 public:
  /// Duration after which a holder that does not answer a request has granted it.
  static constexpr ServerTime answer_timeout{10'000};
  /// Duration without a sign of life after which a holder is away: what it drives is at rest a second later
  /// (docs/safety.md).
  static constexpr ServerTime away_timeout{400};
  /// Duration since its main thread was active from which on a sign of life does not count: a page stands still for a
  /// moment now and then.
  static constexpr ServerTime longest_pause{500};

  /// The result of an operation, decided now or some calls later.
  struct Result {
    ClientId client = 0;
    std::uint64_t operation = 0;
    std::string error;  ///< empty: the operation was done
  };

  void take(ServerTime now, ClientId client, const std::string& name, std::uint64_t operation);
  /// Gives the lease to a viewer that has requested no operation, if nobody has it or the
  /// holder is away. There is no result.
  void give(ServerTime now, ClientId client, const std::string& name);
  void answer(ServerTime now, ClientId client, std::uint64_t epoch, std::uint64_t operation, bool is_granted);
  void release(ServerTime now, ClientId client, std::uint64_t epoch, std::uint64_t operation);
  /// Receives a sign of life. age_ms: time since the viewer's main thread was last active.
  void beat(ServerTime now, ClientId client, double age_ms);
  /// Notes that the viewer has gone. Its own request gets no result.
  void leave(ServerTime now, ClientId client);
  void advance(ServerTime now);
  /// The time at which advance() must be called, if no other function is called before.
  [[nodiscard]] ServerTime deadline() const;

  /// The reason why an operation of a viewer that names this epoch is refused; empty if it is allowed.
  [[nodiscard]] std::string refusal(ClientId client, std::uint64_t epoch) const;
  [[nodiscard]] bool has_holder() const { return holder_.has_value(); }
  [[nodiscard]] bool is_away() const { return is_away_; }
  [[nodiscard]] std::uint64_t epoch() const { return epoch_; }

  /// The document `control`. It changes only with revision(), except for the time that a request has left.
  [[nodiscard]] nlohmann::json document(ServerTime now) const;
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// Takes the results since the last call.
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
  /// Ends the holder's lease; the viewer that has requested it, if any, gets it.
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
