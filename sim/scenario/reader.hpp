#pragma once

// Scenarios from XML files, in the format of the thesis (listings B.1, B.2, B.5, B.6) with a few additions. The
// top-level file names the others. A path is relative to the folder of the file that contains it; if there is no such
// file, to the folder of the top-level file:
//
//   <simulation>
//     <robot>caterpillar.robot.xml</robot>                    robot_reader.hpp, kinbody_reader.hpp,
//                                                             geometry_reader.hpp
//     <actuation>uniform.actuation.xml</actuation>            actuation_reader.hpp
//     <environment>flat.environment.xml</environment>         environment_reader.hpp
//     <simulationProperties>...</simulationProperties>        optional
//   </simulation>
//
// The case of tags and attributes does not matter; the case of names does. An unknown tag or attribute is an error that
// lists the known ones. Lengths are metres, masses kilograms, angles degrees unless a tag says otherwise.

#include <filesystem>
#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Reads <simulationProperties> into a scenario: stepWidth (s), and ours: duration (s), tick (ms), seed, solver,
/// contactNoise. What is missing keeps its default. Tags of the thesis that have no effect here get a remark.
void read_simulation_properties(const XmlElement& element, Scenario& scenario);

/// Reads a top-level simulation file and all that it names, and applies the overrides. Throws InputError.
[[nodiscard]] Scenario read_scenario(const std::filesystem::path& path, FileSource& files,
                                     const Overrides& overrides = {});

}  // namespace proleg::sim
