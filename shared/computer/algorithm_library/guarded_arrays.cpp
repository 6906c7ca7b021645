#include "shared/computer/algorithm_library/guarded_arrays.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <new>

namespace proleg {
namespace {

constexpr std::int32_t pattern = 0x5A5AA5A5;
/// Number of values before an array that are checked. An index that is wrong by more is rare, and the check takes time.
constexpr std::size_t front_values = 128;
// The smallest page has 4096 bytes.
static_assert((front_values + GuardedArrays::most_values) * sizeof(std::int32_t) <= 4096);
/// Number of pages that do not exist before and behind each array. An access in the first half of them is meant for the
/// array before, one in the second half for the array behind.
constexpr std::size_t gap_pages = 16;
constexpr std::array<const char*, GuardedArrays::array_count> names{"parameters", "derived", "state", "next", "frame"};

}  // namespace

GuardedArrays::GuardedArrays()
    : page_bytes_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))),
      memory_bytes_(((gap_pages + 1) * array_count + gap_pages) * page_bytes_) {
  void* const memory = mmap(nullptr, memory_bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    throw std::bad_alloc();
  }
  memory_ = static_cast<std::byte*>(memory);
  for (std::size_t i = 0; i < array_count; ++i) {
    void* const page = memory_ + (i * (gap_pages + 1) + gap_pages) * page_bytes_;
    if (mprotect(page, page_bytes_, PROT_READ | PROT_WRITE) != 0) {
      munmap(memory_, memory_bytes_);
      throw std::bad_alloc();
    }
    places_[i].page = static_cast<std::int32_t*>(page);
  }
  repair();
}

GuardedArrays::~GuardedArrays() { munmap(memory_, memory_bytes_); }

std::int32_t* GuardedArrays::place(Array array, std::span<const std::int32_t> values) {
  Place& place = places_[static_cast<std::size_t>(array)];
  std::int32_t* const end = place.page + page_bytes_ / sizeof pattern;
  if (place.count > values.size()) {
    std::fill(end - place.count, end - values.size(), pattern);
  }
  place.count = values.size();
  std::copy(values.begin(), values.end(), end - values.size());
  return end - values.size();
}

std::span<const std::int32_t> GuardedArrays::values(Array array) const {
  const Place& place = of(array);
  return {place.page + page_bytes_ / sizeof pattern - place.count, place.count};
}

std::optional<std::string> GuardedArrays::damage(Array array, std::span<const std::int32_t> read_only) const {
  const std::string name = names[static_cast<std::size_t>(array)];
  const std::span<const std::int32_t> present = values(array);
  const std::int32_t* const front = present.data() - front_values;
  if (!std::all_of(front, present.data(), [](std::int32_t value) { return value == pattern; })) {
    return "writes in front of its array '" + name + "'";
  }
  if (!read_only.empty() && !std::equal(read_only.begin(), read_only.end(), present.begin(), present.end())) {
    return "writes to its array '" + name + "', which it may only read";
  }
  return std::nullopt;
}

void GuardedArrays::repair() {
  for (Place& place : places_) {
    place.count = 0;
    std::fill_n(place.page, page_bytes_ / sizeof pattern, pattern);
  }
}

std::optional<std::string> GuardedArrays::missed_by(const void* address) const {
  const auto* const byte = static_cast<const std::byte*>(address);
  const std::less<> less;
  if (less(byte, memory_) || !less(byte, memory_ + memory_bytes_)) {
    return std::nullopt;
  }
  const std::size_t period = (gap_pages + 1) * page_bytes_;
  const auto offset = static_cast<std::size_t>(byte - memory_);
  const std::size_t gap = offset / period;
  const bool is_behind = offset % period < gap_pages * page_bytes_ / 2;
  if (gap == array_count || (is_behind && gap > 0)) {
    const std::size_t index = gap - 1;
    return "uses elements of its array '" + std::string(names[index]) + "' that do not exist (it has " +
           std::to_string(places_[index].count) + ")";
  }
  return "uses elements in front of its array '" + std::string(names[gap]) + "'";
}

}  // namespace proleg
