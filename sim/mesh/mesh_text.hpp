#pragma once

// The bytes of a mesh file in the form that Assimp reads. Its importers lose the first line of a text with a byte order
// mark, and refuse or cut STL files that other programs read.

#include <string>

namespace proleg::sim {

/// The text of an OBJ, MTL, OFF or COLLADA file without byte order mark, its lines ended by "\n" or "\r\n".
///
/// name: of the file, for messages. Throws MeshError for text in UTF-16.
[[nodiscard]] std::string plain_text(const std::string& name, const std::string& bytes);

/// An STL file. Of a binary one, without what is behind its last triangle. Of a text, in lower case, from its first
/// solid on, without solids that have no triangle, and without normals that are not finite: no reader needs them.
///
/// Throws MeshError for text in UTF-16, for a binary file whose size does not fit its number of triangles, and for a
/// text that is no sequence of solids (3D Systems, "StereoLithography Interface Specification", 1988), among them one
/// that ends before its last "endsolid".
[[nodiscard]] std::string plain_stl(const std::string& name, const std::string& bytes);

}  // namespace proleg::sim
