#pragma once

#include <filesystem>
#include <string>

#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {

/// A scenario that ships, e.g. "travelling_wave/coupled".
inline Scenario shipped(const std::string& name) {
  DiskFiles files;
  return read_scenario(std::filesystem::path(source_path("/sim/scenarios")) / (name + ".simulation.xml"), files);
}

}  // namespace proleg::sim
