#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "host/remote/parameter_motion.hpp"
#include "host/remote/remote_target.hpp"

namespace proleg::host {

/// Sends changes of parameters to the robot: at most 50 a second, one at a time, each with the newest values, so that
/// no old changes queue up for a robot that answers slowly.
class ParameterChanges {
 public:
  static constexpr RemoteTime shortest_period{20};
  /// A pause of this length ends a gesture; a later movement is another entry for undo.
  static constexpr RemoteTime gesture_pause{500};
  /// After this time an answer is no longer expected.
  static constexpr RemoteTime answer_timeout{1000};

  explicit ParameterChanges(RemoteTarget& target) : target_(target) {}

  void want(RemoteTime now, const ParameterMotion::Value& value);
  /// Forgets changes that have not been sent.
  void clear() { pending_.clear(); }
  void answered() { sent_unanswered_.reset(); }
  void advance(RemoteTime now);
  /// Time at which advance() has something to do; nothing if it has nothing to do before the next change.
  [[nodiscard]] std::optional<RemoteTime> due() const;

 private:
  [[nodiscard]] RemoteTime next_set() const;

  RemoteTarget& target_;
  std::map<std::string, double> pending_;
  std::optional<RemoteTime> wanted_at_;
  std::optional<RemoteTime> sent_at_;
  std::optional<RemoteTime> sent_unanswered_;
  std::uint64_t gesture_ = 0;
};

}  // namespace proleg::host
