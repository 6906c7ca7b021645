#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/remote/binding.hpp"
#include "host/remote/element.hpp"
#include "host/remote/remote_target.hpp"

namespace proleg::host {

/// The value for a position of an element, before it is rounded to steps.
[[nodiscard]] double linear_value(const ParameterBinding& binding, ElementKind kind, double position);
/// Rounded to whole steps from `lower`, at most `upper`.
[[nodiscard]] double stepped_value(const ParameterBinding& binding, double value);

/// An element that moves parameters.
class ParameterMotion {
 public:
  struct Value {
    std::string parameter;
    double value;
  };

  ParameterMotion(ParameterBinding binding, ElementKind kind) : binding_(std::move(binding)), kind_(kind) {}

  /// The element is here, without having been moved: it has no effect.
  void place(double position);
  /// The element has been moved. Returns what it now wants: nothing unless the stepped value is another one. begins: it
  /// rested before; a parameter that has another value than the element gave it does not follow the element any more.
  [[nodiscard]] std::vector<Value> move(double position, bool begins, const RemoteTarget& target);
  /// The element has to take all parameters up again.
  void let_go();

  [[nodiscard]] std::optional<double> value() const { return value_; }
  /// Whether each parameter follows the element.
  [[nodiscard]] std::vector<bool> taken() const;

 private:
  struct Follower {
    bool is_taken = false;
    double sent = 0;
  };

  /// True: the stepped value is another one.
  bool step_to(double position);

  ParameterBinding binding_;
  ElementKind kind_;
  std::optional<double> value_;
  std::vector<Follower> followers_ = std::vector<Follower>(binding_.parameters.size());
};

}  // namespace proleg::host
