#pragma once

#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Checks the attributes of an element of a URDF file, and of all that is in it. Throws InputError for an expression
/// that xacro would replace, and for numbers that are none, too many, too few, or out of range.
void check_urdf_values(const XmlElement& element);

/// Throws InputError if a shape lacks an attribute that gives its size.
void require_urdf_sizes(const XmlElement& shape);

}  // namespace proleg::sim
