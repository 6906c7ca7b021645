#include "shared/canopen/objects.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "shared/canopen/object_name.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::canopen {
namespace {

std::string address_text(Address address) {
  char buffer[16];
  std::snprintf(buffer, sizeof buffer, "%04X:%u", unsigned{address.index}, unsigned{address.sub});
  return buffer;
}

std::vector<Object> all_objects() {
  std::vector<Object> objects;
  for_each_object([&](const Object& object) { objects.push_back(object); });
  return objects;
}

TEST(DataTypes, HaveTheSizesAndRangesOfTheirNames) {
  struct Case {
    DataType type;
    unsigned size;
    std::int64_t lowest;
    std::int64_t highest;
  };
  constexpr Case cases[] = {
      {DataType::integer8, 1, -128, 127},
      {DataType::integer16, 2, -32768, 32767},
      {DataType::integer32, 4, -2147483648, 2147483647},
      {DataType::unsigned8, 1, 0, 255},
      {DataType::unsigned16, 2, 0, 65535},
      {DataType::unsigned32, 4, 0, 4294967295},
  };
  for (const Case& c : cases) {
    const auto value = [&](std::uint32_t raw) {
      return is_signed(c.type) ? std::int64_t{static_cast<std::int32_t>(raw)} : std::int64_t{raw};
    };
    EXPECT_EQ(size_of(c.type), c.size);
    EXPECT_EQ(value(min_value(c.type)), c.lowest);
    EXPECT_EQ(value(max_value(c.type)), c.highest);
    EXPECT_EQ(value(extend(c.type, 0xA5A5A5A5)),
              is_signed(c.type)
                  ? std::int64_t{static_cast<std::int32_t>(0xA5A5A5A5U << (32 - 8 * c.size))} >> (32 - 8 * c.size)
                  : std::int64_t{0xA5A5A5A5U >> (32 - 8 * c.size)});
  }
}

// Entries that any CANopen tool expects (CiA 301 and CiA 402).
TEST(ObjectDictionary, HasTheStandardsObjects) {
  struct Case {
    Address address;
    DataType type;
    Access access;
    ObjectCode code;
  };
  using enum DataType;
  using enum Access;
  using enum ObjectCode;
  constexpr Case cases[] = {
      {{0x1000, 0}, unsigned32, constant, variable},      {{0x1001, 0}, unsigned8, read_only, variable},
      {{0x1003, 0}, unsigned8, read_write, array},        {{0x1003, 8}, unsigned32, read_only, array},
      {{0x1008, 0}, visible_string, constant, variable},  {{0x1009, 0}, visible_string, read_only, variable},
      {{0x100A, 0}, visible_string, read_only, variable}, {{0x6007, 0}, integer16, read_write, variable},
      {{0x605A, 0}, integer16, read_write, variable},     {{0x6062, 0}, integer32, read_only, variable},
      {{0x1005, 0}, unsigned32, read_write, variable},    {{0x1006, 0}, unsigned32, read_write, variable},
      {{0x1014, 0}, unsigned32, read_only, variable},     {{0x1016, 0}, unsigned8, constant, array},
      {{0x1016, 1}, unsigned32, read_write, array},       {{0x1017, 0}, unsigned16, read_write, variable},
      {{0x1018, 0}, unsigned8, constant, record},         {{0x1018, 1}, unsigned32, constant, record},
      {{0x1018, 4}, unsigned32, read_only, record},       {{0x1019, 0}, unsigned8, read_write, variable},
      {{0x1200, 1}, unsigned32, read_only, record},       {{0x1200, 2}, unsigned32, read_only, record},
      {{0x1400, 1}, unsigned32, read_only, record},       {{0x1400, 2}, unsigned8, constant, record},
      {{0x1600, 0}, unsigned8, constant, record},         {{0x1600, 1}, unsigned32, constant, record},
      {{0x1800, 1}, unsigned32, read_only, record},       {{0x1800, 2}, unsigned8, constant, record},
      {{0x1A00, 1}, unsigned32, constant, record},        {{0x6040, 0}, unsigned16, read_write, variable},
      {{0x6041, 0}, unsigned16, read_only, variable},     {{0x6060, 0}, integer8, read_write, variable},
      {{0x6061, 0}, integer8, read_only, variable},       {{0x607A, 0}, integer32, read_write, variable},
      {{0x6502, 0}, unsigned32, constant, variable},      {{0x1802, 1}, unsigned32, read_only, record},
      {{0x1A02, 0}, unsigned8, constant, record},         {{0x6064, 0}, integer32, read_only, variable},
      {{0x6075, 0}, unsigned32, constant, variable},      {{0x6078, 0}, integer16, read_only, variable},
  };
  for (const Case& c : cases) {
    const std::optional<Object> object = find_object(c.address);
    ASSERT_TRUE(object.has_value()) << address_text(c.address);
    EXPECT_EQ(object->type, c.type) << address_text(c.address);
    EXPECT_EQ(object->access, c.access) << address_text(c.address);
    EXPECT_EQ(find_index(c.address.index)->code, c.code) << address_text(c.address);
  }
}

TEST(ObjectDictionary, ValuesThatFollowFromTheNodeAreThoseOfThePredefinedConnectionSet) {
  const auto value = [](Address address) { return fixed_value(*find_object(address), 3).value_or(0); };
  EXPECT_EQ(value({0x1000, 0}), 0x00020192U) << "CiA 402, servo drive";
  EXPECT_EQ(value({0x1014, 0}), 0x083U);
  EXPECT_EQ(value({0x1200, 1}), 0x603U);
  EXPECT_EQ(value({0x1200, 2}), 0x583U);
  EXPECT_EQ(value({0x1400, 1}), 0x203U);
  EXPECT_EQ(value({0x1800, 1}), 0x40000183U) << "no remote frames";
  EXPECT_EQ(value({0x1801, 1}), 0x40000283U);
  EXPECT_EQ(value({0x1802, 1}), 0x40000383U);
  EXPECT_FALSE(fixed_value(*find_object({0x6041, 0}), 3)) << "state";
  EXPECT_FALSE(fixed_value(*find_object({0x1017, 0}), 3)) << "can be set";
}

TEST(ObjectDictionary, IsEnumeratedInAscendingOrderWithoutGapsInSubIndices) {
  const std::vector<Object> objects = all_objects();
  ASSERT_GT(objects.size(), 1000U);
  EXPECT_EQ(objects.front().address, (Address{0x1000, 0}));
  std::map<std::uint16_t, unsigned> subs;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Address address = objects[i].address;
    EXPECT_EQ(address.sub, subs[address.index]++) << address_text(address);
    if (i > 0) {
      const Address before = objects[i - 1].address;
      EXPECT_LT(before.index << 8U | before.sub, address.index << 8U | address.sub);
    }
  }
  for (const auto& [index, count] : subs) {
    const std::optional<IndexInfo> info = find_index(index);
    ASSERT_TRUE(info);
    EXPECT_EQ(info->max_sub + 1U, count) << address_text({index, 0});
    if (info->code == ObjectCode::variable) {
      EXPECT_EQ(count, 1U);
    } else {
      const Object highest = *find_object({index, 0});
      if (index == 0x1003) {  // the number of errors, which can be set to 0
        EXPECT_EQ(highest.type, DataType::unsigned8);
        EXPECT_EQ(highest.access, Access::read_write);
        EXPECT_EQ(highest.default_value, 0U);
        continue;
      }
      EXPECT_EQ(highest.type, DataType::unsigned8);
      EXPECT_EQ(highest.access, Access::constant);
      EXPECT_EQ(highest.default_value, count - 1);
    }
  }
}

TEST(ObjectDictionary, HoldsWhatIsEnumeratedAndNothingElse) {
  std::set<std::string> enumerated;
  for (const Object& object : all_objects()) {
    enumerated.insert(address_text(object.address));
  }
  for (unsigned index = 0; index <= 0xFFFF; ++index) {
    bool any = false;
    std::vector<unsigned> subs(33);  // the longest array has 31 elements
    std::iota(subs.begin(), subs.end(), 0U);
    subs.insert(subs.end(), {64U, 128U, 255U});
    for (const unsigned sub : subs) {
      const Address address{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)};
      const std::optional<Object> object = find_object(address);
      any = any || object.has_value();
      if (object) {
        ASSERT_EQ(object->address, address);
        ASSERT_EQ(enumerated.erase(address_text(address)), 1U) << address_text(address);
      }
    }
    ASSERT_EQ(index_exists(static_cast<std::uint16_t>(index)), any) << index;
  }
  EXPECT_TRUE(enumerated.empty()) << *enumerated.begin();
}

TEST(ObjectDictionary, DefaultsAreAllowedValues) {
  for (const Object& object : all_objects()) {
    EXPECT_EQ(check_range(object, object.default_value), AbortCode::none) << address_text(object.address);
    EXPECT_EQ(extend(object.type, object.default_value), object.default_value) << address_text(object.address);
    EXPECT_FALSE(is_less(object.type, object.minimum, min_value(object.type))) << address_text(object.address);
    EXPECT_FALSE(is_less(object.type, max_value(object.type), object.maximum)) << address_text(object.address);
    EXPECT_FALSE(is_less(object.type, object.maximum, object.minimum)) << address_text(object.address);
  }
}

TEST(ObjectDictionary, RangesAreThoseOfTheSpecification) {
  using List = std::vector<std::int64_t>;
  struct Case {
    Address address;
    List allowed;
    List below;
    List above;
  };
  const Case cases[] = {
      {{0x1005, 0}, {0x80, 0x40000080}, {0, 0x7F}, {0x81, 0x40000081, 0xC0000080}},
      {{0x1006, 0}, {1000, 100'000}, {0, 999}, {100'001}},
      {{0x1016, 1}, {0, 127 << 16 | 500, 127 << 16 | 0xFFFF}, {}, {128 << 16, 0xFFFFFFFF}},
      {{0x1019, 0}, {128}, {0, 127}, {129, 255}},
      {{0x1410, 1}, {0x80000000, 0x181, 0x1FE}, {0, 0x180}, {0x1FF, 0x281, 0x80000181}},
      {{0x144F, 1}, {0x80000000, 0x181, 0x1FE}, {0, 0x180}, {0x1FF}},
      {{0x1450, 1}, {0x80000000, 0x281, 0x2FE}, {0, 0x280}, {0x2FF}},
      {{0x2001, 1}, {0, 63}, {}, {64}},
      {{0x2001, 2}, {1, 64}, {0}, {65}},
      {{0x2001, 3}, {0, 126}, {}, {127}},
      {{0x2005, 3}, {100, 100'000}, {99}, {100'001}},
      {{0x2005, 4}, {-(1 << 30), 1 << 30}, {-(1 << 30) - 1, -2147483648}, {(1 << 30) + 1, 2147483647}},
      {{0x2005, 6}, {0, 1}, {}, {2}},
      {{0x200A, 1}, {0, 32767}, {}, {32768, 65535}},
      {{0x6007, 0}, {3}, {-32768, 0, 2}, {4, 32767}},
      {{0x605A, 0}, {6}, {-32768, 0, 5}, {7, 32767}},
      {{0x6060, 0}, {-1, 8}, {-128, -2}, {0, 7, 9, 127}},
  };
  for (const Case& c : cases) {
    const Object object = *find_object(c.address);
    const auto expect = [&](const List& values, AbortCode code) {
      for (const std::int64_t value : values) {
        EXPECT_EQ(check_range(object, static_cast<std::uint32_t>(value)), code)
            << address_text(c.address) << " = " << value;
      }
    };
    expect(c.allowed, AbortCode::none);
    expect(c.below, AbortCode::below_minimum);
    expect(c.above, AbortCode::above_maximum);
  }
}

TEST(ObjectDictionary, EveryPdoIsMappedToObjectsOfItsLength) {
  // CiA 301: communication parameters are 0x200 before their mapping.
  const auto bits_of = [](std::uint16_t mapping) {
    unsigned bits = 0;
    for (std::uint8_t sub = 1; sub <= find_index(mapping)->max_sub; ++sub) {
      const std::uint32_t entry = find_object({mapping, sub})->default_value;
      const Address mapped{static_cast<std::uint16_t>(entry >> 16U), static_cast<std::uint8_t>(entry >> 8U)};
      const std::optional<Object> object = find_object(mapped);
      EXPECT_TRUE(object.has_value()) << address_text(mapped);
      EXPECT_EQ(entry & 0xFFU, object ? 8U * size_of(object->type) : 0U) << address_text(mapped);
      bits += entry & 0xFFU;
    }
    return bits;
  };
  unsigned pdos = 0;
  for (unsigned index = 0x1400; index < 0x1A00; ++index) {
    if ((index < 0x1600 || index >= 0x1800) && index_exists(static_cast<std::uint16_t>(index))) {
      ++pdos;
      EXPECT_EQ(bits_of(static_cast<std::uint16_t>(index + 0x200)), index == 0x1400 || index == 0x1802 ? 48U : 64U)
          << index;
    }
  }
  EXPECT_EQ(pdos, 1U + 128U + 3U);
  const std::vector<std::uint32_t> monitored{0x20090110, 0x60780010, 0x20090208, 0x10010008};
  for (std::uint8_t sub = 1; sub <= 4; ++sub) {
    EXPECT_EQ(find_object({0x1A02, sub})->default_value, monitored[sub - 1U]) << "docs/protocol.md, example of 0x383";
  }
  EXPECT_EQ(find_object({0x1610 + 5, 2})->default_value >> 8U, 0x210502U) << "joint 5, bytes 4-7";
  EXPECT_EQ(find_object({0x1650 + 63, 1})->default_value >> 8U, 0x217F01U) << "joint 63, second frame, bytes 0-3";
}

TEST(ValueRanges, AreWhatTheAlgorithmsDeclare) {
  std::size_t found = 0;
  for (unsigned index = 0; index <= 0xFFFF; ++index) {
    for (unsigned sub = 0; sub <= 6; ++sub) {
      const Address address{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)};
      if (const std::optional<ValueAddress> value = value_address(address)) {
        ++found;
        ASSERT_EQ(address_of(*value), address);
      }
    }
  }
  std::size_t declared = 0;
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const Declaration& declaration = algorithm_at(i).declaration();
    declared += max_slots * (2 * declaration.parameters.size() + declaration.internal_values.size());
    for (std::uint8_t p = 0; p < declaration.parameters.size(); ++p) {
      for (const ValueKind kind : {ValueKind::parameter, ValueKind::staged_parameter}) {
        for (std::uint8_t slot = 0; slot < max_slots; ++slot) {
          const std::optional<Object> object = find_object(address_of({kind, declaration.id, p, slot}));
          ASSERT_TRUE(object.has_value());
          const Parameter& parameter = declaration.parameters[p];
          EXPECT_EQ(object->name, parameter.name);
          EXPECT_EQ(object->type, DataType::integer32);
          EXPECT_EQ(object->access, Access::read_write);
          EXPECT_EQ(static_cast<std::int32_t>(object->default_value), parameter.default_value);
          EXPECT_EQ(static_cast<std::int32_t>(object->minimum), parameter.minimum);
          EXPECT_EQ(static_cast<std::int32_t>(object->maximum), parameter.maximum);
        }
      }
    }
    for (std::uint8_t v = 0; v < declaration.internal_values.size(); ++v) {
      const std::optional<Object> object = find_object(address_of({ValueKind::internal_value, declaration.id, v, 3}));
      ASSERT_TRUE(object.has_value());
      EXPECT_EQ(object->access, Access::read_write);
      EXPECT_EQ(check_range(*object, 0x80000000), AbortCode::none);
      EXPECT_EQ(check_range(*object, 0x7FFFFFFF), AbortCode::none);
    }
  }
  EXPECT_EQ(found, declared);
}

TEST(ValueRanges, HaveTheDocumentedAddress) {
  // docs/protocol.md: amplitude (parameter 0) of the coupled oscillator (id 4), slot 1.
  EXPECT_EQ(address_of({ValueKind::parameter, 4, 0, 0}), (Address{0x3080, 1}));
  EXPECT_EQ(address_of({ValueKind::staged_parameter, 4, 0, 0}), (Address{0x4080, 1}));
  EXPECT_EQ(address_of({ValueKind::internal_value, 4, 3, 3}), (Address{0x5083, 4}));
  EXPECT_EQ(address_of({ValueKind::parameter, 127, 31, 0}), (Address{0x3FFF, 1})) << "the last of the range";
}

TEST(ObjectNames, ConsistOfIndexAndEntry) {
  const auto full = [](Address address) { return std::string(full_name(address).view()); };
  EXPECT_EQ(full({0x1018, 1}), "Identity object: Vendor-ID");
  EXPECT_EQ(full({0x1018, 0}), "Identity object: Highest sub-index supported");
  EXPECT_EQ(full({0x6040, 0}), "Controlword");
  EXPECT_EQ(full({0x2003, 3}), "Unique id: Unique id, word 3");
  EXPECT_EQ(full({0x1410, 1}), "RPDO communication parameter, state frame of joint 0: COB-ID used by RPDO");
  EXPECT_EQ(full({0x144F, 1}), "RPDO communication parameter, state frame of joint 63: COB-ID used by RPDO");
  EXPECT_EQ(full({0x3080, 1}), "PatternGenerator_coupled_oscillator amplitude: slot 1");
  EXPECT_EQ(full({0x4081, 4}), "PatternGenerator_coupled_oscillator frequency, staged: slot 4");
  EXPECT_EQ(full({0x5080, 2}), "PatternGenerator_coupled_oscillator current_phase: slot 2");
  EXPECT_EQ(full({0x1018, 5}), "");
  EXPECT_EQ(full({0x3000, 1}), "");
}

TEST(ObjectNames, OfAnEntryOfAnAlgorithmNameTheValueAndTheSlot) {
  const auto entry = [](Address address) { return std::string(entry_name(address).view()); };
  EXPECT_EQ(entry({0x3080, 1}), "amplitude of slot 1");
  EXPECT_EQ(entry({0x4081, 4}), "frequency, staged, of slot 4");
  EXPECT_EQ(entry({0x5080, 2}), "current_phase of slot 2");
  EXPECT_EQ(entry({0x2006, 2}), "Algorithm of slot 2");
}

TEST(ObjectUnits, AreThoseOfTheDocumentedNumberFormats) {
  // docs/protocol.md: 90 degrees = 2^30, and 2^14 on 16 bits; 1 Hz = 2^24.
  const auto in_units = [](Address address, double number) {
    const UnitScale scale = find_object(address)->scale;
    return number * scale.denominator / scale.numerator;
  };
  EXPECT_EQ(in_units({0x607A, 0}, 1 << 30), 90);
  EXPECT_EQ(in_units({0x2009, 1}, 1 << 14), 90);
  EXPECT_EQ(in_units({0x3080, 1}, 1 << 30), 90);
  EXPECT_EQ(in_units({0x3081, 1}, 1 << 24), 1);
  EXPECT_EQ(in_units({0x5081, 4}, 1 << 24), 1);
  EXPECT_EQ(in_units({0x200A, 1}, 2'000), 2'000);
  EXPECT_STREQ(find_object({0x607A, 0})->scale.symbol, "deg");
  EXPECT_STREQ(find_object({0x200A, 1})->scale.symbol, "mA");
  EXPECT_STREQ(find_object({0x6080, 0})->scale.symbol, "deg/s");
  EXPECT_STREQ(find_object({0x6040, 0})->scale.symbol, "");
}

TEST(ObjectNames, DifferAndFit) {
  std::set<std::string> names;
  for (const Object& object : all_objects()) {
    const ObjectName name = full_name(object.address);
    EXPECT_LT(name.size, name.characters.size()) << name.view();
    EXPECT_TRUE(names.insert(std::string(name.view())).second) << name.view();
  }
}

TEST(AbortCodes, HaveNames) {
  EXPECT_EQ(describe(AbortCode::no_such_object), "no such object");
  EXPECT_EQ(describe(static_cast<AbortCode>(0x12345678)), "unknown abort code");
}

}  // namespace
}  // namespace proleg::canopen
