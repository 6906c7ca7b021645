// identity: prints the hashes of all identity cases as this computer computes them, in the form of golden.tsv.
// identity --write-golden: writes them to tests/identity/golden.tsv. For a change of the core that is meant to change
// set-points, and for a new algorithm; the change of the file then belongs to the same commit.

#include <exception>
#include <iostream>
#include <string_view>

#include "tests/identity/golden.hpp"

int main(int argument_count, char** arguments) {
  using namespace proleg::identity;
  const bool write = argument_count == 2 && std::string_view(arguments[1]) == "--write-golden";
  if (argument_count != 1 && !write) {
    std::cerr << "identity: found other arguments, expected none or --write-golden\n";
    return 2;
  }
  try {
    std::vector<Golden> rows;
    for (const unsigned id : algorithm_ids()) {
      for (const std::uint32_t cases : {quick_cases, all_cases}) {
        const std::unique_ptr<Player> player = make_native_player(Driver::whole);
        rows.push_back(hash_cases(*player, *find_algorithm(static_cast<std::uint8_t>(id)), cases));
        const Golden& row = rows.back();
        std::cout << row.algorithm << '\t' << row.cases << '\t' << row.ticks << '\t' << row.setpoints << '\t'
                  << row.servo_commands << '\n';
      }
    }
    if (write) {
      write_golden(golden_file(), rows);
    }
  } catch (const std::exception& error) {
    std::cerr << "identity: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
