#pragma once

// The signals of a robot that viewers can subscribe to, and the newest rows of their values.

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
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

/// The values of a row that a viewer receives.
struct Subscription {
  std::uint32_t number = 0;
  std::uint64_t generation = 0;  ///< generation of the history whose rows `columns` describes
  std::vector<SignalColumns> columns;
};

/// The position up to which a viewer has read.
struct HistoryCursor {
  std::uint64_t next = 0;  ///< number of the next row to read, counted from the first row
  struct Row {
    std::uint16_t run = 0;
    std::uint32_t tick = 0;
  };
  std::optional<Row> last;  ///< the last row that was read
  bool has_gap = false;     ///< rows are missing that no message has reported
};

inline constexpr std::size_t telemetry_header_bytes = 16;
inline constexpr std::size_t max_telemetry_rows = 64;

/// The newest rows of all signals, in bounded memory. All functions may be called from any thread.
class TickHistory {
 public:
  explicit TickHistory(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Forgets all rows; from now on a row has this many values. Returns the new generation.
  std::uint64_t reset(std::size_t row_size);
  /// Adds a row. Throws std::invalid_argument if it has another number of values.
  void add(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row);

  /// Number of rows that were ever added.
  [[nodiscard]] std::uint64_t end() const;
  /// Number of the newest present row; end() if there is none.
  [[nodiscard]] std::uint64_t newest() const;
  /// Greatest number of rows that the memory holds.
  [[nodiscard]] std::size_t capacity() const;

  /// Makes a binary message (docs/page-interface.md, "Telemetry") with rows of one run from the cursor on, and moves
  /// the cursor behind the last of them. It contains only ticks that are multiples of `stride` (at least 1). Returns
  /// nothing if there is no such row, or if the subscription is for another generation.
  [[nodiscard]] std::optional<std::string> encode_rows(const Subscription& subscription, std::uint32_t stride,
                                                       HistoryCursor& cursor) const;

 private:
  using Row = HistoryCursor::Row;

  [[nodiscard]] std::size_t position(std::uint64_t number) const {
    return static_cast<std::size_t>(number % rows_.size());
  }

  const std::size_t max_bytes_;
  mutable std::mutex mutex_;
  std::uint64_t generation_ = 0;
  std::size_t row_size_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t begin_ = 0;
  std::vector<Row> rows_;             ///< a ring: row number n is at n modulo its size
  std::vector<std::int32_t> values_;  ///< row_size_ values for each row of the ring
};

}  // namespace proleg::host
