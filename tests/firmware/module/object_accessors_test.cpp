// The table of accessors: every declared entry has a row, and an entry without one is rejected.

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <vector>

#include "firmware/module/device_objects.hpp"
#include "module_node.hpp"

namespace proleg::canopen {

std::ostream& operator<<(std::ostream& out, const Address& address) {
  return out << std::hex << address.index << ':' << int{address.sub};
}

}  // namespace proleg::canopen

namespace proleg {
namespace {

using canopen::AbortCode;
using canopen::Access;
using canopen::Address;
using canopen::ValueKind;
using firmware::ObjectAccessor;
using firmware::WritableIn;

constexpr canopen::ValueKind ranges[] = {ValueKind::parameter, ValueKind::staged_parameter, ValueKind::internal_value};
static_assert(std::size(ranges) == canopen::value_kinds);

bool is_number(const canopen::ObjectRow& row) { return !canopen::is_long(row.first->type); }

/// Addresses of the first declared entry of each series that SDO cannot read or write as declared.
std::vector<Address> find_unwired(std::span<const ObjectAccessor> accessors) {
  std::vector<Address> unwired;
  const auto check = [&](Address first, Access access) {
    const auto row = std::find_if(accessors.begin(), accessors.end(),
                                  [&](const ObjectAccessor& accessor) { return accessor.first() == first; });
    const bool writes = access == Access::read_write;
    if (row == accessors.end() || row->get == nullptr || (row->set != nullptr) != writes ||
        (row->writable_in != WritableIn::no_state) != writes) {
      unwired.push_back(first);
    }
  };
  for (const canopen::ObjectRow& row : canopen::object_rows()) {
    if (is_number(row) && !canopen::fixed_value(*row.first, 1)) {
      check(row.first->address, row.first->access);
    }
  }
  for (const ValueKind range : ranges) {
    check(firmware::first_of(range), Access::read_write);
  }
  return unwired;
}

std::vector<ObjectAccessor> table() {
  const std::span<const ObjectAccessor> accessors = firmware::object_accessors();
  return {accessors.begin(), accessors.end()};
}

TEST(ObjectAccessors, ReadAndWriteEveryDeclaredEntry) {
  EXPECT_EQ(find_unwired(firmware::object_accessors()), std::vector<Address>{});
}

TEST(ObjectAccessors, HaveARowForDeclaredEntriesOnlyAndOnce) {
  std::size_t declared = std::size(ranges);
  for (const canopen::ObjectRow& row : canopen::object_rows()) {
    declared += !is_number(row) || canopen::fixed_value(*row.first, 1) ? 0U : 1U;
  }
  EXPECT_EQ(table().size(), declared);
}

TEST(ObjectAccessors, TheModuleHasEveryDeclaredText) {
  for (const canopen::ObjectRow& row : canopen::object_rows()) {
    EXPECT_EQ(firmware::read_text({}, row.first->address).has_value(), !is_number(row)) << row.first->address;
    EXPECT_TRUE(is_number(row) || row.first->access != Access::read_write) << "the module has no long entry to write";
  }
}

TEST(ObjectAccessors, AMissingRowIsFound) {
  for (std::size_t i = 0; i < table().size(); ++i) {
    std::vector<ObjectAccessor> shorter = table();
    const Address missing = shorter[i].first();
    shorter.erase(shorter.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_EQ(find_unwired(shorter), std::vector<Address>{missing});
  }
}

TEST(ObjectAccessors, AnIncompleteRowIsFound) {
  for (std::size_t i = 0; i < table().size(); ++i) {
    std::vector<ObjectAccessor> unreadable = table();
    unreadable[i].get = nullptr;
    EXPECT_EQ(find_unwired(unreadable), std::vector<Address>{unreadable[i].first()});
    std::vector<ObjectAccessor> changed = table();
    if (changed[i].set != nullptr) {
      changed[i].set = nullptr;
      EXPECT_EQ(find_unwired(changed), std::vector<Address>{changed[i].first()});
      changed = table();
      changed[i].writable_in = WritableIn::no_state;
      EXPECT_EQ(find_unwired(changed), std::vector<Address>{changed[i].first()});
    }
  }
}

/// The state of a module that was never switched on.
class UnwiredObject : public testing::Test, private CanPort, firmware::ServoPort, firmware::ContactPort {
 protected:
  bool send(const CanFrame& /*frame*/) override { return false; }
  void pulse(std::int32_t /*width*/, std::uint32_t /*period_us*/) override {}
  void off() override {}
  [[nodiscard]] std::uint8_t read_contacts() override { return 0; }

  AbortCode read(std::span<const ObjectAccessor> accessors, Address address) {
    std::uint32_t value = 0;
    return read_object(accessors, parts, address, value);
  }
  AbortCode write(std::span<const ObjectAccessor> accessors, const canopen::Object& entry) {
    return write_object(accessors, parts, entry.address, entry.default_value, 0);
  }

  test::Meters meters;
  test::FlashMemory flash;
  firmware::Parts parts{{}, {*this, *this, *this, meters, flash}};
};

TEST_F(UnwiredObject, IsRejectedAndNotReadAsZero) {
  for (const ObjectAccessor& accessor : firmware::object_accessors()) {
    if (canopen::value_address(accessor.first()) || accessor.first() == canopen::object::recent_error.first.address) {
      continue;  // they are rejected until the module is configured, or has an error, with a row or without
    }
    std::vector<ObjectAccessor> shorter = table();
    std::erase_if(shorter, [&](const ObjectAccessor& row) { return row.first() == accessor.first(); });
    EXPECT_EQ(read(shorter, accessor.first()), AbortCode::unsupported_access) << accessor.first();
    EXPECT_EQ(read(firmware::object_accessors(), accessor.first()), AbortCode::none) << accessor.first();
  }
}

TEST_F(UnwiredObject, IsNotWritten) {
  EXPECT_EQ(write({}, canopen::object::host_heartbeat), AbortCode::unsupported_access);
  std::vector<ObjectAccessor> read_only = table();
  for (ObjectAccessor& accessor : read_only) {
    accessor.set = nullptr;
  }
  EXPECT_EQ(write(read_only, canopen::object::host_heartbeat), AbortCode::unsupported_access);
  EXPECT_EQ(write(firmware::object_accessors(), canopen::object::host_heartbeat), AbortCode::none);
}

}  // namespace
}  // namespace proleg
