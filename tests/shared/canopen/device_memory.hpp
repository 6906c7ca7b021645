#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/canopen/objects.hpp"
#include "shared/canopen/sdo_server.hpp"

namespace proleg::test {

/// A device that keeps written values and checks that the server calls it as documented.
class DeviceMemory final : public canopen::ObjectAccess {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Key = std::pair<std::uint16_t, std::uint8_t>;
  static Key key(canopen::Address address) { return {address.index, address.sub}; }

  canopen::AbortCode find(canopen::Address address, canopen::Entry& entry) override {
    const auto found = more_entries.find(key(address));
    if (found == more_entries.end()) {
      return find_entry(address, entry);
    }
    entry = found->second;
    return canopen::AbortCode::none;
  }
  canopen::AbortCode read(const canopen::Entry& entry, std::uint32_t& value) override {
    ++reads;
    EXPECT_FALSE(fixed_value(entry, 1)) << "the server knows this value";
    EXPECT_FALSE(is_long(entry.type));
    value = this->value(entry.address);
    return refusal;
  }
  canopen::AbortCode write(const canopen::Entry& entry, std::uint32_t value) override {
    ++writes;
    EXPECT_EQ(entry.access, canopen::Access::read_write);
    EXPECT_EQ(check_range(entry, value), canopen::AbortCode::none);
    EXPECT_EQ(extend(entry.type, value), value);
    if (refusal == canopen::AbortCode::none) {
      values[key(entry.address)] = value;
    }
    return refusal;
  }

  canopen::AbortCode open_read(const canopen::Entry& entry, std::uint32_t& size) override {
    ++reads;
    EXPECT_TRUE(is_long(entry.type));
    size = static_cast<std::uint32_t>(long_values[key(entry.address)].size());
    return refusal;
  }
  canopen::AbortCode read_part(const canopen::Entry& entry, std::uint32_t offset,
                               std::span<std::uint8_t> part) override {
    const Bytes& value = long_values[key(entry.address)];
    EXPECT_FALSE(part.empty());
    if (offset + part.size() > value.size()) {
      ADD_FAILURE() << "read " << part.size() << " bytes at " << offset << " of " << value.size();
      return canopen::AbortCode::general_error;
    }
    std::copy_n(value.begin() + offset, part.size(), part.begin());
    return offset + part.size() > fails_at ? failure : canopen::AbortCode::none;
  }
  canopen::AbortCode open_write(const canopen::Entry& entry, std::optional<std::uint32_t> size) override {
    EXPECT_TRUE(is_long(entry.type));
    EXPECT_FALSE(is_open) << "the transfer before was neither closed nor cancelled";
    EXPECT_TRUE(!size || (*size >= entry.minimum && *size <= entry.maximum));
    is_open = refusal == canopen::AbortCode::none;
    written.clear();
    return refusal;
  }
  canopen::AbortCode write_part(const canopen::Entry& entry, std::uint32_t offset,
                                std::span<const std::uint8_t> part) override {
    EXPECT_TRUE(is_open);
    EXPECT_EQ(offset, written.size()) << "each offset once, ascending";
    EXPECT_FALSE(part.empty());
    written.insert(written.end(), part.begin(), part.end());
    EXPECT_LE(written.size(), entry.maximum);
    return written.size() > fails_at ? failure : canopen::AbortCode::none;
  }
  canopen::AbortCode close_write(const canopen::Entry& entry, std::uint32_t size) override {
    EXPECT_TRUE(is_open);
    EXPECT_EQ(size, written.size());
    EXPECT_GE(size, entry.minimum);
    if (close_refusal == canopen::AbortCode::none) {
      is_open = false;
      ++writes;
      long_values[key(entry.address)] = written;
    }
    return close_refusal;
  }
  void cancel_write(const canopen::Entry& /*entry*/) override {
    EXPECT_TRUE(is_open);
    is_open = false;
    ++cancellations;
  }

  /// The value as it was written, else the default.
  [[nodiscard]] std::uint32_t value(canopen::Address address) const {
    const auto found = values.find(key(address));
    return found != values.end() ? found->second : canopen::find_object(address)->default_value;
  }
  void set_text(canopen::Address address, std::string_view text) {
    long_values[key(address)].assign(text.begin(), text.end());
  }

  /// Adds an entry of `shortest` to `longest` bytes that the declared dictionary does not have.
  void add_entry(canopen::Address address, canopen::DataType type, std::uint32_t shortest, std::uint32_t longest,
                 canopen::Access access = canopen::Access::read_write) {
    more_entries[key(address)] = {address, type, access, false, 0, shortest, longest, {}};
  }

  std::map<Key, canopen::Entry> more_entries;
  std::map<Key, std::uint32_t> values;
  std::map<Key, Bytes> long_values;
  canopen::AbortCode refusal = canopen::AbortCode::none;            ///< answer to everything
  canopen::AbortCode close_refusal = canopen::AbortCode::none;      ///< answer to close_write()
  std::size_t fails_at = ~std::size_t{0};                           ///< access to a part beyond this byte fails
  canopen::AbortCode failure = canopen::AbortCode::hardware_error;  ///< answer to such an access
  bool is_open = false;
  Bytes written;  ///< bytes that were written since open_write()
  unsigned reads = 0;
  unsigned writes = 0;
  unsigned cancellations = 0;
};

}  // namespace proleg::test
