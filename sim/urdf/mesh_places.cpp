#include "sim/urdf/mesh_places.hpp"

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/mesh/mesh_checks.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/scenario/mesh_reader.hpp"

namespace proleg::sim {
namespace {

namespace fs = std::filesystem;

struct PackagePath {
  std::string package;
  std::string rest;  ///< relative; empty: the name has no path in a package
};

std::optional<PackagePath> package_path(std::string_view name) {
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (name.starts_with(scheme)) {
      std::string_view path = name.substr(scheme.size());
      path.remove_prefix(std::min(path.find_first_not_of('/'), path.size()));
      const std::size_t slash = path.find('/');
      const std::string_view package = path.substr(0, slash);
      const std::size_t rest = slash == std::string_view::npos ? slash : path.find_first_not_of('/', slash);
      if (rest == std::string_view::npos || package == "." || package == "..") {
        return PackagePath{std::string(package), ""};
      }
      return PackagePath{std::string(package), std::string(path.substr(rest))};
    }
  }
  return std::nullopt;
}

/// Whether a folder has a package.xml with this <name>.
bool is_package(const fs::path& folder, const std::string& name, FileSource& files) {
  const std::optional<SharedText> text = files.read(folder / "package.xml");
  if (!text) {
    return false;
  }
  const std::string_view all = text->str();
  const std::size_t begin = all.find("<name>");
  const std::size_t end = all.find("</name>");
  constexpr std::size_t tag = 6;
  return begin != std::string_view::npos && end != std::string_view::npos && begin + tag <= end &&
         trimmed(all.substr(begin + tag, end - begin - tag)) == name;
}

/// Where a mesh may be, and the folder that it should not leave.
struct Place {
  fs::path path;
  fs::path root;
};

/// The folders above a file, from its own one on.
std::vector<fs::path> folders_above(const fs::path& file) {
  std::error_code error;
  const fs::path folder = file.parent_path();
  fs::path up = fs::absolute((folder.empty() ? fs::path(".") : folder) / "", error).lexically_normal().parent_path();
  std::vector<fs::path> folders{up};
  while (up.has_relative_path() && up != up.parent_path()) {
    up = up.parent_path();
    folders.push_back(up);
  }
  return folders;
}

/// The folder that belongs to a robot: that of its package; without one the folder above "urdf" or a similar one; else
/// the folder of the file.
fs::path root_of_robot(const fs::path& urdf, FileSource& files) {
  const std::vector<fs::path> folders = folders_above(urdf);
  for (const fs::path& folder : folders) {
    if (files.read(folder / "package.xml")) {
      return folder;
    }
  }
  const std::string name = lower_case(folders[0].filename().string());
  const bool is_part = name == "urdf" || name == "urdfs" || name == "robots" || name == "model" || name == "models" ||
                       name == "description" || name == "xacro";
  return is_part && folders.size() > 1 ? folders[1] : folders[0];
}

std::vector<Place> places_of(const std::string& name, const fs::path& urdf, const PackageFolders& packages,
                             FileSource& files) {
  const std::optional<PackagePath> in_package = package_path(name);
  if (!in_package) {
    constexpr std::string_view scheme = "file://";
    return {{urdf.parent_path() / (name.starts_with(scheme) ? name.substr(scheme.size()) : name),
             root_of_robot(urdf, files)}};
  }
  if (in_package->rest.empty()) {
    return {};
  }
  if (const auto given = packages.find(in_package->package); given != packages.end()) {
    return {{given->second / in_package->rest, given->second}};
  }
  std::vector<Place> places;
  for (const fs::path& up : folders_above(urdf)) {
    if (up.filename() == in_package->package || is_package(up, in_package->package, files)) {
      places.push_back({up / in_package->rest, up});
    }
    places.push_back({up / in_package->package / in_package->rest, up / in_package->package});
  }
  return places;
}

/// The only file on disk that has this path but for capitals.
std::optional<fs::path> with_its_capitals(const fs::path& path) {
  fs::path result;
  for (const fs::path& part : path.lexically_normal()) {
    std::error_code error;
    if (part == path.root_path() || fs::exists(result / part, error)) {
      result /= part;
      continue;
    }
    std::vector<fs::path> similar;
    fs::directory_iterator entry(result.empty() ? fs::path(".") : result, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
      if (lower_case(entry->path().filename().string()) == lower_case(part.string())) {
        similar.push_back(entry->path().filename());
      }
    }
    if (similar.size() != 1) {
      return std::nullopt;
    }
    result /= similar.front();
  }
  return result;
}

/// Links to files count where they lead.
bool is_in(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  const fs::path from = fs::weakly_canonical(fs::absolute(folder, error), error);
  const fs::path relative = fs::weakly_canonical(fs::absolute(file, error), error).lexically_relative(from);
  return !error && !relative.empty() && *relative.begin() != "..";
}

bool is_mesh(const FoundMesh& mesh) {
  try {
    static_cast<void>(
        read_mesh_file(mesh.path.filename().string(), mesh.bytes, [](const std::string&) { return std::nullopt; }));
    return true;
  } catch (const MeshError&) {
    return false;
  }
}

}  // namespace

std::optional<FoundMesh> find_mesh(const std::string& name, const fs::path& urdf, const PackageFolders& packages,
                                   FileSource& files) {
  std::vector<Place> places = places_of(name, urdf, packages, files);
  const auto find = [&](bool is_respelled) -> std::optional<FoundMesh> {
    for (const Place& place : places) {
      if (std::optional<SharedText> bytes = files.read(place.path)) {
        return FoundMesh{place.path, place.root, std::move(*bytes), is_respelled};
      }
    }
    return std::nullopt;
  };
  if (auto found = find(false)) {
    return found;
  }
  std::string with_slashes = name;
  std::ranges::replace(with_slashes, '\\', '/');
  places = places_of(with_slashes, urdf, packages, files);
  if (auto found = find(true)) {
    return found;
  }
  for (Place& place : places) {
    place.path = with_its_capitals(place.path).value_or(place.path);
  }
  return find(true);
}

ImportedTexts::ImportedTexts(const std::vector<SourceFile>& files, KnownMeshes& meshes) : meshes_(&meshes) {
  for (const SourceFile& file : files) {
    texts_.add(file.path, file.text);
  }
}

std::string ImportedMeshes::expected(const std::string& mesh) {
  const std::optional<PackagePath> in_package = package_path(mesh);
  if (!in_package) {
    return "a file whose path is relative to the folder of the URDF file";
  }
  if (in_package->rest.empty()) {
    return "package://NAME/PATH of a mesh";
  }
  std::string folder = "FOLDER";
  for (const fs::path& up : folders_above(urdf_)) {
    if (source_->read(up / in_package->rest)) {
      folder = up.string() + ", which has it";
      break;
    }
  }
  return "it in a folder " + in_quotes(in_package->package) + " beside or above the URDF file, or --package " +
         one_line(in_package->package) + '=' + one_line(folder);
}

const ImportedMeshes::Candidate& ImportedMeshes::candidate(const std::string& mesh) {
  const auto [known, is_new] = candidates_.try_emplace(mesh);
  Candidate& result = known->second;
  if (!is_new) {
    return result;
  }
  const std::optional<FoundMesh> found = find_mesh(mesh, urdf_, *packages_, *source_);
  if (!found) {
    result.expected = expected(mesh);
    result.named.problem = "found no file for the mesh " + in_quotes(mesh) + ", expected " + result.expected;
    return result;
  }
  if (!is_in(found->path, found->root)) {
    if (!is_mesh(*found)) {  // no message shows what is in it
      result.named.problem = "found " + in_quotes(mesh) + " outside of the robot's folder " +
                             in_quotes(found->root.string()) + ", which is no mesh, expected a mesh in that folder";
      return result;
    }
    outside_.push_back(in_quotes(mesh));
  }
  if (found->is_respelled) {
    notes_.push_back("the mesh " + in_quotes(mesh) + " is the file " + in_quotes(found->path.string()) +
                     ": names count as on Windows");
  }
  const fs::path folder = found->path.parent_path().lexically_normal();
  const std::size_t number = folders_.emplace(folder.string(), folders_.size() + 1).first->second;
  const std::string target = number == 1 ? "meshes" : "meshes" + std::to_string(number);
  result.named.file = target + '/' + found->path.filename().string();
  result.files.push_back({result.named.file, source_text(found->bytes)});
  if (lower_case(result.named.file).ends_with(".obj")) {
    add_materials(folder, target, found->bytes, result.files);
  }
  return result;
}

ImportedMeshes::Named ImportedMeshes::touching(const std::string& mesh) {
  const Candidate& found = candidate(mesh);
  use(found);
  return found.named;
}

ImportedMeshes::Named ImportedMeshes::shown(const std::string& mesh, const Eigen::Vector3d& scale) {
  const Candidate& found = candidate(mesh);
  if (found.named.file.empty()) {
    return found.expected.empty() ? found.named : Named{"", "found no such file, expected " + found.expected};
  }
  const std::string text =
      found.named.file + ' ' + exact_text(scale.x()) + ' ' + exact_text(scale.y()) + ' ' + exact_text(scale.z());
  const XmlDocument document("robot.robot.xml", "<render>" + escaped_xml(text) + "</render>", nullptr);
  ImportedTexts files(found.files, known_meshes_);
  std::vector<SourceFile> record;
  std::vector<std::string> remarks;
  SourceSet sources(files, "robot.simulation.xml", record);
  try {
    static_cast<void>(read_mesh_of_file(document.root("render"), MeshUse::look, false, sources, remarks));
  } catch (const InputError& error) {
    return {"", error.problem()};
  }
  use(found);
  return found.named;
}

void ImportedMeshes::add_materials(const fs::path& folder, const std::string& target, const std::string& text,
                                   std::vector<SourceFile>& files) {
  TextLines lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    constexpr std::string_view keyword = "mtllib ";
    if (!line->starts_with(keyword)) {
      continue;
    }
    const fs::path name = fs::path(std::string(trimmed(line->substr(keyword.size())))).filename();
    if (lower_case(name.extension().string()) != ".mtl") {
      continue;
    }
    if (const std::optional<SharedText> materials = source_->read(folder / name)) {
      files.push_back({target + '/' + name.string(), *materials});
    }
  }
}

void ImportedMeshes::use(const Candidate& mesh) {
  for (const SourceFile& file : mesh.files) {
    if (std::ranges::find(files_, file.path, &SourceFile::path) == files_.end()) {
      files_.push_back(file);
    }
  }
}

}  // namespace proleg::sim
