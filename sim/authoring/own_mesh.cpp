#include "sim/authoring/own_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/mesh/mesh_checks.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/mesh/mesh_geometry.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view material_ending = ".mtl";

constexpr std::string_view replacement = "\xEF\xBF\xBD";  // what a browser writes for bytes that are no UTF-8

void require_file_name(const std::string& name) {
  const bool is_name = !name.empty() && name.front() != '.' && name.find_first_of("/\\") == std::string::npos &&
                       name.find(replacement) == std::string::npos && is_visible_line(name) && trimmed(name) == name &&
                       shortened(name) == name;
  if (!is_name) {
    throw InputError("file", 0, "the name " + in_quotes(one_line(name)),
                     "1 to 60 characters that a person sees, without a folder, not beginning with '.'");
  }
}

/// The first line of what is thrown, if anything is.
template <typename Check>
std::optional<std::string> problem_of(const Check& check) {
  try {
    check();
    return std::nullopt;
  } catch (const MeshError& error) {
    return one_line(error.found);
  }
}

MeshFacts facts_of(const TriangleMesh& mesh) {
  MeshFacts facts;
  const Bounds bounds = bounds_of(mesh, {});
  facts.lowest = bounds.lowest;
  facts.highest = bounds.highest;
  facts.flaw = problem_of([&] { require_area(mesh); });
  facts.gap = problem_of([&] { require_closed(mesh); });
  static_cast<void>(problem_of([&] { facts.hull_volume = solid_of(convex_hull(mesh).mesh).volume; }));
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
    facts.facing += (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a) / 2.0;
  }
  return facts;
}

}  // namespace

std::size_t require_mesh_files(const std::vector<std::string>& names) {
  std::optional<std::size_t> mesh;
  std::set<std::string> known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    require_file_name(name);
    if (!known.insert(name).second) {
      throw InputError("file", 0, in_quotes(name) + " twice", "files of different names");
    }
    if (lower_case(name).ends_with(material_ending)) {
      continue;
    }
    if (!is_mesh_file_name(name)) {
      throw InputError("file", 0, in_quotes(name),
                       "a name that ends with " + std::string(mesh_file_endings) + ", or .mtl beside an .obj file");
    }
    if (mesh) {
      throw InputError("file", 0, in_quotes(names[*mesh]) + " and " + in_quotes(name), "one mesh at a time");
    }
    mesh = i;
  }
  if (!mesh) {
    throw InputError("file", 0, names.empty() ? "no file" : in_quotes(names.front()) + " without a mesh",
                     "a file that ends with " + std::string(mesh_file_endings));
  }
  return *mesh;
}

OwnMesh read_own_mesh(std::vector<NamedBytes> files) {
  std::vector<std::string> names;
  for (const NamedBytes& file : files) {
    names.push_back(file.name);
    if (file.bytes.empty()) {
      throw InputError(file.name, 0, "an empty file", "a mesh");
    }
  }
  std::swap(files.front(), files[require_mesh_files(names)]);
  std::set<std::string> used{files.front().name};
  OwnMesh own;
  try {
    own.mesh = read_mesh_file(files.front().name, files.front().bytes,
                              [&](const std::string& beside) -> std::optional<std::string> {
                                const std::string name = fs::path(beside).filename().string();
                                const auto found = std::ranges::find(files, name, &NamedBytes::name);
                                if (found == files.end()) {
                                  return std::nullopt;
                                }
                                used.insert(name);
                                return found->bytes;
                              });
    own.facts = facts_of(own.mesh);
    if (!((own.facts.highest - own.facts.lowest).maxCoeff() > 0.0)) {
      throw MeshError("a mesh whose points are all at one place", "a mesh that has a size");
    }
  } catch (const MeshError& error) {
    throw InputError(files.front().name, 0, error.found, error.expected);
  }
  std::erase_if(files, [&](const NamedBytes& file) { return !used.contains(file.name); });
  own.files = std::move(files);
  return own;
}

Eigen::Quaterniond MeshFit::rotation() const {
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  for (std::size_t axis = 0; axis < quarter_turns.size(); ++axis) {
    for (unsigned i = 0; i < quarter_turns.at(axis) % 4; ++i) {
      // Whole numbers: a turn of 90 degrees has no rounding.
      Eigen::Matrix3d quarter = Eigen::Matrix3d::Zero();
      const auto at = static_cast<Eigen::Index>(axis);
      const Eigen::Index next = (at + 1) % 3;
      const Eigen::Index last = (at + 2) % 3;
      quarter(at, at) = 1.0;
      quarter(last, next) = 1.0;
      quarter(next, last) = -1.0;
      turned = (quarter * turned).eval();
    }
  }
  return Eigen::Quaterniond(turned);
}

void require_fit(const MeshFit& fit) {
  constexpr double least = 1e-6;
  constexpr double most = 1e6;
  if (!(fit.factor >= least && fit.factor <= most)) {
    throw InputError("factor", 0, number_text(fit.factor), "a number from 1e-06 to 1e+06");
  }
  if (std::ranges::any_of(fit.quarter_turns, [](unsigned count) { return count > 3; })) {
    throw InputError("quarters", 0, "more than 3 turns about an axis", "0 to 3 turns of 90 degrees");
  }
  if (!(fit.colour.minCoeff() >= 0.0 && fit.colour.maxCoeff() <= 1.0)) {
    throw InputError("colour", 0, vector_text(fit.colour), "red, green and blue from 0 to 1");
  }
}

FittedBox fitted_box(const MeshFacts& facts, const MeshFit& fit) {
  const Eigen::Quaterniond rotation = fit.rotation();
  const Eigen::Vector3d one = rotation * (fit.factor * facts.lowest);
  const Eigen::Vector3d other = rotation * (fit.factor * facts.highest);
  return {one.cwiseMin(other), one.cwiseMax(other)};  // quarter turns: corners stay corners
}

std::string mesh_lines(const std::string& file, const MeshFit& fit, const Eigen::Vector3d& translation) {
  std::string lines;
  if (!translation.isZero(1e-9)) {
    lines += element_text("Translation", vector_text(translation)) + "\n";
  }
  if (const auto rotation = rotation_text(fit.rotation())) {
    lines += element_text("RotationAxis", *rotation) + "\n";
  }
  lines += element_text("data", file + (fit.factor == 1.0 ? "" : " " + number_text_of(fit.factor))) + "\n";
  return lines + element_text("diffuseColor", vector_text(fit.colour)) + "\n";
}

std::string add_in_free_folder(DraftChange& change, const fs::path& parent, const std::string& folder,
                               std::span<const SourceFile> files) {
  for (unsigned number = 1;; ++number) {
    const std::string name = folder + (number == 1 ? "" : "_" + std::to_string(number));
    std::vector<SourceFile> missing;
    const bool is_free = std::ranges::all_of(files, [&](const SourceFile& file) {
      const std::string path = name_of(parent / name / fs::path(file.path).filename());
      const std::optional<SharedText> present = change.read(path);
      if (!present) {
        missing.push_back({path, file.text});
      }
      return !present || source_text(*present) == file.text;
    });
    if (is_free) {
      for (const SourceFile& file : missing) {
        change.add_file(file.path, file.text);
      }
      return name;
    }
  }
}

std::vector<SourceFile> source_files(const OwnMesh& mesh) {
  std::vector<SourceFile> files;
  for (const NamedBytes& file : mesh.files) {
    files.push_back({file.name, source_text(file.bytes)});
  }
  return files;
}

}  // namespace proleg::sim
