// Reads arbitrary bytes as a mesh file. The first byte says the format. The reader must return a mesh that the checks,
// the hull and the solid take, or throw a MeshError of one line.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sim/mesh/convex_hull.hpp"
#include "sim/mesh/mesh_checks.hpp"
#include "sim/mesh/mesh_error.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/mesh/mesh_solid.hpp"

namespace {

using namespace proleg::sim;

void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

void check_line(const std::string& text) {
  require(!text.empty() && std::ranges::none_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x20; }),
          "a message is one line");
}

template <typename Action>
void refusing(const Action& action) {
  try {
    action();
  } catch (const MeshError& error) {
    check_line(error.found);
    check_line(error.expected);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 4> names{"a.stl", "a.obj", "a.dae", "a.off"};
  if (size == 0) {
    return 0;
  }
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  refusing([&] {
    const TriangleMesh mesh = read_mesh_file(names[data[0] % names.size()], bytes,
                                             [](const std::string&) { return std::optional("newmtl a\nKd 1 0 0\n"); });
    require(!mesh.triangles.empty() && mesh.triangles.size() <= max_triangles, "a mesh has triangles, not too many");
    require(mesh.colours.empty() || mesh.colours.size() == mesh.vertices.size(), "a colour for each vertex, or none");
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
      require(vertex.allFinite(), "vertices are finite");
    }
    for (const auto& triangle : mesh.triangles) {
      require(std::ranges::all_of(triangle, [&](std::uint32_t corner) { return corner < mesh.vertices.size(); }),
              "triangles name vertices");
    }
    refusing([&] { require_size(mesh, 0.001, 5.0); });
    refusing([&] { require_area(mesh); });
    refusing([&] { require_closed(mesh); });
    refusing([&] { static_cast<void>(without_slivers(mesh)); });
    refusing([&] { require(convex_hull(mesh).mesh.vertices.size() <= max_hull_corners, "a hull has few corners"); });
    static_cast<void>(solid_of(mesh));
  });
  return 0;
}
