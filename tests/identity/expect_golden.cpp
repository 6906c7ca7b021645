#include "tests/identity/expect_golden.hpp"

#include <algorithm>
#include <filesystem>

namespace proleg::identity {
namespace {

/// expected: what has these hashes.
void expect_hashes(const Golden& expected, const std::string& whose,
                   const std::function<std::unique_ptr<Player>()>& make, const ActuationModule& algorithm,
                   std::uint32_t cases) {
  const std::unique_ptr<Player> player = make();
  const Golden found = hash_cases(*player, algorithm, cases);
  if (found != expected) {
    const std::unique_ptr<Player> again = make();
    const std::unique_ptr<Player> reference = make_native_player(Driver::whole);
    ADD_FAILURE() << found.algorithm << ": set-points " << found.setpoints << " and servo commands "
                  << found.servo_commands << " are not " << whose << "; compared with one kernel in this program: "
                  << first_difference(*again, *reference, algorithm, cases);
  }
}

}  // namespace

void expect_golden(const std::function<std::unique_ptr<Player>()>& make, const ActuationModule& algorithm,
                   std::uint32_t cases) {
  const std::vector<Golden> table = read_golden(golden_file());
  const std::string name(algorithm.declaration().name);
  const auto expected = std::find_if(table.begin(), table.end(), [&](const Golden& row) {
    return row.algorithm == name && row.cases == cases && row.ticks == tick_count;
  });
  ASSERT_NE(expected, table.end()) << golden_file() << " has no row for " << name << " with " << cases
                                   << " cases: build/host/bin/identity --write-golden";
  expect_hashes(*expected, "the golden ones (if the change is meant: build/host/bin/identity --write-golden)", make,
                algorithm, cases);
}

void expect_as_native(const std::function<std::unique_ptr<Player>()>& make, const ActuationModule& algorithm,
                      std::uint32_t cases) {
  const std::unique_ptr<Player> native = make_native_player(Driver::whole);
  expect_hashes(hash_cases(*native, algorithm, cases), "those of the native player", make, algorithm, cases);
}

void expect_golden_from(std::string_view variant, const ActuationModule& algorithm, std::uint32_t cases) {
  const std::filesystem::path program = std::filesystem::path(PROLEG_VARIANT_DIR) / variant;
  for (const Driver driver : {Driver::whole, Driver::modules}) {
    expect_golden([=] { return make_variant_player(program, driver, cases); }, algorithm, cases);
  }
}

std::string algorithm_name(const testing::TestParamInfo<unsigned>& id) {
  return std::string(find_algorithm(static_cast<std::uint8_t>(id.param))->declaration().name);
}

}  // namespace proleg::identity
