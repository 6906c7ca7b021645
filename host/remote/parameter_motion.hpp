#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/remote/binding.hpp"
#include "host/remote/device_listener.hpp"
#include "host/remote/remote_target.hpp"

namespace proleg::host {

/// The value for a position of an element, before it is rounded to steps.
[[nodiscard]] double linear_value(const ParameterBinding& binding, ElementKind kind, double position);
/// The value rounded to whole steps from `lower`, at most `upper`.
[[nodiscard]] double stepped_value(const ParameterBinding& binding, double value);

/// The binding of an element to the parameters that it changes.
class ParameterMotion {
 public:
  struct Value {
    std::string parameter;
    double value;
  };

  ParameterMotion(ParameterBinding binding, ElementKind kind) : binding_(std::move(binding)), kind_(kind) {}

  /// Notes the position of an element that has not been moved; it has no effect.
  void place(double position);
  /// Notes that the element has been moved. Returns the values that it requests: nothing unless the stepped value has
  /// changed. begins: the element rested before; a parameter whose value differs from the one that the element gave it
  /// no longer follows the element.
  [[nodiscard]] std::vector<Value> move(double position, bool begins, const RemoteTarget& target);
  /// Detaches the element from all parameters until it has passed their values again.
  void let_go();

  [[nodiscard]] std::optional<double> value() const { return value_; }
  /// Whether each parameter follows the element.
  [[nodiscard]] std::vector<bool> taken() const;

 private:
  struct Follower {
    bool is_taken = false;
    double sent = 0;
  };

  /// Sets the stepped value for a position. Returns whether it has changed.
  bool step_to(double position);

  ParameterBinding binding_;
  ElementKind kind_;
  std::optional<double> value_;
  std::vector<Follower> followers_ = std::vector<Follower>(binding_.parameters.size());
};

}  // namespace proleg::host
