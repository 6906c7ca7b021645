#pragma once

#include <map>
#include <optional>

#include "host/remote/device_listener.hpp"
#include "host/remote/remote_target.hpp"

namespace proleg::host {

/// "Move it now": finds the element that a person moves clearly. It does so once.
class ElementLearning {
 public:
  static constexpr RemoteTime time_limit{10'000};
  /// Half of the way from the middle to an end: not a stick that trembles.
  static constexpr double clear_movement = 0.5;

  explicit ElementLearning(RemoteTime now) : ends_(now + time_limit) {}

  /// Where an element was when it was first seen since then.
  void place(const ElementPlace& element, double position) { starts_.try_emplace(element, position); }
  /// True: this is the element.
  [[nodiscard]] bool is_moved(const ElementPlace& element, double position);
  [[nodiscard]] RemoteTime ends() const { return ends_; }

 private:
  RemoteTime ends_;
  std::map<ElementPlace, double> starts_;
};

}  // namespace proleg::host
