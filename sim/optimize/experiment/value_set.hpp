#pragma once

// The values of a dimension: as decimal numbers, as raw values in a module, and as an experiment file gives them. All
// arithmetic is with whole numbers, so min + n * step is exactly the number that a person would write, for every n.

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/fixed/unit.hpp"
#include "shared/gait/declaration.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {

/// An exact decimal number between -10^10 and 10^10 with at most 15 places.
class Decimal {
 public:
  __extension__ using Wide = __int128;

  Decimal() = default;
  explicit constexpr Decimal(Wide quanta) : quanta_(quanta) {}

  /// Parses a whole text, written as for shared/fixed/decimal.hpp; nothing for another text.
  [[nodiscard]] static std::optional<Decimal> parse(std::string_view text);
  /// The shortest text of the number.
  [[nodiscard]] std::string text() const;
  /// The raw value in a unit, equal to parse_decimal of the text. The number must fit, or the unit wraps.
  [[nodiscard]] std::int32_t raw(Unit unit) const;

  /// The number in units of 10^-15.
  [[nodiscard]] constexpr Wide quanta() const { return quanta_; }
  friend constexpr bool operator==(const Decimal&, const Decimal&) = default;
  friend constexpr std::strong_ordering operator<=>(const Decimal& left, const Decimal& right) {
    return left.quanta_ <=> right.quanta_;
  }

 private:
  Wide quanta_ = 0;
};

/// The numbers min, min + step, ..., max.
class DecimalRange {
 public:
  /// step must be above 0, min not above max.
  DecimalRange(Decimal min, Decimal max, Decimal step);

  /// Whether the step divides the range to within 10^-9 of it: a rounded step (0.3333333333) needs about ten digits.
  [[nodiscard]] bool step_fits() const;
  /// Number of values, at most 2^64 - 1.
  [[nodiscard]] std::uint64_t count() const;
  /// Value n, below count().
  [[nodiscard]] Decimal operator[](std::uint64_t n) const;
  /// The nearest upper ends that fit, below and above max.
  [[nodiscard]] Decimal fitting_below() const;
  [[nodiscard]] Decimal fitting_above() const;

 private:
  Decimal min_;
  Decimal max_;
  Decimal step_;
  Decimal::Wide steps_;  ///< the whole number nearest to (max - min) / step
};

/// The raw values of ascending numbers, in their order, each once.
[[nodiscard]] std::vector<std::int32_t> raw_values(const std::vector<Decimal>& numbers, Unit unit);

/// Returns the raw values of a joint, in ascending order of the numbers in the file. Throws InputError.
using ValuesOfJoint = std::function<std::vector<std::int32_t>(std::size_t joint)>;

/// Reads the values that a <genomeConfig> allows a parameter: a range with a step (valueSpace 1) or a list (0). The
/// file has one set for all joints, or one for each of `joints`, in its order. The sets are not empty and within the
/// parameter's declared range. `config` must outlive the result.
[[nodiscard]] ValuesOfJoint read_values(const sim::XmlElement& config, const Parameter& parameter, std::size_t joints);

}  // namespace proleg::optimize
