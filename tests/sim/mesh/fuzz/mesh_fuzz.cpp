// Reads arbitrary bytes as a mesh file. The first byte says the format. The reader must return a mesh that the checks,
// the hull and the solid take, or throw a MeshError of one line.
//
// The import runs in this process, where the fuzzer sees what an input reaches and the sanitizers report errors in the
// reader; a child for each input would take three times as long. So an input that ends Assimp ends this program too. If
// the fault is in libassimp (look at the trace), that is no error of the reader, which runs the import in a child:
// mesh_file_test and import_process_test show the error that a user gets then. Assimp reserves memory for as many
// vertices as a file says. Here a large block is refused, as by the limit of the child.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <optional>
#include <string>
#include <string_view>

#include "sim/mesh/mesh_checks.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/mesh/mesh_geometry.hpp"

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

void check_mesh(const TriangleMesh& mesh) {
  require(!mesh.triangles.empty() && mesh.triangles.size() <= max_triangles, "a mesh has triangles, not too many");
  require(mesh.vertices.size() <= max_mesh_vertices, "a mesh has not too many vertices");
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
}

std::optional<std::string> materials(const std::string& /*name*/) { return "newmtl a\nKd 1 0 0\n"; }

constexpr std::size_t largest_block = std::size_t{4} << 20U;

bool is_importing = false;  ///< the fuzzer itself has larger blocks

void* allocated(std::size_t size) {
  void* const block = !is_importing || size <= largest_block ? std::malloc(size) : nullptr;
  if (block == nullptr) {
    throw std::bad_alloc();
  }
  return block;
}

}  // namespace

// Those of the program stand in for those of all libraries. AddressSanitizer checks the memory of malloc() too.
void* operator new(std::size_t size) { return allocated(size); }
void* operator new[](std::size_t size) { return allocated(size); }
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept { return std::malloc(size); }
void* operator new[](std::size_t size, const std::nothrow_t& /*tag*/) noexcept { return std::malloc(size); }
void operator delete(void* block) noexcept { std::free(block); }
void operator delete[](void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t /*size*/) noexcept { std::free(block); }
void operator delete[](void* block, std::size_t /*size*/) noexcept { std::free(block); }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 4> names{"a.stl", "a.obj", "a.dae", "a.off"};
  if (size == 0) {
    return 0;
  }
  const char* const name = names[data[0] % names.size()];
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  refusing([&] {
    is_importing = true;
    check_mesh(import_mesh(name, bytes, materials));
  });
  is_importing = false;
  return 0;
}
