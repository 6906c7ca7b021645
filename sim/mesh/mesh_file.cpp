#include "sim/mesh/mesh_file.hpp"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/DefaultLogger.hpp>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/Logger.hpp>
#include <assimp/ProgressHandler.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/mesh/import_process.hpp"
#include "sim/mesh/mesh_checks.hpp"
#include "sim/mesh/mesh_text.hpp"

namespace Assimp {

/// Debian's Assimp has its assertions, and ends the process at a violation, which damaged files cause. This function
/// stands in for the library's (the dynamic linker prefers that of the program), so that the file is refused instead.
[[noreturn]] void aiAssertViolation(const char* expression, const char* file, int line);

void aiAssertViolation(const char* expression, const char* /*file*/, int /*line*/) {
  throw std::runtime_error("assertion " + std::string(expression));
}

}  // namespace Assimp

namespace proleg::sim {
namespace {

constexpr std::array<std::string_view, 4> endings{".stl", ".obj", ".dae", ".off"};
constexpr const char* format_hint = "a file without this error, of the format that its ending says";

/// A file in memory, for reading.
class MemoryStream final : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string bytes) : bytes_(std::move(bytes)) {}

  std::size_t Read(void* buffer, std::size_t size, std::size_t count) override {
    if (size == 0) {
      return 0;
    }
    const std::size_t items = std::min(count, (bytes_.size() - place_) / size);
    std::memcpy(buffer, bytes_.data() + place_, items * size);
    place_ += items * size;
    return items;
  }
  std::size_t Write(const void* /*buffer*/, std::size_t /*size*/, std::size_t /*count*/) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? place_ : bytes_.size();
    if (offset > bytes_.size() - from) {
      return aiReturn_FAILURE;
    }
    place_ = from + offset;
    return aiReturn_SUCCESS;
  }
  [[nodiscard]] std::size_t Tell() const override { return place_; }
  [[nodiscard]] std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string bytes_;
  std::size_t place_ = 0;
};

/// The files that Assimp may read: the mesh, and what the caller gives.
class Files final : public Assimp::IOSystem {
 public:
  Files(std::string name, const std::string& bytes, const MeshCompanion& companion)
      : name_(std::move(name)), bytes_(bytes), companion_(companion) {}

  bool Exists(const char* name) const override { return bytes_of(name).has_value(); }
  [[nodiscard]] char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (mode != nullptr && std::strchr(mode, 'w') != nullptr) {
      return nullptr;
    }
    std::optional<std::string> bytes = bytes_of(name);
    return bytes ? new MemoryStream(std::move(*bytes)) : nullptr;
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  [[nodiscard]] std::optional<std::string> bytes_of(const std::string& name) const {
    if (name == name_) {
      return bytes_;
    }
    if (const auto known = companions_.find(name); known != companions_.end()) {
      return known->second;
    }
    return companions_.emplace(name, companion_(name)).first->second;
  }

  std::string name_;
  const std::string& bytes_;
  const MeshCompanion& companion_;
  /// Assimp first asks whether a file is there.
  mutable std::map<std::string, std::optional<std::string>> companions_;
};

/// Keeps the first error that Assimp logs while this object lives. Some importers log what is wrong with a file, put
/// something else in its place and go on.
class ErrorLog {
 public:
  ErrorLog() { Assimp::DefaultLogger::set(new Log(first_)); }  // which owns it
  ~ErrorLog() { Assimp::DefaultLogger::set(nullptr); }
  ErrorLog(const ErrorLog&) = delete;
  ErrorLog& operator=(const ErrorLog&) = delete;

  /// Empty: none.
  [[nodiscard]] const std::string& first() const { return first_; }

 private:
  class Log final : public Assimp::Logger {
   public:
    explicit Log(std::string& first) : first_(first) {}
    bool attachStream(Assimp::LogStream* /*stream*/, unsigned /*severity*/) override { return false; }
    bool detachStream(Assimp::LogStream* /*stream*/, unsigned /*severity*/) override { return false; }

   private:
    void OnDebug(const char* /*message*/) override {}
    void OnVerboseDebug(const char* /*message*/) override {}
    void OnInfo(const char* /*message*/) override {}
    void OnWarn(const char* /*message*/) override {}
    void OnError(const char* message) override {
      if (first_.empty()) {
        first_ = message;
      }
    }
    std::string& first_;
  };

  std::string first_;
};

/// Assimp takes every text for a scale: "abc" as 0, and -1, which turns the mesh inside out.
void check_collada_unit(const std::string& name, std::string_view bytes) {
  constexpr std::string_view attribute = "meter=";
  const std::size_t tag = bytes.find("<unit");
  if (tag == std::string_view::npos) {
    return;
  }
  const std::string_view unit = bytes.substr(tag, bytes.find('>', tag) - tag);
  const std::size_t begin = unit.find(attribute);
  if (begin == std::string_view::npos || begin + attribute.size() >= unit.size()) {
    return;
  }
  const std::string_view value = unit.substr(begin + attribute.size() + 1);  // behind the quote
  const std::string_view text = value.substr(0, value.find_first_of("\"'"));
  const std::optional<double> metres = parse_number(trimmed(text));
  if (!metres || !(*metres > 0.0)) {
    throw MeshError("a <unit> of " + in_quotes(one_line(shortened(text))) + " metres in " + in_quotes(name),
                    "a number above 0: the length of the file's unit in metres");
  }
}

/// Assimp reads what is no number of a vertex as some vertex, or ends. What does not look like an OFF file is left to
/// it.
void check_off_faces(const std::string& name, const std::string& bytes) {
  std::istringstream text(bytes);
  std::string line;
  const auto next = [&]() -> std::vector<std::string_view> {
    while (std::getline(text, line)) {
      const std::vector<std::string_view> tokens = words(std::string_view(line).substr(0, line.find('#')));
      if (!tokens.empty()) {
        return tokens;
      }
    }
    return {};
  };
  std::vector<std::string_view> counts = next();
  if (counts.size() == 1) {
    counts = next();
  } else if (!counts.empty()) {  // in the line of the word OFF
    counts.erase(counts.begin());
  }
  const std::optional<unsigned> vertices = counts.empty() ? std::nullopt : parse_whole<unsigned>(counts.front());
  const std::optional<unsigned> faces = counts.size() < 2 ? std::nullopt : parse_whole<unsigned>(counts[1]);
  for (unsigned i = 0; vertices && i < *vertices && text; ++i) {
    next();
  }
  for (unsigned i = 0; vertices && faces && i < *faces; ++i) {
    const std::vector<std::string_view> face = next();
    if (face.empty()) {
      return;
    }
    const std::optional<unsigned> corners = parse_whole<unsigned>(face.front());
    if (!corners) {
      throw MeshError("a face with " + in_quotes(one_line(shortened(face.front()))) + " corners in " + in_quotes(name),
                      "a whole number");
    }
    for (std::size_t corner = 1; corner < face.size() && corner <= *corners; ++corner) {
      if (!parse_whole<unsigned>(face[corner])) {
        throw MeshError(
            "a face with the vertex " + in_quotes(one_line(shortened(face[corner]))) + " in " + in_quotes(name),
            "numbers of vertices from 0");
      }
    }
  }
}

/// Assimp has importers for dozens of formats. Only those of the four endings may see the file.
bool reads_ending(Assimp::BaseImporter& importer, const std::string& ending) {
  std::set<std::string> extensions;
  importer.GetExtensionList(extensions);
  return extensions.contains(ending.substr(1));
}

/// A node of a COLLADA file may name a mesh twice, which is one surface, and which Assimp's validation refuses.
void leave_out_repetitions(aiNode& node) {
  std::set<unsigned> known;
  unsigned count = 0;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    if (known.insert(node.mMeshes[i]).second) {
      node.mMeshes[count++] = node.mMeshes[i];
    }
  }
  node.mNumMeshes = count;
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    leave_out_repetitions(*node.mChildren[i]);
  }
}

/// Cameras, lights and animations are no part of a surface. Assimp's validation refuses those with equal names.
void leave_out_stage(aiScene& scene) {
  const auto leave_out = [](auto**& items, unsigned& count) {
    for (unsigned i = 0; i < count; ++i) {
      delete items[i];
    }
    delete[] items;
    items = nullptr;
    count = 0;
  };
  leave_out(scene.mCameras, scene.mNumCameras);
  leave_out(scene.mLights, scene.mNumLights);
  leave_out(scene.mAnimations, scene.mNumAnimations);
}

[[noreturn]] void refuse(const std::string& name, const std::string& found) {
  throw MeshError(found + " in " + in_quotes(name), "a mesh of triangles");
}

Eigen::Vector3f colour_of(const aiScene& scene, const aiMesh& mesh, unsigned vertex) {
  aiColor4D colour(0.6F, 0.6F, 0.6F, 1.0F);
  if (mesh.HasVertexColors(0)) {
    colour = mesh.mColors[0][vertex];
  } else if (mesh.mMaterialIndex < scene.mNumMaterials) {
    scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_COLOR_DIFFUSE, colour);
  }
  const Eigen::Vector3f read(colour.r, colour.g, colour.b);
  return read.allFinite() ? read.cwiseMax(0.0F).cwiseMin(1.0F).eval() : Eigen::Vector3f(0.6F, 0.6F, 0.6F);
}

bool has_colour(const aiScene& scene, const aiMesh& mesh) {
  if (mesh.HasVertexColors(0)) {
    return true;
  }
  // Assimp gives a file without materials one without a name, or with this name.
  aiString name;
  aiColor4D colour;
  return mesh.mMaterialIndex < scene.mNumMaterials &&
         scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS &&
         scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS && name.length > 0 &&
         std::string_view(name.C_Str()) != AI_DEFAULT_MATERIAL_NAME;
}

TriangleMesh joined_meshes(const aiScene& scene, const std::string& name) {
  TriangleMesh result;
  bool is_coloured = false;
  for (unsigned number = 0; number < scene.mNumMeshes; ++number) {
    const aiMesh& mesh = *scene.mMeshes[number];
    is_coloured = is_coloured || has_colour(scene, mesh);
    const auto first = static_cast<std::uint32_t>(result.vertices.size());
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const Eigen::Vector3d vertex(mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z);
      if (!vertex.allFinite()) {
        refuse(name, "a coordinate that is not a finite number");
      }
      result.vertices.push_back(vertex);
      result.colours.push_back(colour_of(scene, mesh, i));
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) {
        continue;  // points and lines
      }
      for (unsigned corner = 0; corner < 3; ++corner) {
        if (face.mIndices[corner] >= mesh.mNumVertices) {
          refuse(name, "a triangle with vertex " + std::to_string(face.mIndices[corner]) + " of " +
                           std::to_string(mesh.mNumVertices));
        }
      }
      result.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
    if (result.triangles.size() > max_triangles) {
      throw MeshError("more than " + std::to_string(max_triangles) + " triangles in " + in_quotes(name),
                      "at most that; programs for meshes can reduce it");
    }
    if (result.vertices.size() > max_mesh_vertices) {
      throw MeshError("more than " + std::to_string(max_mesh_vertices) + " vertices in " + in_quotes(name),
                      "at most that; programs for meshes can reduce it");
    }
  }
  if (result.triangles.empty()) {
    refuse(name, "no triangle");
  }
  if (!is_coloured) {
    result.colours.clear();
  }
  return result;
}

}  // namespace

bool is_mesh_file_name(std::string_view name) {
  return std::ranges::find(endings, lower_case(std::filesystem::path(name).extension().string())) != endings.end();
}

TriangleMesh import_mesh(const std::string& name, const std::string& file_bytes, const MeshCompanion& companion) {
  const std::string ending = lower_case(std::filesystem::path(name).extension().string());
  if (!is_mesh_file_name(name)) {
    throw MeshError("a mesh file of another kind, " + in_quotes(name), std::string(mesh_file_endings));
  }
  if (file_bytes.starts_with("version https://git-lfs.github.com/spec/")) {
    throw MeshError("a pointer of Git LFS instead of the mesh, " + in_quotes(name),
                    "the mesh: 'git lfs pull' fetches it");
  }
  const std::string bytes = ending == ".stl" ? plain_stl(name, file_bytes) : plain_text(name, file_bytes);
  if (ending == ".dae") {
    check_collada_unit(name, bytes);
  } else if (ending == ".off") {
    check_off_faces(name, bytes);
  }
  try {
    const ErrorLog log;
    Assimp::Importer importer;
    std::optional<MeshError> bad_companion;  // Assimp's importers go on without a file that cannot be opened
    const MeshCompanion text_companion = [&](const std::string& path) -> std::optional<std::string> {
      const std::optional<std::string> text = companion(path);
      try {
        return text ? std::optional(plain_text(std::filesystem::path(path).filename().string(), *text)) : std::nullopt;
      } catch (const MeshError& error) {
        bad_companion = error;
        return std::nullopt;
      }
    };
    importer.SetIOHandler(new Files(name, bytes, text_companion));
    std::vector<Assimp::BaseImporter*> others;
    for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
      if (Assimp::BaseImporter* const other = importer.GetImporter(i); !reads_ending(*other, ending)) {
        others.push_back(other);
      }
    }
    for (Assimp::BaseImporter* const other : others) {
      importer.UnregisterLoader(other);
      delete other;
    }
    // Robots have z upwards; the file's own axes are kept.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    // The validation comes before all other steps, which trust the numbers of a file.
    constexpr unsigned steps = aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                               aiProcess_PreTransformVertices | aiProcess_JoinIdenticalVertices;
    if (const aiScene* const read = importer.ReadFile(name, 0); read != nullptr && read->mRootNode != nullptr) {
      leave_out_repetitions(*read->mRootNode);
      leave_out_stage(const_cast<aiScene&>(*read));  // which the importer owns, and changes in its own steps
    }
    if (bad_companion) {
      throw *bad_companion;
    }
    const aiScene* const scene = importer.GetScene() == nullptr ? nullptr : importer.ApplyPostProcessing(steps);
    if (scene == nullptr) {
      throw MeshError("a mesh that cannot be read, " + in_quotes(name) +
                          " (Assimp: " + one_line(shortened(importer.GetErrorString(), 200)) + ")",
                      format_hint);
    }
    // Of a vertex that a face names and the file does not have, Assimp takes the last one.
    if (ending == ".off" && !log.first().empty()) {
      throw MeshError(in_quotes(name) + " with an error (Assimp: " + one_line(shortened(log.first(), 200)) + ")",
                      format_hint);
    }
    return joined_meshes(*scene, name);
  } catch (const MeshError&) {
    throw;
  } catch (const std::exception& error) {
    throw MeshError(
        "a mesh that cannot be read, " + in_quotes(name) + " (Assimp: " + one_line(shortened(error.what(), 200)) + ")",
        format_hint);
  }
}

TriangleMesh read_mesh_file(const std::string& name, const std::string& bytes, const MeshCompanion& companion) {
  return import_in_child(name, companion,
                         [&](const MeshCompanion& beside) { return import_mesh(name, bytes, beside); });
}

}  // namespace proleg::sim
