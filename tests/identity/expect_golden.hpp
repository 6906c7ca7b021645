#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/identity/golden.hpp"

namespace proleg::identity {

/// Fails unless the player's hashes are the golden ones, and says where the first difference lies.
/// make: makes the player; called a second time to search for the difference.
void expect_golden(const std::function<std::unique_ptr<Player>()>& make, const ActuationModule& algorithm,
                   std::uint32_t cases);

/// Fails unless the player's hashes are those of the native player, whose own are golden (identity_test.cpp). For a
/// number of cases that the table does not have.
void expect_as_native(const std::function<std::unique_ptr<Player>()>& make, const ActuationModule& algorithm,
                      std::uint32_t cases);

/// The same as expect_golden() for a program that a compiler made of the core (variants/ in the build folder), with one
/// kernel for the robot and with one in each module.
void expect_golden_from(std::string_view variant, const ActuationModule& algorithm, std::uint32_t cases);

/// A suite with one instance for each algorithm, by id.
class EachAlgorithm : public testing::TestWithParam<unsigned> {
 protected:
  [[nodiscard]] static const ActuationModule& algorithm() {
    return *find_algorithm(static_cast<std::uint8_t>(GetParam()));
  }
};

[[nodiscard]] std::string algorithm_name(const testing::TestParamInfo<unsigned>& id);

}  // namespace proleg::identity
