#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::host {

/// The part of the robot to which one value of a signal belongs.
enum class SignalOf { joint, link, robot };

/// Values of one kind, of which a row has `count`, one behind the other. value = raw * scale, in `unit`.
struct Signal {
  std::string name;
  std::string unit;
  double scale = 1;
  std::size_t count = 0;
  SignalOf of = SignalOf::joint;
};

/// The raw value that means "no value".
inline constexpr std::int32_t no_value = INT32_MIN;

/// Position of a signal's values in a row.
struct SignalColumns {
  std::size_t offset = 0;
  std::size_t count = 0;
};

/// The signals of a row, in their order.
class SignalLayout {
 public:
  /// Has no signals.
  SignalLayout() = default;
  /// Makes the layout of these signals. Throws std::invalid_argument if two signals have the same name.
  explicit SignalLayout(std::vector<Signal> signals);

  /// Number of int32 values in a row.
  [[nodiscard]] std::size_t row_size() const { return row_size_; }
  /// The hash of the layout: two different layouts have the same one with a probability of 2^-32.
  [[nodiscard]] std::uint32_t hash() const { return hash_; }
  /// The columns of a signal; null if there is no such signal.
  [[nodiscard]] const SignalColumns* find(std::string_view name) const;
  /// The document `telemetry`. tick_us: duration of a tick in microseconds.
  [[nodiscard]] nlohmann::json document(std::uint32_t tick_us) const;

 private:
  std::vector<Signal> signals_;
  std::vector<SignalColumns> columns_;
  std::size_t row_size_ = 0;
  std::uint32_t hash_ = 0;
};

}  // namespace proleg::host
