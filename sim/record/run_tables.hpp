#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/computer/sqlite/sqlite.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Writes what is known before the first tick: run, files, robot, slots and start values.
void write_run_tables(Database& database, const Scenario& scenario, const std::string& program,
                      const std::string& build_id);

/// Adds rows to the table of parameters. Database and scenario must outlive it.
class ParameterTable {
 public:
  ParameterTable(Database& database, const Scenario& scenario)
      : scenario_(scenario),
        insert_(database,
                "INSERT INTO parameter(tick, origin, slot, joint, name, unit, raw, value_text) "
                "VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)") {}

  /// origin: "start" or "commit". index: of the parameter in the declaration of the slot's algorithm.
  void add(std::uint32_t tick, std::string_view origin, std::uint32_t slot, std::uint32_t joint, std::uint32_t index,
           std::int32_t value);

 private:
  const Scenario& scenario_;
  Statement insert_;
};

}  // namespace proleg::sim
