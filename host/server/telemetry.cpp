#include "host/server/telemetry.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace proleg::host {
namespace {

using nlohmann::json;

const char* text_of(SignalOf of) {
  switch (of) {
    case SignalOf::joint:
      return "joint";
    case SignalOf::link:
      return "link";
    case SignalOf::robot:
      return "robot";
  }
  return "";
}

/// The 32-bit FNV-1a hash of a text.
std::uint32_t hash_of(std::string_view text) {
  std::uint32_t hash = 2166136261U;
  for (const char character : text) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 16777619U;
  }
  return hash;
}

constexpr std::uint16_t gap_flag = 1;

static_assert(std::endian::native == std::endian::little, "values are copied as they are in memory");

template <typename Integer>
void append(std::string& bytes, Integer value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

SignalLayout::SignalLayout(std::vector<Signal> signals) : signals_(std::move(signals)) {
  for (const Signal& signal : signals_) {
    if (find(signal.name) != nullptr) {
      throw std::invalid_argument("found two signals '" + signal.name + "', expected different names");
    }
    columns_.push_back({row_size_, signal.count});
    row_size_ += signal.count;
  }
  hash_ = hash_of(document(0).dump(-1, ' ', false, json::error_handler_t::replace));
}

const SignalColumns* SignalLayout::find(std::string_view name) const {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (signals_[i].name == name) {
      return &columns_[i];
    }
  }
  return nullptr;
}

json SignalLayout::document(std::uint32_t tick_us) const {
  json signals = json::array();
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const Signal& signal = signals_[i];
    signals.push_back({{"name", signal.name},
                       {"unit", signal.unit},
                       {"scale", signal.scale},
                       {"offset", columns_[i].offset},
                       {"count", signal.count},
                       {"of", text_of(signal.of)}});
  }
  return {{"hash", hash_}, {"tick_us", tick_us}, {"signals", signals}};
}

std::uint64_t TickHistory::reset(std::size_t row_size) {
  const std::size_t row_bytes = sizeof(Row) + row_size * sizeof(std::int32_t);
  const std::size_t capacity = std::max<std::size_t>(max_bytes_ / row_bytes, 1);
  const std::lock_guard lock(mutex_);
  row_size_ = row_size;
  rows_.assign(capacity, {});
  values_.assign(capacity * row_size, 0);
  begin_ = end_;
  return ++generation_;
}

void TickHistory::add(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) {
  const std::lock_guard lock(mutex_);
  if (generation_ == 0 || row.size() != row_size_) {
    throw std::invalid_argument("found a row of " + std::to_string(row.size()) + " values, expected " +
                                std::to_string(row_size_));
  }
  const std::size_t at = position(end_);
  rows_[at] = {run, tick};
  std::copy(row.begin(), row.end(), values_.begin() + static_cast<std::ptrdiff_t>(at * row_size_));
  ++end_;
  begin_ = std::max(begin_, end_ - std::min<std::uint64_t>(end_, rows_.size()));
}

std::uint64_t TickHistory::end() const {
  const std::lock_guard lock(mutex_);
  return end_;
}

std::uint64_t TickHistory::newest() const {
  const std::lock_guard lock(mutex_);
  return begin_ < end_ ? end_ - 1 : end_;
}

std::size_t TickHistory::capacity() const {
  const std::lock_guard lock(mutex_);
  return rows_.size();
}

std::optional<std::string> TickHistory::encode_rows(const Subscription& subscription, std::uint32_t stride,
                                                    HistoryCursor& cursor) const {
  const std::lock_guard lock(mutex_);
  if (subscription.generation != generation_) {
    return std::nullopt;
  }
  cursor.has_gap = cursor.has_gap || cursor.next < begin_;
  cursor.next = std::max(cursor.next, begin_);
  std::string bytes;
  Row first;
  std::uint16_t count = 0;
  HistoryCursor read = cursor;
  for (; read.next < end_ && count < max_telemetry_rows; ++read.next) {
    const std::size_t at = position(read.next);
    const Row row = rows_[at];
    const bool follows = !read.last || read.last->run != row.run || read.last->tick + 1 == row.tick;
    const bool is_other_run = count > 0 && row.run != first.run;
    if (count > 0 && (is_other_run || !follows)) {
      break;  // the next message begins with this row
    }
    read.has_gap = read.has_gap || !follows;
    read.last = row;
    if (row.tick % stride != 0) {
      continue;
    }
    if (count == 0) {
      first = row;
      append(bytes, subscription.number);
      append(bytes, row.tick);
      append(bytes, std::uint32_t{0});  // rows and stride
      append(bytes, row.run);
      append(bytes, std::uint16_t{0});  // flags
    }
    const char* const values = reinterpret_cast<const char*>(values_.data() + at * row_size_);
    for (const SignalColumns& columns : subscription.columns) {
      bytes.append(values + columns.offset * sizeof(std::int32_t), columns.count * sizeof(std::int32_t));
    }
    ++count;
    // The rows behind it that the stride leaves out stay unread: one of them may be the last row for a long time.
    cursor = read;
    ++cursor.next;
  }
  if (count == 0) {
    return std::nullopt;
  }
  const std::uint16_t stride_field = static_cast<std::uint16_t>(stride);
  const std::uint16_t flags = std::exchange(cursor.has_gap, false) ? gap_flag : std::uint16_t{0};
  std::memcpy(bytes.data() + 8, &count, sizeof count);
  std::memcpy(bytes.data() + 10, &stride_field, sizeof stride_field);
  std::memcpy(bytes.data() + 14, &flags, sizeof flags);
  return bytes;
}

}  // namespace proleg::host
