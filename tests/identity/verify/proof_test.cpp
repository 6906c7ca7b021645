#include "tests/identity/verify/proof.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/identity/verify/forbidden_symbols.hpp"

namespace proleg::verify {
namespace {

using nlohmann::json;
using Result = ProofRow::Result;

Proof good_proof() {
  Proof proof;
  proof.algorithm = "my_wave";
  proof.id = 119;
  proof.sources = 0xCC31605C;
  proof.cases = 50;
  proof.ticks = 1000;
  proof.rows = {{"library", 1, Result::reference, std::string(64, 'a'), std::string(64, 'b'), ""},
                {"g++ -O0", 5, Result::equal, std::string(64, 'a'), std::string(64, 'b'), ""}};
  proof.test = TestResult{"my_wave_test", ""};
  proof.forbidden = std::vector<std::string>();
  proof.cost = TickInstructions{617, 616.5, 2500, ""};
  proof.stack = StackBound{336, "proleg::Kernel::advance", 512};
  proof.flash_bytes = 604;
  return proof;
}

TEST(Proof, TheObjectHasWhatTheTableHas) {
  Proof proof = good_proof();
  proof.rows.push_back({"Cortex-M0", 5, Result::not_run, "", "", "arm-none-eabi-g++"});
  proof.leaves_out_missing = true;
  const json object = json::parse(proof_json(proof));
  EXPECT_EQ(object["algorithm"], "my_wave");
  EXPECT_EQ(object["id"], 119);
  EXPECT_EQ(object["sources"], "0xCC31605C");
  EXPECT_EQ(object["cases"], 50);
  EXPECT_EQ(object["ticks"], 1000);
  EXPECT_EQ(object["verified"], true);
  ASSERT_EQ(object["builds"].size(), 3U);
  EXPECT_EQ(object["builds"][1], json({{"build", "g++ -O0"},
                                       {"kernels", 5},
                                       {"result", "equal"},
                                       {"ticks", 50'000},
                                       {"setpoint_hash", std::string(64, 'a')},
                                       {"servo_hash", std::string(64, 'b')},
                                       {"text", nullptr}}));
  EXPECT_EQ(object["builds"][2]["result"], "not run");
  EXPECT_EQ(object["builds"][2]["ticks"], 0);
  EXPECT_EQ(object["builds"][2]["setpoint_hash"], nullptr);
  EXPECT_EQ(object["missing"], json::array({"arm-none-eabi-g++"}));
  EXPECT_EQ(object["test"], json({{"name", "my_wave_test"}, {"passed", true}, {"error", nullptr}}));
  EXPECT_EQ(object["forbidden"], json::array());
  EXPECT_EQ(object["instructions"],
            json({{"worst", 617}, {"mean", 616.5}, {"limit", 2500}, {"fits", true}, {"error", nullptr}}));
  EXPECT_EQ(object["stack"],
            json({{"bytes", 336}, {"function", "proleg::Kernel::advance"}, {"limit", 512}, {"fits", true}}));
  EXPECT_EQ(object["flash_bytes"], 604);
}

TEST(Proof, WhatWasNotLookedAtIsNull) {
  Proof proof = good_proof();
  proof.test.reset();
  proof.forbidden.reset();
  proof.cost.reset();
  proof.stack.reset();
  proof.flash_bytes.reset();
  const json object = json::parse(proof_json(proof));
  for (const char* member : {"test", "forbidden", "instructions", "stack", "flash_bytes"}) {
    EXPECT_TRUE(object.at(member).is_null()) << member;
  }
}

TEST(Proof, OneBadThingIsEnoughForABadVerdict) {
  EXPECT_TRUE(is_sound(good_proof()));
  const auto verdict = [](const auto& spoil) {
    Proof proof = good_proof();
    spoil(proof);
    EXPECT_EQ(json::parse(proof_json(proof))["verified"], is_sound(proof));
    EXPECT_EQ(result_lines(proof).back(), is_sound(proof) ? "verified: the same bits everywhere" : "NOT verified");
    return is_sound(proof);
  };
  EXPECT_FALSE(verdict([](Proof& proof) { proof.rows.clear(); })) << "nothing was compared";
  EXPECT_FALSE(verdict([](Proof& proof) { proof.rows[1].result = Result::differs; }));
  EXPECT_FALSE(verdict([](Proof& proof) { proof.rows[1].result = Result::failed; }));
  EXPECT_FALSE(verdict([](Proof& proof) { proof.rows[1].result = Result::not_run; }));
  EXPECT_TRUE(verdict([](Proof& proof) {
    proof.rows[1].result = Result::not_run;
    proof.leaves_out_missing = true;
  }));
  EXPECT_FALSE(verdict([](Proof& proof) { proof.test->error = "line 4: 1 is not 2"; }));
  EXPECT_FALSE(verdict([](Proof& proof) { proof.forbidden = {"uses the heap (malloc)"}; }));
  EXPECT_FALSE(verdict([](Proof& proof) { proof.cost->worst = 2501; }));
  EXPECT_FALSE(verdict([](Proof& proof) { proof.cost->error = "no such function"; }));
  EXPECT_FALSE(verdict([](Proof& proof) { proof.stack->bytes = 513; }));
  EXPECT_FALSE(verdict([](Proof& proof) { proof.stack->bytes = 0; })) << "the bound is not known";
}

TEST(Proof, ADifferenceIsNamedWithItsCaseTickAndJoint) {
  Proof proof = good_proof();
  proof.rows[1].result = Result::differs;
  proof.rows[1].text = "case 0, tick 3, joint 2: set-point 5 instead of 4";
  EXPECT_EQ(row_text(proof.rows[1]),
            "g++ -O0        five     aaaaaaaaaaaa   bbbbbbbbbbbb   DIFFERS: case 0, tick 3, joint 2: set-point 5 "
            "instead of 4");
  const json object = json::parse(proof_json(proof));
  EXPECT_EQ(object["builds"][1]["result"], "differs");
  EXPECT_EQ(object["builds"][1]["text"], "case 0, tick 3, joint 2: set-point 5 instead of 4");
}

TEST(Proof, TheFlashOfAnObjectIsItsCodeAndItsConstants) {
  EXPECT_EQ(
      flash_bytes(
          "   text\t   data\t    bss\t    dec\t    hex\tfilename\n    600\t      4\t      0\t    604\t    25c\ta.o\n"),
      604U);
  EXPECT_EQ(flash_bytes("a.o: file format not recognized\n"), std::nullopt);
  EXPECT_EQ(flash_bytes(""), std::nullopt);
}

}  // namespace
}  // namespace proleg::verify
