#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::host {

/// What one value of a signal belongs to.
enum class SignalOf { joint, link, robot };

/// Values of one kind: a row has `count` of them, one behind the other. value = raw * scale, in `unit`.
struct Signal {
  std::string name;
  std::string unit;
  double scale = 1;
  std::size_t count = 0;
  SignalOf of = SignalOf::joint;
};

/// The raw value that stands for none.
inline constexpr std::int32_t no_value = INT32_MIN;

/// Position of a signal's values in a row.
struct SignalColumns {
  std::size_t offset = 0;
  std::size_t count = 0;
};

/// The signals of a row, in their order.
class SignalLayout {
 public:
  /// No signals.
  SignalLayout() = default;
  /// Throws std::invalid_argument if two signals have one name.
  explicit SignalLayout(std::vector<Signal> signals);

  /// Number of int32 values in a row.
  [[nodiscard]] std::size_t row_size() const { return row_size_; }
  /// 32 bits that differ, but for a chance of 2^-32, if two layouts differ.
  [[nodiscard]] std::uint32_t hash() const { return hash_; }
  /// Null: there is no such signal.
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
