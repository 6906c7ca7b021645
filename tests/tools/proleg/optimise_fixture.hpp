#pragma once

// Searches in short trials, and questions to their stores.

#include <sqlite3.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "command_line.hpp"
#include "json_result.hpp"
#include "tests/support/files.hpp"

namespace proleg::test {

class Optimise : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    const std::string shipped = source_path("/sim/scenarios/travelling_wave/");
    write("short.simulation.xml", "<simulation><robot>" + shipped + "caterpillar.robot.xml</robot><actuation>" +
                                      shipped + "uniform.actuation.xml</actuation><environment>" + shipped +
                                      "flat.environment.xml</environment><simulationProperties><duration>0.2</duration>"
                                      "</simulationProperties></simulation>");
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(file(name)) << text; }

  [[nodiscard]] static std::string shipped(const std::string& name) {
    return source_path("/sim/scenarios/travelling_wave/") + name + ".optimise.xml";
  }

  /// Words for a search in short trials that leaves its results in a folder.
  [[nodiscard]] std::vector<std::string> words(const std::string& experiment, const std::string& folder,
                                               const std::vector<std::string>& rest = {}) const {
    std::vector<std::string> all{"optimise", shipped(experiment), "--simulation", file("short.simulation.xml").string(),
                                 "--json"};
    if (!folder.empty()) {
      all.insert(all.end(), {"--out", file(folder).string()});
    }
    all.insert(all.end(), rest.begin(), rest.end());
    return all;
  }

  /// The rows of a query on a store, as text.
  [[nodiscard]] std::string select(const std::string& folder, const std::string& question) const {
    std::string text;
    sqlite3* store = nullptr;
    EXPECT_EQ(sqlite3_open_v2(file(folder + "/store.sqlite").c_str(), &store, SQLITE_OPEN_READWRITE, nullptr),
              SQLITE_OK);
    const auto append = [](void* out, int columns, char** values, char**) {
      for (int i = 0; i < columns; ++i) {
        *static_cast<std::string*>(out) += std::string(values[i] == nullptr ? "NULL" : values[i]) + "|";
      }
      *static_cast<std::string*>(out) += "\n";
      return 0;
    };
    EXPECT_EQ(sqlite3_exec(store, question.c_str(), append, &text, nullptr), SQLITE_OK) << question;
    sqlite3_close(store);
    return text;
  }

  /// The first evaluations of a store, without what depends on time.
  [[nodiscard]] std::string evaluations(const std::string& folder, int count = 1'000'000) const {
    // Seventeen digits distinguish all doubles.
    return select(
        folder,
        "SELECT run, number, candidate, seed, reused, printf('%.17g', distance), printf('%.17g', smoothness), "
        "printf('%.17g', mechanical_energy), printf('%.17g', stability_margin) FROM evaluation WHERE number < " +
            std::to_string(count) + " ORDER BY run, number");
  }

  /// Waits until a store holds that many evaluations. Only a test that fails waits to the end.
  void wait_for(const std::string& folder, int count) const {
    constexpr std::chrono::minutes longest(5);
    for (const auto end = std::chrono::steady_clock::now() + longest; std::chrono::steady_clock::now() < end;) {
      sqlite3* store = nullptr;
      int found = 0;
      if (fs::exists(file(folder + "/store.sqlite")) && sqlite3_open_v2(file(folder + "/store.sqlite").c_str(), &store,
                                                                        SQLITE_OPEN_READWRITE, nullptr) == SQLITE_OK) {
        const auto take = [](void* out, int, char** values, char**) {
          *static_cast<int*>(out) = std::atoi(values[0]);
          return 0;
        };
        sqlite3_exec(store, "SELECT count(*) FROM evaluation", take, &found, nullptr);
      }
      sqlite3_close(store);
      if (found >= count) {
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "no " << count << " evaluations within " << longest.count() << " minutes";
  }

  /// The command that starts proleg with these words four times.
  [[nodiscard]] static std::vector<std::string> under_mpirun(const std::vector<std::string>& words) {
    // Open MPI leaks memory, some of it in plugins that are unloaded when leaks are counted: no suppression matches
    // them.
    std::vector<std::string> command{"mpirun", "--oversubscribe", "-n", "4", "-x", "ASAN_OPTIONS=detect_leaks=0"};
    if (geteuid() == 0) {
      command.emplace_back("--allow-run-as-root");
    }
    command.emplace_back(PROLEG_PROGRAM);
    command.insert(command.end(), words.begin(), words.end());
    return command;
  }

  [[nodiscard]] pid_t start_proleg(const std::vector<std::string>& words) const {
    std::vector<std::string> command{PROLEG_PROGRAM};
    command.insert(command.end(), words.begin(), words.end());
    return start(command);
  }
};

inline Json json_of(const Finished& finished) {
  EXPECT_EQ(finished.status, 0) << finished.err;
  return Json(finished.out);
}

}  // namespace proleg::test
