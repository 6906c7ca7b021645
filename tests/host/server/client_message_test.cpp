#include "host/server/client_message.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

std::string error_of(std::string_view text) {
  return message_of<InputError>([text] { static_cast<void>(parse_client_message(text)); });
}

template <typename Message>
Message parsed(std::string_view text) {
  return std::get<Message>(parse_client_message(text));
}

TEST(ClientMessage, IsReadAsTheTextOfTheInterfaceShows) {
  const auto hello = parsed<Hello>(R"({"type": "hello", "protocol": 1, "token": "abc", "name": "Firefox on desk-3"})");
  EXPECT_EQ(hello.protocol, 1U);
  EXPECT_EQ(hello.token, "abc");
  EXPECT_EQ(hello.name, "Firefox on desk-3");
  EXPECT_FALSE(hello.is_only_stop);
  EXPECT_FALSE(hello.wants_control);
  EXPECT_TRUE(parsed<Hello>(R"({"type": "hello", "protocol": 1, "token": "abc", "name": "x", "wants_control": true})")
                  .wants_control);

  const auto operation = parsed<Operation>(
      R"({"type": "operation", "id": 8, "epoch": 4, "name": "set", "arguments": {"words": ["a=1"]}})");
  EXPECT_EQ(operation.id, 8U);
  EXPECT_EQ(operation.epoch, 4U);
  EXPECT_EQ(operation.name, "set");
  EXPECT_EQ(operation.arguments, nlohmann::json({{"words", {"a=1"}}}));

  EXPECT_TRUE(std::holds_alternative<Stop>(parse_client_message(R"({"type": "stop"})")));
  EXPECT_EQ(parsed<Beat>(R"({"type": "beat", "age_ms": 12.5})").age_ms, 12.5);

  const auto subscribe = parsed<Subscribe>(R"({"type": "subscribe", "signals": ["angle", "head"], "hash": 7})");
  EXPECT_EQ(subscribe.signals, (std::vector<std::string>{"angle", "head"}));
  EXPECT_EQ(subscribe.hash, 7U);
  EXPECT_FALSE(subscribe.newest);
  EXPECT_TRUE(parsed<Subscribe>(R"({"type": "subscribe", "signals": [], "newest": true})").newest);
}

TEST(ClientMessage, HasDefaultsForWhatManyOperationsDoNotNeed) {
  const auto operation = parsed<Operation>(R"({"type": "operation", "id": 0, "name": "run"})");
  EXPECT_EQ(operation.epoch, 0U);
  EXPECT_EQ(operation.arguments, nlohmann::json::object());
  EXPECT_EQ(parsed<Subscribe>(R"({"type": "subscribe", "signals": []})").hash, std::nullopt);
}

TEST(ClientMessage, MayHaveFieldsOfALaterVersion) {
  EXPECT_EQ(parsed<Beat>(R"({"type": "beat", "age_ms": 1, "battery": {"percent": 80}})").age_ms, 1);
}

TEST(ClientMessage, NamesWhatIsWrong) {
  EXPECT_EQ(error_of("{"), "message: found text that is not JSON, expected an object in JSON");
  EXPECT_EQ(error_of(R"({"type": "beat", "age_ms": 1e400})"),
            "message: found a number that is too large, expected numbers of 64 bits (IEEE 754)");
  EXPECT_EQ(error_of("[1]"), "message: found an array, expected an object");
  EXPECT_EQ(error_of(R"({"id": 1})"), "message: found no field 'type', expected one");
  EXPECT_EQ(error_of(R"({"type": "halt"})"),
            "message: found type 'halt', expected hello, operation, stop, beat or subscribe");
  EXPECT_EQ(error_of(R"({"type": "beat", "age_ms": -1})"),
            "message: found -1, expected a number of at least 0 in 'age_ms'");
  EXPECT_EQ(error_of(R"({"type": "operation", "id": 1e3, "name": "run"})"),
            "message: found 1000.0, expected a whole number from 0 to 2^53 - 1 in 'id'");
  EXPECT_EQ(error_of(R"({"type": "operation", "id": 9007199254740992, "name": "run"})"),
            "message: found 9007199254740992, expected a whole number from 0 to 2^53 - 1 in 'id'");
  EXPECT_EQ(error_of(R"({"type": "operation", "id": 1, "name": "run", "arguments": [1]})"),
            "message: found an array, expected an object in 'arguments'");
  EXPECT_EQ(error_of(R"({"type": "subscribe", "signals": ["a", "b", "a"]})"),
            "message: found \"a\" twice, expected different names in 'signals'");
  EXPECT_EQ(error_of(R"({"type": "hello", "protocol": 1, "token": "", "name": "x", "only": "look"})"),
            "message: found \"look\", expected 'only' missing or \"stop\"");
  EXPECT_EQ(error_of(R"({"type": "hello", "protocol": 1, "token": "", "name": "x", "wants_control": 1})"),
            "message: found 1, expected true or false as 'wants_control'");
}

TEST(ClientMessage, ErrorsAreShortWhateverTheMessage) {
  EXPECT_LT(error_of(R"({"type": ")" + std::string(60000, 'x') + R"("})").size(), 200U);
  EXPECT_LT(error_of(R"({"type": "beat", "age_ms": ")" + std::string(60000, 'x') + R"("})").size(), 200U);
}

std::string with_name(const std::string& name) {
  return R"({"type": "hello", "protocol": 1, "token": "abc", "name": ")" + name + R"("})";
}

TEST(ClientMessage, HasANameOfUpToSixtyCharacters) {
  std::string sixty;
  for (int i = 0; i < 60; ++i) {
    sixty += "\u00e4";
  }
  EXPECT_EQ(parsed<Hello>(with_name(sixty)).name, sixty) << "characters, not bytes";
  for (const std::string& name :
       {std::string(), sixty + "x", std::string("a\\nb"), std::string("\\u0000"), std::string("\\u2028"),
        std::string("\\u202emoor"), std::string("\\u200b"), std::string("a\\ufeff")}) {
    const std::string error = error_of(with_name(name));
    EXPECT_EQ(error.substr(0, 25), "message: found the name '") << name;
    EXPECT_NE(error.find("', expected 1 to 60 characters that a person sees, in one line"), std::string::npos) << error;
  }
  EXPECT_NE(error_of(with_name("\\u202emoor")).find("'<U+202E>moor'"), std::string::npos);
}

TEST(ClientMessage, HasAtMostSixteenLevels) {
  const auto nested = [](int levels) {
    const auto count = static_cast<std::size_t>(levels - 1);
    return R"({"type": "stop", "x": )" + std::string(count, '[') + std::string(count, ']') + "}";
  };
  EXPECT_EQ(error_of(nested(16)), "");
  EXPECT_EQ(error_of(nested(17)), "message: found more than 16 levels, expected at most 16");
  EXPECT_EQ(error_of(nested(30000)), "message: found more than 16 levels, expected at most 16");
}

}  // namespace
}  // namespace proleg::host
