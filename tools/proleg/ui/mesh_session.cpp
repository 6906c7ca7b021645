#include "tools/proleg/ui/mesh_session.hpp"

#include <malloc.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/ui/draft_arguments.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

struct DeclaredFile {
  std::string name;
  std::size_t bytes = 0;
};

DeclaredFile declared_file(const json& file) {
  if (!file.is_object()) {
    throw InputError("files", 0, shortened(file.dump()), "a name and a number of bytes for each file");
  }
  const auto bytes = argument<std::uint64_t>(file, "bytes", "a whole number");
  const std::string name = text(file, "name");
  if (!bytes || *bytes == 0) {
    throw InputError("file", 0, bytes ? in_quotes(one_line(shortened(name))) + ", which is empty" : "no size",
                     "a mesh");
  }
  if (*bytes > sim::max_file_bytes) {
    constexpr std::uint64_t mebibyte = 1U << 20U;
    throw InputError("file", 0,
                     in_quotes(one_line(shortened(name))) + " of " +
                         std::to_string(*bytes / mebibyte + (*bytes % mebibyte == 0 ? 0 : 1)) + " MiB",
                     "at most " + std::to_string(sim::max_file_bytes / mebibyte) +
                         " MiB and 100000 triangles; a modeller can reduce them");
  }
  return {name, static_cast<std::size_t>(*bytes)};
}

json facts_json(std::uint64_t number, const sim::OwnMesh& own) {
  const sim::MeshFacts& facts = own.facts;
  json files = json::array();
  for (const sim::NamedBytes& file : own.files) {
    files.push_back(file.name);
  }
  return {{"mesh", number},
          {"name", own.files.front().name},
          {"files", std::move(files)},
          {"triangles", own.mesh.triangles.size()},
          {"lowest", vector_json(facts.lowest)},
          {"highest", vector_json(facts.highest)},
          {"gap", facts.gap ? json(*facts.gap) : json()},
          {"flaw", facts.flaw ? json(*facts.flaw) : json()},
          {"hull_volume", facts.hull_volume ? json(*facts.hull_volume) : json()},
          {"facing", vector_json(facts.facing)},
          {"has_colours", !own.mesh.colours.empty()}};
}

template <typename Value>
void append(std::vector<std::uint8_t>& bytes, Value value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// Numbers of vertices and triangles, the vertices, the triangles; 32 bits each.
std::vector<std::uint8_t> shape_bytes(const sim::TriangleMesh& mesh) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * (2 + 3 * (mesh.vertices.size() + mesh.triangles.size())));
  append(bytes, static_cast<std::uint32_t>(mesh.vertices.size()));
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    for (const double coordinate : vertex) {
      append(bytes, static_cast<float>(coordinate));
    }
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      append(bytes, corner);
    }
  }
  return bytes;
}

}  // namespace

void SentMeshes::set(std::uint64_t number, Mesh mesh) {
  const std::lock_guard lock(mutex_);
  meshes_.insert_or_assign(number, std::move(mesh));
}

void SentMeshes::erase(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  meshes_.erase(number);
}

SentMeshes::Mesh SentMeshes::at(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  const auto found = meshes_.find(number);
  if (found == meshes_.end()) {
    throw InputError("mesh", 0, std::to_string(number), "the number of a mesh that was sent and read; send it again");
  }
  return found->second;
}

MeshSession::MeshSession(SentMeshes& meshes, SessionRequests& requests, host::SessionOutput& output,
                         MeshSessionOptions options)
    : SessionThread(requests, output), meshes_(meshes), options_(options) {
  begin_thread();
}

MeshSession::~MeshSession() { end_thread(); }

std::size_t MeshSession::Sent::declared() const { return std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}); }

std::size_t MeshSession::Sent::received() const {
  std::size_t bytes = 0;
  for (const sim::NamedBytes& file : files) {
    bytes += file.bytes.size();
  }
  return bytes;
}

void MeshSession::serve() {
  if (!std::exchange(has_low_priority_, true)) {
    lower_thread_priority();
  }
  take_operations();
  forget_old();
  Clock::time_point next = Clock::time_point::max();
  for (const auto& [number, sent] : sent_) {
    next = std::min(next, end_of(sent));
  }
  if (sent_.empty()) {
    requests_.wait();
  } else {
    requests_.wait_until(next);
  }
}

json MeshSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{{"mesh.begin", &MeshSession::begin},
                                                            {"mesh.part", &MeshSession::take_part},
                                                            {"mesh.look", &MeshSession::look},
                                                            {"mesh.shape", &MeshSession::shape},
                                                            {"mesh.drop", &MeshSession::drop}};
  forget_old();
  return (this->*handler_of(handlers, operation.name))(operation.arguments);
}

json MeshSession::begin(const json& arguments) {
  const auto declared =
      argument<std::vector<json>>(arguments, "files", "a list of files").value_or(std::vector<json>{});
  if (declared.size() > most_files) {
    throw InputError("files", 0, std::to_string(declared.size()) + " files",
                     "a mesh and at most " + std::to_string(most_files - 1) + " .mtl files");
  }
  Sent sent;
  std::vector<std::string> names;
  for (const json& file : declared) {
    const DeclaredFile read = declared_file(file);
    names.push_back(read.name);
    sent.files.push_back({read.name, {}});
    sent.sizes.push_back(read.bytes);
  }
  static_cast<void>(sim::require_mesh_files(names));
  if (sent.declared() > most_bytes_of_mesh) {
    throw InputError("files", 0, "more than 20 MiB in all", "at most that");
  }
  const auto bytes = [this] {
    std::size_t sum = 0;
    for (const auto& [number, other] : sent_) {
      sum += other.declared();
    }
    return sum;
  };
  while (sent_.size() >= most_meshes || bytes() + sent.declared() > most_bytes) {
    forget(std::ranges::min_element(sent_, {}, [](const auto& other) { return other.second.last_use; }));
  }
  sent.last_use = Clock::now();
  sent_.emplace(++last_number_, std::move(sent));
  return {{"mesh", last_number_}};
}

json MeshSession::take_part(const json& arguments) {
  const auto found = find(arguments);
  Sent& sent = found->second;
  const std::size_t number = position_of(arguments, "file");
  const std::size_t at = position_of(arguments, "at");
  const std::optional<std::string> bytes = sim::decode_base64(text(arguments, "data"));
  if (number >= sent.files.size() || !bytes || bytes->empty()) {
    throw InputError(number >= sent.files.size() ? "file" : "data", 0, "a part that belongs to no file",
                     "a number below " + std::to_string(sent.files.size()) + ", and bytes in base64");
  }
  std::string& file = sent.files[number].bytes;
  if (at != file.size() || bytes->size() > sent.sizes[number] - file.size()) {
    throw InputError("at", 0, "byte " + std::to_string(at) + " and " + std::to_string(bytes->size()) + " more",
                     "byte " + std::to_string(file.size()) + " of " + std::to_string(sent.sizes[number]) + " next");
  }
  if (file.empty()) {
    file.reserve(sent.sizes[number]);
  }
  file += *bytes;
  return {{"received", sent.received()}};
}

json MeshSession::look(const json& arguments) {
  const auto found = find(arguments);
  return facts_json(found->first, read(found));
}

json MeshSession::shape(const json& arguments) { return json::binary(shape_bytes(read(find(arguments)).mesh)); }

json MeshSession::drop(const json& arguments) {
  forget(find(arguments));
  return json::object();
}

std::map<std::uint64_t, MeshSession::Sent>::iterator MeshSession::find(const json& arguments) {
  const auto number = argument<std::uint64_t>(arguments, "mesh", "the number of a mesh");
  const auto found = sent_.find(number.value_or(0));
  if (found == sent_.end()) {
    throw InputError("mesh", 0, number ? std::to_string(*number) : "none",
                     "the number of a mesh that is being sent; begin again");
  }
  found->second.last_use = Clock::now();
  return found;
}

const sim::OwnMesh& MeshSession::read(std::map<std::uint64_t, Sent>::iterator found) {
  Sent& sent = found->second;
  if (sent.read == nullptr) {
    if (sent.received() != sent.declared()) {
      throw InputError("mesh", 0, std::to_string(sent.received()) + " bytes", std::to_string(sent.declared()));
    }
    try {
      sent.read = std::make_shared<const sim::OwnMesh>(sim::read_own_mesh(std::exchange(sent.files, {})));
    } catch (...) {
      forget(found);
      throw;
    }
    malloc_trim(0);  // the check of a mesh has small parts for each edge
    meshes_.set(found->first, sent.read);
    sent.last_use = Clock::now();
  }
  return *sent.read;
}

void MeshSession::forget(std::map<std::uint64_t, Sent>::iterator sent) {
  meshes_.erase(sent->first);
  sent_.erase(sent);
}

SessionThread::Clock::time_point MeshSession::end_of(const Sent& sent) const {
  return sent.last_use + (sent.read == nullptr ? options_.longest_pause : options_.longest_rest);
}

void MeshSession::forget_old() {
  const Clock::time_point now = Clock::now();
  for (auto sent = sent_.begin(); sent != sent_.end();) {
    const auto next = std::next(sent);
    if (end_of(sent->second) <= now) {
      forget(sent);
    }
    sent = next;
  }
}

}  // namespace proleg::tools
