// Words for objects and values, as a user types and reads them.

#include "host/robot/object_word.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "shared/gait/registry.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::test {
namespace {

using host::ObjectWord;
using host::parse_nodes;
using host::parse_value;
using host::value_text;

std::string address_of(std::string_view word, std::uint8_t algorithm = 0) {
  const canopen::Address address = ObjectWord(word).object(algorithm).address;
  char text[16];
  std::snprintf(text, sizeof text, "%04X:%u", address.index, address.sub);
  return text;
}

TEST(ObjectWord, TakesIndexAndSubIndex) {
  EXPECT_EQ(address_of("0x6064"), "6064:0");
  EXPECT_EQ(address_of("6064"), "6064:0");
  EXPECT_EQ(address_of("0x1018:4"), "1018:4");
  EXPECT_EQ(address_of("1018:4"), "1018:4");
}

TEST(ObjectWord, TakesNamesInAnyCase) {
  EXPECT_EQ(address_of("Joint index"), "2001:1");
  EXPECT_EQ(address_of("position actual value"), "6064:0");
  EXPECT_EQ(address_of("Place in the robot: Joint index"), "2001:1");
}

TEST(ObjectWord, TakesParametersOfTheAlgorithmThatTheModuleHas) {
  EXPECT_EQ(ObjectWord("amplitude").slot(), 0U);
  EXPECT_EQ(ObjectWord("amplitude:2").slot(), 1U);
  EXPECT_EQ(address_of("amplitude", 4), "3080:1");
  EXPECT_EQ(address_of("amplitude:3", 4), "3080:3");
}

TEST(ObjectWord, RefusesWhatIsNoObject) {
  for (const char* word :
       {"", "nonsense", "0x", "0x99999", "0x6064:256", "0x1018:9", "amplitude:0", "amplitude:5", "6064:"}) {
    EXPECT_THROW(ObjectWord{word}, InputError) << word;
  }
  EXPECT_NE(message_of<InputError>([] { ObjectWord("Joint indx"); }).find("'Joint index'"), std::string::npos);
  EXPECT_THROW(static_cast<void>(ObjectWord("amplitude").object(0)), InputError);
  EXPECT_THROW(static_cast<void>(ObjectWord("amplitude").object(99)), InputError);
}

TEST(ObjectWord, NamesAllObjectsOfAnAmbiguousName) {
  const std::string message = message_of<InputError>([] { ObjectWord("COB-ID used by TPDO"); });
  EXPECT_NE(message.find("0x1802:1 'TPDO communication parameter, monitoring: COB-ID used by TPDO'"), std::string::npos)
      << message;
}

std::string shown(std::string_view word, std::vector<std::uint8_t> bytes, std::uint8_t algorithm = 0) {
  return value_text(ObjectWord(word).object(algorithm), bytes);
}

TEST(Values, AreShownInTheirUnit) {
  EXPECT_EQ(shown("0x6064", {0, 0, 0, 0x20}), "45 deg");
  EXPECT_EQ(shown("0x6078", {0x5E, 1}), "350 mA");
  EXPECT_EQ(shown("0x6080", {0xD0, 2, 0, 0}), "720 deg/s");
  EXPECT_EQ(shown("0x1018:1", {0x4C, 0x4F, 0x52, 0x50}), "0x50524F4C (1347571532)");
  EXPECT_EQ(shown("0x1008", {'a', 'b'}), "ab");
  EXPECT_EQ(shown("frequency", {0, 0, 0x80, 0}, 2), "0.5 Hz");
  EXPECT_EQ(shown("0x6064", {1, 2}), "01 02") << "another size than declared";
  EXPECT_EQ(shown("0x6064", {}), "no bytes");
}

TEST(Values, AreReadInTheirUnit) {
  const auto bytes = [](std::string_view word, std::string_view value, std::uint8_t algorithm = 0) {
    return parse_value("VALUE", ObjectWord(word).object(algorithm), value);
  };
  using Bytes = std::vector<std::uint8_t>;
  EXPECT_EQ(bytes("0x607A", "45"), (Bytes{0, 0, 0, 0x20}));
  EXPECT_EQ(bytes("0x607A", "0x20000000"), (Bytes{0, 0, 0, 0x20}));
  EXPECT_EQ(bytes("0x607A", "-45"), (Bytes{0, 0, 0, 0xE0}));
  EXPECT_EQ(bytes("0x1017", "100"), (Bytes{100, 0}));
  EXPECT_EQ(bytes("frequency", "0.5", 2), (Bytes{0, 0, 0x80, 0}));
  for (const char* word : {"", "x", "1e99", "nan", "91", "-91", "0x123456789"}) {
    EXPECT_THROW(static_cast<void>(bytes("0x607A", word)), InputError) << word;
  }
  for (const char* word : {"-1", "65536", "1.5"}) {
    EXPECT_THROW(static_cast<void>(bytes("0x1017", word)), InputError) << word;
  }
}

TEST(NodeList, TakesIdsRangesAndAll) {
  EXPECT_EQ(parse_nodes("3"), (std::vector<std::uint8_t>{3}));
  EXPECT_EQ(parse_nodes("1,3-5,4"), (std::vector<std::uint8_t>{1, 3, 4, 5}));
  EXPECT_EQ(parse_nodes("all"), std::nullopt);
  for (const char* word : {"", "0", "127", "3-", "-3", "5-3", "1,,2", "1 2", "x", "1-200"}) {
    EXPECT_THROW(static_cast<void>(parse_nodes(word)), InputError) << word;
  }
}

}  // namespace
}  // namespace proleg::test
