#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "shared/gait/declaration.hpp"

namespace proleg {

/// The arrays that a user's algorithm receives, each at the end of a page of memory, between pages that do not exist.
/// An access behind the end of an array, or far from it, is a fault of the processor. A write before an array, or into
/// one that may only be read, is found when the call has returned.
///
/// Only one thread may use it at a time.
class GuardedArrays {
 public:
  enum class Array : std::uint8_t { parameters, derived, state, next, frame };
  static constexpr std::size_t array_count = 5;
  static constexpr std::size_t most_values =
      std::max({std::size_t{max_parameters}, std::size_t{max_derived}, max_internal_values});

  /// Throws std::bad_alloc.
  GuardedArrays();
  ~GuardedArrays();
  GuardedArrays(const GuardedArrays&) = delete;
  GuardedArrays& operator=(const GuardedArrays&) = delete;

  /// Copies the values, at most `most_values`, into the array, and returns it.
  std::int32_t* place(Array array, std::span<const std::int32_t> values);
  /// Values of an array that was placed.
  [[nodiscard]] std::span<const std::int32_t> values(Array array) const;

  /// The error in an array after a call, such as "writes in front of its array 'next'". read_only: values that it must
  /// have; empty if it may be written.
  [[nodiscard]] std::optional<std::string> damage(Array array, std::span<const std::int32_t> read_only) const;
  /// Restores the arrays to the state before a call that has damaged them.
  void repair();
  /// The array that an access to this address has missed, such as "uses elements of its array 'state' that do not exist
  /// (it has 3)".
  [[nodiscard]] std::optional<std::string> missed_by(const void* address) const;

 private:
  struct Place {
    std::int32_t* page = nullptr;
    std::size_t count = 0;  ///< number of values at its end; all before them have the pattern
  };
  [[nodiscard]] const Place& of(Array array) const { return places_[static_cast<std::size_t>(array)]; }

  std::size_t page_bytes_;
  std::size_t memory_bytes_;
  std::byte* memory_;
  std::array<Place, array_count> places_;
};

}  // namespace proleg
