#pragma once

// A recording made by this program, with the contacts of its world, is verified by cores that other compilers have made
// with other optimisation.

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>

#include "shipped.hpp"
#include "sim/record/recorder.hpp"

namespace proleg::sim {

class OtherCompilers : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  /// Runs each verifier; `hashes` are those of the run.
  void expect_verified(const std::string& hashes) const {
    std::istringstream verifiers(PROLEG_VERIFIERS);
    unsigned count = 0;
    for (std::string verifier; std::getline(verifiers, verifier, ','); ++count) {
      FILE* pipe = popen((verifier + " " + path_.string() + " 2>&1").c_str(), "r");
      ASSERT_NE(pipe, nullptr);
      std::string output;
      for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
        output += static_cast<char>(c);
      }
      EXPECT_EQ(pclose(pipe), 0) << verifier;
      EXPECT_EQ(output, "0 " + hashes + "\n") << verifier;
    }
    EXPECT_EQ(count, 3U);
  }

  Scenario scenario_ = shipped("obstacle/reflex");
  Losses losses_{RandomLosses{3, 1U << 28U, 0, 2000}};
  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("proleg-other-" + std::to_string(::getpid()) + ".proleg");
};

}  // namespace proleg::sim
