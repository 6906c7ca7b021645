#pragma once

#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Reads <simulationProperties> into a scenario: stepWidth (s), and ours: duration (s), tick (ms), seed, solver,
/// contactNoise. What is missing keeps its default. Tags of the thesis that have no effect here get a remark.
void read_simulation_properties(const XmlElement& element, Scenario& scenario);

}  // namespace proleg::sim
