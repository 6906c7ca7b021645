#include "host/server/telemetry.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

std::vector<Signal> three_signals() {
  return {{"angle", "degree", 8.381903171539307e-08, 5, SignalOf::joint},
          {"contact", "", 1, 6, SignalOf::link},
          {"head", "um", 1, 7, SignalOf::robot}};
}

TEST(SignalLayout, PutsOneSignalBehindTheOther) {
  const SignalLayout layout(three_signals());
  EXPECT_EQ(layout.row_size(), 18U);
  ASSERT_NE(layout.find("contact"), nullptr);
  EXPECT_EQ(layout.find("contact")->offset, 5U);
  EXPECT_EQ(layout.find("contact")->count, 6U);
  EXPECT_EQ(layout.find("head")->offset, 11U);
  EXPECT_EQ(layout.find("Head"), nullptr);
}

TEST(SignalLayout, DescribesItselfInADocument) {
  const SignalLayout layout(three_signals());
  const nlohmann::json document = layout.document(10000);
  EXPECT_EQ(document["tick_us"], 10000);
  EXPECT_EQ(document["hash"], layout.hash());
  ASSERT_EQ(document["signals"].size(), 3U);
  EXPECT_EQ(document["signals"][0], nlohmann::json::parse(R"({"name": "angle", "unit": "degree",
      "scale": 8.381903171539307e-08, "offset": 0, "count": 5, "of": "joint"})"));
  EXPECT_EQ(document["signals"][1]["of"], "link");
  EXPECT_EQ(document["signals"][2]["of"], "robot");
  EXPECT_EQ(document["signals"][2]["offset"], 11);
}

TEST(SignalLayout, HasAHashOfEverythingThatAReaderNeeds) {
  const std::uint32_t hash = SignalLayout(three_signals()).hash();
  EXPECT_EQ(SignalLayout(three_signals()).hash(), hash);
  const auto changed = [](const auto& change) {
    std::vector<Signal> signals = three_signals();
    change(signals);
    return SignalLayout(signals).hash();
  };
  EXPECT_NE(changed([](auto& signals) { signals[1].name = "contacts"; }), hash);
  EXPECT_NE(changed([](auto& signals) { signals[1].unit = "N"; }), hash);
  EXPECT_NE(changed([](auto& signals) { signals[1].scale = 2; }), hash);
  EXPECT_NE(changed([](auto& signals) { signals[1].count = 7; }), hash);
  EXPECT_NE(changed([](auto& signals) { signals[1].of = SignalOf::joint; }), hash);
  EXPECT_NE(changed([](auto& signals) { std::swap(signals[0], signals[1]); }), hash);
}

TEST(SignalLayout, HasDifferentNames) {
  std::vector<Signal> signals = three_signals();
  signals[2].name = "angle";
  EXPECT_EQ(message_of<std::invalid_argument>([&signals] { SignalLayout{signals}; }),
            "found two signals 'angle', expected different names");
}

}  // namespace
}  // namespace proleg::host
