// Settings of modules in a text file: what is written is read again, and a bad file is named with its line.

#include "host/robot/parameter_file.hpp"

#include <gtest/gtest.h>

#include <random>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::test {
namespace {

using host::ModuleParameters;
using host::parameters_text;
using host::read_parameters;

constexpr const char* start = "# Proleg parameters 1\nmodule\t3\t0x12345678\t0xABCDEF01\n";

TEST(ParameterFile, WritesWhatItReads) {
  const std::string text = std::string(start) + "# a comment\n\n3\t0x6080\t300\tMax motor speed\n3\t0x607D:1\t-45.5\n";
  const auto modules = read_parameters("FILE", text);
  ASSERT_EQ(modules.size(), 1U);
  EXPECT_EQ(modules[0].node, 3);
  EXPECT_EQ(modules[0].serial, 0x12345678U);
  EXPECT_EQ(modules[0].core_fingerprint, 0xABCDEF01U);
  ASSERT_EQ(modules[0].values.size(), 2U);
  EXPECT_EQ(modules[0].values[0].bytes, (std::vector<std::uint8_t>{0x2C, 1, 0, 0}));
  EXPECT_EQ(read_parameters("AGAIN", parameters_text(modules)), modules);
}

TEST(ParameterFile, MayComeFromAnyEditor) {
  const std::string text = std::string(start) + "3\t0x6080\t300\tMax motor speed\n";
  const auto modules = read_parameters("FILE", text);
  std::string edited = "\xEF\xBB\xBF" + text;
  edited.replace(edited.find("parameters 1"), 12, "parameters\t1");
  for (std::size_t end = edited.find('\n'); end != std::string::npos; end = edited.find('\n', end + 2)) {
    edited.insert(end, "\r");
  }
  EXPECT_EQ(read_parameters("FILE", edited), modules);
}

TEST(ParameterFile, KeepsEveryValueOfEverySetting) {
  constexpr std::uint64_t seed = 7;
  std::mt19937_64 random(seed);
  for (int run = 0; run < 20; ++run) {
    ModuleParameters module{static_cast<std::uint8_t>(1 + random() % 126),
                            static_cast<std::uint32_t>(random()),
                            static_cast<std::uint32_t>(random()),
                            {}};
    for (const canopen::Object& object : host::setting_objects({2, 4, 0, 0})) {
      const auto low = static_cast<std::int64_t>(canopen::is_signed(object.type)
                                                     ? std::int64_t{static_cast<std::int32_t>(object.minimum)}
                                                     : std::int64_t{object.minimum});
      const auto high = static_cast<std::int64_t>(canopen::is_signed(object.type)
                                                      ? std::int64_t{static_cast<std::int32_t>(object.maximum)}
                                                      : std::int64_t{object.maximum});
      const std::int64_t chosen =
          low + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(high - low + 1));
      const std::int64_t value = run == 0 ? low : run == 1 ? high : chosen;
      std::vector<std::uint8_t> bytes;
      for (unsigned i = 0; i < canopen::size_of(object.type); ++i) {
        bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
      }
      module.values.push_back({object, bytes});
    }
    const std::vector<ModuleParameters> modules{module};
    const std::string text = parameters_text(modules);
    ASSERT_EQ(read_parameters("FILE", text), modules) << "seed " << seed << ", run " << run << '\n' << text;
  }
}

TEST(ParameterFile, RefusesABadFileWithItsLine) {
  const auto refusal = [](const std::string& text) {
    return message_of<InputError>([&] { static_cast<void>(read_parameters("FILE", text)); });
  };
  EXPECT_EQ(refusal(""), "FILE: found an empty file, expected '# Proleg parameters 1'");
  EXPECT_EQ(refusal("x\n"), "FILE:1: found 'x', expected '# Proleg parameters 1'");
  const struct {
    const char* line;
    const char* message;
  } cases[] = {
      {"4\t0x6080\t300", "FILE:3: found node '4', expected the node of the 'module' line before"},
      {"3\t0x6080", "FILE:3: found 2 fields, expected node, object and value, with tabs"},
      {"3\t0x6080\t5",
       "FILE:3: found '0x6080' '5', expected an object and its value: 0x6080: found 5, expected 90 to 10000 deg/s"},
      {"3\tnonsense\t5",
       "FILE:3: found 'nonsense' '5', expected an object and its value: nonsense: found no object of this name"},
      {"3\t0x6080\t300\n3\t0x6080\t301", "FILE:4: found '0x6080' twice for node 3, expected each object once"},
      {"module\t3\t0x1\t0x2", "FILE:3: found node 3 twice, expected each node once"},
      {"module\t0\t0x1\t0x2", "FILE:3: found node '0', expected 1 to 126"},
      {"module\t5\t1\t0x2", "FILE:3: found '1', expected eight hexadecimal digits after 0x"},
      {"module\t5\t0x1",
       "FILE:3: found 3 fields, expected module, node, serial number and core fingerprint, with tabs"},
  };
  for (const auto& [line, message] : cases) {
    const std::string found = refusal(start + std::string(line) + "\n");
    EXPECT_EQ(found.substr(0, std::string_view(message).size()), message);
  }
}

}  // namespace
}  // namespace proleg::test
