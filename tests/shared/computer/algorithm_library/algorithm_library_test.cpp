// What a program accepts as the interface and the declaration of a user's algorithm.

#include "shared/computer/algorithm_library/algorithm_library.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "shared/gait/registry.hpp"
#include "user_algorithm.hpp"

namespace proleg {
namespace {

class Declared final : public test::Counter {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return changed; }
  static Declaration changed;
};
Declaration Declared::changed = test::user_declaration;

const ActuationModule& declared() {
  static const Declared instance;
  return instance;
}

class AlgorithmLibrary : public testing::Test {
 protected:
  AlgorithmLibrary() { Declared::changed = test::user_declaration; }

  static AlgorithmInterface good() { return interface_of(0xC0FFEE, declared); }
  static std::string error_of(const AlgorithmInterface& interface) {
    try {
      static_cast<void>(make_algorithm(interface, "bad.so"));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(AlgorithmLibrary, TakesAnInterfaceOfThisCheckout) {
  const auto algorithm = make_algorithm(good(), "good.so");
  const Declaration& declaration = algorithm->declaration();
  EXPECT_EQ(declaration.name, "counter");
  EXPECT_EQ(declaration.id, 96);
  EXPECT_EQ(declaration.sources, 0xC0FFEEU);
  ASSERT_EQ(declaration.parameters.size(), 2U);
  EXPECT_EQ(declaration.parameters[1].name, "offset");
  EXPECT_EQ(declaration.parameters[1].maximum, quarter_turn);
  ASSERT_EQ(declaration.internal_values.size(), 1U);
  EXPECT_EQ(declaration.internal_values[0].help, "sum of the steps");
  ASSERT_EQ(declaration.frame.size(), 1U);
  EXPECT_EQ(declaration.frame[0].bytes, 2);
  EXPECT_FALSE(algorithm->senses_contacts());
  EXPECT_EQ(algorithm->senses_readings(), JointReadings::inclination) << "as if it were built in";
}

TEST_F(AlgorithmLibrary, KeepsTheDeclarationAlthoughTheLibraryChangesIt) {
  const auto algorithm = make_algorithm(good(), "good.so");
  Declared::changed.name = "other";
  EXPECT_EQ(algorithm->declaration().name, "counter");
}

TEST_F(AlgorithmLibrary, RefusesAnotherInterfaceWithoutACallOfIt) {
  const auto never_called = +[]() -> const ActuationModule& {
    ADD_FAILURE() << "called";
    return declared();
  };
  AlgorithmInterface interface = interface_of(0xC0FFEE, never_called);
  interface.version = 9;
  EXPECT_NE(error_of(interface).find("bad.so: found version 9 of the interface of algorithms, expected version 1"),
            std::string::npos);
  interface = interface_of(0xC0FFEE, never_called);
  interface.size += 8;
  EXPECT_NE(error_of(interface).find("found an interface of"), std::string::npos);
  interface = interface_of(0xC0FFEE, never_called);
  interface.mark[0] = 'P';
  EXPECT_NE(error_of(interface).find("found another object"), std::string::npos);
  interface = interface_of(0xC0FFEE, never_called);
  interface.core ^= 1U;
  EXPECT_NE(error_of(interface).find("found a library for the core"), std::string::npos);
  for (std::size_t i = 0; i < algorithm_layout.size(); ++i) {
    interface = interface_of(0xC0FFEE, never_called);
    interface.layout[i] += 4;
    EXPECT_NE(error_of(interface).find(algorithm_layout[i].name), std::string::npos);
  }
  EXPECT_NE(error_of(interface_of(0, never_called)).find("without an algorithm or its sources"), std::string::npos);
}

TEST_F(AlgorithmLibrary, RefusesOtherSourcesInTheDeclaration) {
  Declared::changed.sources = 1;
  EXPECT_NE(error_of(good()).find("found sources 0x00000001 in the declaration"), std::string::npos);
}

TEST_F(AlgorithmLibrary, RefusesADeclarationThatBreaksARule) {
  using namespace test;
  const std::vector<Parameter> too_many(max_parameters + 1, user_parameters[0]);
  const Parameter no_range[] = {{"step", Unit::count, 5, 6, 7, ""}};
  const Parameter no_unit[] = {{"step", static_cast<Unit>(99), 0, 0, 0, ""}};
  const Parameter no_name[] = {{"a step", Unit::count, 0, 0, 0, ""}};
  const Parameter twice[] = {user_parameters[0], user_parameters[0]};
  const FrameField no_value[] = {{1, 1}};
  const FrameField no_bytes[] = {{0, 5}};
  const FrameField too_long[] = {{0, 4}, {0, 3}};
  const std::string long_name(200, 'x');
  const auto expect_error = [](auto change, std::string_view part) {
    Declared::changed = user_declaration;
    change(Declared::changed);
    const std::string error = error_of(good());
    EXPECT_NE(error.find(part), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  };
  expect_error([](Declaration& d) { d.id = 95; },
               "found algorithm id 95, expected an id for users' algorithms, 96 to 126");
  expect_error([](Declaration& d) { d.id = 127; }, "id 127");
  expect_error([](Declaration& d) { d.name = ""; }, "the algorithm's name ''");
  expect_error([&](Declaration& d) { d.name = long_name; }, "name of 200 characters");
  expect_error([](Declaration& d) { d.parameters = {}; }, "found 0 parameters, expected 1 to 32");
  expect_error([&](Declaration& d) { d.parameters = too_many; }, "found 33 parameters");
  expect_error([&](Declaration& d) { d.parameters = no_range; }, "minimum 6, default 5 and maximum 7");
  expect_error([&](Declaration& d) { d.parameters = no_unit; }, "unit 99");
  expect_error([&](Declaration& d) { d.parameters = no_name; }, "a parameter's name 'a step'");
  expect_error([&](Declaration& d) { d.parameters = twice; }, "two parameters with the name 'step'");
  expect_error([&](Declaration& d) { d.frame = no_value; }, "internal value number 1");
  expect_error([&](Declaration& d) { d.frame = no_bytes; }, "5 bytes");
  expect_error([&](Declaration& d) { d.frame = too_long; }, "found 7 bytes in the state frame");
}

TEST_F(AlgorithmLibrary, ADeclarationWithWrongPointersIsFound) {
  Declared::changed.parameters = {reinterpret_cast<const Parameter*>(8), 3};
  EXPECT_NE(error_of(good()).find("asked for its declaration, uses memory that does not exist"), std::string::npos);
}

TEST_F(AlgorithmLibrary, AFileThatIsNoLibraryIsNamed) {
  try {
    static_cast<void>(load_algorithm("no/such.so"));
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no/such.so: found no such file"), std::string::npos);
  }
}

TEST_F(AlgorithmLibrary, TheRegistryFindsLoadedAlgorithmsBesideTheOthers) {
  const auto algorithm = make_algorithm(good(), "good.so");
  const std::array<const ActuationModule*, 1> loaded{algorithm.get()};
  const LoadedAlgorithms list(loaded);
  const std::size_t built_in = algorithm_count();
  set_loaded_algorithms(&list);
  EXPECT_EQ(algorithm_count(), built_in + 1);
  EXPECT_EQ(find_algorithm("counter"), algorithm.get());
  EXPECT_EQ(find_algorithm(std::uint8_t{96}), algorithm.get());
  EXPECT_EQ(&algorithm_at(built_in), algorithm.get());
  EXPECT_NE(find_algorithm("PatternGenerator_sinusoidal"), nullptr);
  set_loaded_algorithms(nullptr);
  EXPECT_EQ(find_algorithm("counter"), nullptr);
}

TEST(Registry, TheCoreUsesNoIdOfUsers) {
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    EXPECT_FALSE(is_user_algorithm(algorithm_at(i).declaration().id)) << algorithm_at(i).declaration().name;
    EXPECT_EQ(algorithm_at(i).declaration().sources, 0U);
  }
}

}  // namespace
}  // namespace proleg
