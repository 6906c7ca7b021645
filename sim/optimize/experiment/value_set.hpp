#pragma once

// The values that a dimension may take, as decimal numbers, and what becomes of them in a module. All of it is whole
// numbers, so that lo + n step is the number that a person would write, whatever n is.

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/fixed/unit.hpp"

namespace proleg::optimize {

/// A decimal number between -10^10 and 10^10 with at most 15 places, exact.
class Decimal {
 public:
  __extension__ using Wide = __int128;

  Decimal() = default;
  explicit constexpr Decimal(Wide quanta) : quanta_(quanta) {}

  /// The whole text as a number, written as for shared/fixed/decimal.hpp; nothing for anything else.
  [[nodiscard]] static std::optional<Decimal> parse(std::string_view text);
  /// The shortest text of the number.
  [[nodiscard]] std::string text() const;
  /// The raw value of a number in that unit, as parse_decimal makes it of its text. The number fits, or the unit wraps.
  [[nodiscard]] std::int32_t raw(Unit unit) const;

  /// Units of 10^-15.
  [[nodiscard]] constexpr Wide quanta() const { return quanta_; }
  friend constexpr bool operator==(const Decimal&, const Decimal&) = default;
  friend constexpr std::strong_ordering operator<=>(const Decimal& left, const Decimal& right) {
    return left.quanta_ <=> right.quanta_;
  }

 private:
  Wide quanta_ = 0;
};

/// lowest, lowest + step, ..., highest.
class DecimalRange {
 public:
  /// step above 0, lowest not above highest.
  DecimalRange(Decimal lowest, Decimal highest, Decimal step);

  /// Whether the step divides the range, to 10^-9 of it. Steps that are written with less digits than they have
  /// (0.3333) pass if they have ten.
  [[nodiscard]] bool step_fits() const;
  /// How many values there are; the largest number there is if there are more.
  [[nodiscard]] std::uint64_t count() const;
  /// Value n, below count().
  [[nodiscard]] Decimal operator[](std::uint64_t n) const;
  /// The nearest upper ends, below and above highest, that fit.
  [[nodiscard]] Decimal fitting_below() const;
  [[nodiscard]] Decimal fitting_above() const;

 private:
  Decimal lowest_;
  Decimal highest_;
  Decimal step_;
  Decimal::Wide steps_;  ///< the whole number nearest to (highest - lowest) / step
};

/// The raw values of numbers in ascending order, in that order, each once.
[[nodiscard]] std::vector<std::int32_t> raw_values(const std::vector<Decimal>& numbers, Unit unit);

}  // namespace proleg::optimize
