#include "sim/urdf/mesh_places.hpp"

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

namespace fs = std::filesystem;

struct PackagePath {
  std::string package;
  std::string rest;
};

std::optional<PackagePath> package_path(std::string_view name) {
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (name.starts_with(scheme)) {
      const std::string_view path = name.substr(scheme.size());
      const std::size_t slash = path.find('/');
      if (slash == 0 || slash == std::string_view::npos || slash + 1 == path.size()) {
        return PackagePath{std::string(path.substr(0, slash)), ""};
      }
      return PackagePath{std::string(path.substr(0, slash)), std::string(path.substr(slash + 1))};
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

std::optional<FoundMesh> read(const fs::path& path, FileSource& files) {
  std::optional<SharedText> bytes = files.read(path);
  return bytes ? std::optional(FoundMesh{path, std::move(*bytes)}) : std::nullopt;
}

}  // namespace

std::optional<FoundMesh> find_mesh(const std::string& name, const fs::path& urdf, const PackageFolders& packages,
                                   FileSource& files) {
  const fs::path folder = urdf.parent_path();
  const std::optional<PackagePath> in_package = package_path(name);
  if (!in_package) {
    constexpr std::string_view scheme = "file://";
    return read(folder / (name.starts_with(scheme) ? name.substr(scheme.size()) : name), files);
  }
  if (in_package->rest.empty()) {
    return std::nullopt;
  }
  if (const auto given = packages.find(in_package->package); given != packages.end()) {
    return read(given->second / in_package->rest, files);
  }
  std::error_code error;
  const fs::path start =
      fs::absolute((folder.empty() ? fs::path(".") : folder) / "", error).lexically_normal().parent_path();
  for (fs::path up = start;; up = up.parent_path()) {
    if (up.filename() == in_package->package || is_package(up, in_package->package, files)) {
      if (auto found = read(up / in_package->rest, files)) {
        return found;
      }
    }
    if (auto found = read(up / in_package->package / in_package->rest, files)) {
      return found;
    }
    if (!up.has_relative_path() || up == up.parent_path()) {
      return std::nullopt;
    }
  }
}

std::string expected_mesh(const std::string& name) {
  if (const std::optional<PackagePath> in_package = package_path(name)) {
    return "it in a folder " + in_quotes(in_package->package) + " beside or above the URDF file, or --package " +
           one_line(in_package->package) + "=FOLDER";
  }
  return "a file whose path is relative to the folder of the URDF file";
}

std::optional<std::string> ImportedMeshes::file_of(const std::string& mesh) {
  if (const auto known = names_.find(mesh); known != names_.end()) {
    return known->second;
  }
  std::optional<std::string> name;
  if (std::optional<FoundMesh> found = find_mesh(mesh, urdf_, *packages_, *source_)) {
    const fs::path folder = found->path.parent_path().lexically_normal();
    const std::size_t number = folders_.emplace(folder.string(), folders_.size() + 1).first->second;
    const std::string target = number == 1 ? "meshes" : "meshes" + std::to_string(number);
    name = target + '/' + found->path.filename().string();
    if (lower_case(*name).ends_with(".obj")) {
      add_materials(folder, target, found->bytes);
    }
    add_file(*name, source_text(std::move(found->bytes)));
  }
  return names_.emplace(mesh, std::move(name)).first->second;
}

void ImportedMeshes::add_materials(const fs::path& folder, const std::string& target, const std::string& text) {
  TextLines lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    constexpr std::string_view keyword = "mtllib ";
    if (!line->starts_with(keyword)) {
      continue;
    }
    const fs::path name = fs::path(std::string(trimmed(line->substr(keyword.size())))).filename();
    if (const std::optional<SharedText> materials = source_->read(folder / name); materials && !name.empty()) {
      add_file(target + '/' + name.string(), *materials);
    }
  }
}

void ImportedMeshes::add_file(const std::string& name, SharedText text) {
  if (std::ranges::find(files_, name, &SourceFile::path) == files_.end()) {
    files_.push_back({name, std::move(text)});
  }
}

}  // namespace proleg::sim
