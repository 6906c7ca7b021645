#pragma once

// Mesh files that viewers send: they come in parts, are checked and read, and wait until a change of the draft uses
// them. It runs in a thread of its own, because the read of a large mesh takes a second.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "sim/authoring/own_mesh.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

/// Meshes that were sent and read, for the session that changes the draft. Any thread may use it.
class SentMeshes {
 public:
  using Mesh = std::shared_ptr<const sim::OwnMesh>;

  void set(std::uint64_t number, Mesh mesh);
  void erase(std::uint64_t number);
  /// Throws InputError if there is none with this number.
  [[nodiscard]] Mesh at(std::uint64_t number) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Mesh> meshes_;
};

struct MeshSessionOptions {
  /// A mesh of which no part has come for so long is forgotten, and a whole one that was not used for so long.
  std::chrono::milliseconds longest_pause{30'000};
  std::chrono::milliseconds longest_rest{3'600'000};
};

class MeshSession final : private SessionThread {
 public:
  // What all viewers together may have sent; further meshes take the place of the one that was used least recently.
  static constexpr std::size_t most_meshes = 2;
  static constexpr std::size_t most_files = 8;                               ///< of a mesh
  static constexpr std::size_t most_bytes_of_mesh = std::size_t{20} << 20U;  ///< of all files of a mesh
  static constexpr std::size_t most_bytes = std::size_t{20} << 20U;          ///< of all meshes

  /// All must outlive the session.
  MeshSession(SentMeshes& meshes, SessionRequests& requests, host::SessionOutput& output,
              MeshSessionOptions options = {});
  ~MeshSession() override;

 private:
  /// A mesh that comes, or has come.
  struct Sent {
    std::vector<sim::NamedBytes> files;
    std::vector<std::size_t> sizes;  ///< of the files, as declared
    SentMeshes::Mesh read;           ///< null: not yet
    Clock::time_point last_use;

    [[nodiscard]] std::size_t declared() const;
    [[nodiscard]] std::size_t received() const;
  };

  // SessionThread
  void serve() override;
  void fail(const std::string& /*why*/) override {}
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  using Handler = nlohmann::json (MeshSession::*)(const nlohmann::json&);
  nlohmann::json begin(const nlohmann::json& arguments);
  nlohmann::json take_part(const nlohmann::json& arguments);
  nlohmann::json look(const nlohmann::json& arguments);
  nlohmann::json shape(const nlohmann::json& arguments);
  nlohmann::json drop(const nlohmann::json& arguments);

  /// The mesh that the arguments name. Throws InputError if it is not there.
  [[nodiscard]] std::map<std::uint64_t, Sent>::iterator find(const nlohmann::json& arguments);
  /// Reads it, if that was not done. A mesh that cannot be read is forgotten.
  const sim::OwnMesh& read(std::map<std::uint64_t, Sent>::iterator sent);
  void forget(std::map<std::uint64_t, Sent>::iterator sent);
  [[nodiscard]] Clock::time_point end_of(const Sent& sent) const;
  void forget_old();

  SentMeshes& meshes_;
  MeshSessionOptions options_;
  std::map<std::uint64_t, Sent> sent_;
  std::uint64_t last_number_ = 0;
  bool has_low_priority_ = false;
};

}  // namespace proleg::tools
