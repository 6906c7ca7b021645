#pragma once

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "shared/canopen/objects.hpp"
#include "shared/canopen/sdo_server.hpp"

namespace proleg::test {

/// A device that keeps what is written and checks that writing it is allowed.
class DeviceMemory final : public canopen::ObjectAccess {
 public:
  canopen::AbortCode read(const canopen::Entry& object, std::uint32_t& value) override {
    ++reads;
    EXPECT_FALSE(fixed_value(object, 1)) << "the server knows this value";
    value = this->value(object.address);
    return refusal;
  }
  canopen::AbortCode write(const canopen::Entry& object, std::uint32_t value) override {
    ++writes;
    EXPECT_EQ(object.access, canopen::Access::read_write);
    EXPECT_EQ(check_range(object, value), canopen::AbortCode::none);
    EXPECT_EQ(extend(object.type, value), value);
    if (refusal == canopen::AbortCode::none) {
      values[{object.address.index, object.address.sub}] = value;
    }
    return refusal;
  }

  /// As written, else the default.
  [[nodiscard]] std::uint32_t value(canopen::Address address) const {
    const auto found = values.find({address.index, address.sub});
    return found != values.end() ? found->second : canopen::find_object(address)->default_value;
  }

  std::map<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t> values;
  canopen::AbortCode refusal = canopen::AbortCode::none;  ///< answer to everything
  unsigned reads = 0;
  unsigned writes = 0;
};

}  // namespace proleg::test
