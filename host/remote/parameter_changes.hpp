#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "host/remote/parameter_motion.hpp"
#include "host/remote/remote_target.hpp"

namespace proleg::host {

/// Changes of parameters on their way to the robot: at most 50 a second, one at a time, each with the newest values.
/// So a robot that is slow to answer has no queue of old ones.
class ParameterChanges {
 public:
  static constexpr RemoteTime shortest_period{20};
  /// A pause of this length ends a gesture: what moves later is another entry for undo.
  static constexpr RemoteTime gesture_pause{500};
  /// After this time an answer is no longer expected.
  static constexpr RemoteTime answer_timeout{1000};

  explicit ParameterChanges(RemoteTarget& target) : target_(target) {}

  void want(RemoteTime now, const ParameterMotion::Value& value);
  /// Forgets what has not been sent.
  void clear() { pending_.clear(); }
  void answered() { sent_unanswered_.reset(); }
  void advance(RemoteTime now);
  /// When advance() has something to do; nothing: not before the next call.
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
