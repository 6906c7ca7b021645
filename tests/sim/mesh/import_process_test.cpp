#include "sim/mesh/import_process.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <future>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "sim/mesh/mesh_checks.hpp"
#include "tests/sim/mesh/mesh_shapes.hpp"

namespace proleg::sim {
namespace {

using Import = std::function<TriangleMesh(const MeshCompanion& companion)>;

std::optional<std::string> nothing_beside(const std::string& /*name*/) { return std::nullopt; }

std::ptrdiff_t open_files() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator());
}

/// Each case ends as it began: without a child and without another open file.
class ImportProcess : public ::testing::Test {
 protected:
  void TearDown() override {
    EXPECT_EQ(open_files(), open_before_);
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
  }

  static std::string refusal(const Import& import, const ImportLimits& limits = {}) {
    try {
      static_cast<void>(import_in_child("a.dae", nothing_beside, import, limits));
    } catch (const MeshError& error) {
      return error.found;
    }
    return "nothing";
  }

 private:
  std::ptrdiff_t open_before_ = open_files();
};

TEST_F(ImportProcess, GivesTheMeshOfTheChild) {
  TriangleMesh box = box_mesh({0.1, 0.2, 0.3});
  box.colours.assign(box.vertices.size(), Eigen::Vector3f(0.25F, 0.5F, 1.0F));
  const TriangleMesh mesh = import_in_child("a.dae", nothing_beside, [&](const MeshCompanion&) { return box; });
  EXPECT_EQ(mesh.vertices, box.vertices);
  EXPECT_EQ(mesh.colours, box.colours);
  EXPECT_EQ(mesh.triangles, box.triangles);
}

TEST_F(ImportProcess, GivesTheErrorOfTheChild) {
  try {
    static_cast<void>(import_in_child("a.dae", nothing_beside, [](const MeshCompanion&) -> TriangleMesh {
      throw MeshError("no triangle", "a mesh of triangles");
    }));
    FAIL();
  } catch (const MeshError& error) {
    EXPECT_EQ(error.found, "no triangle");
    EXPECT_EQ(error.expected, "a mesh of triangles");
  }
}

TEST_F(ImportProcess, TheCallerGivesAndRecordsTheFilesBeside) {
  std::vector<std::string> asked;
  const std::string bytes(1'000'000, 'k');
  const auto companion = [&](const std::string& name) -> std::optional<std::string> {
    asked.push_back(name);
    return name == "a.mtl" ? std::optional(bytes) : std::nullopt;
  };
  static_cast<void>(import_in_child("a.obj", companion, [&](const MeshCompanion& beside) {
    if (beside("a.mtl") != bytes || beside("b.mtl")) {
      throw MeshError("other bytes", "those of the caller");
    }
    return box_mesh({0.1, 0.2, 0.3});
  }));
  EXPECT_EQ(asked, (std::vector<std::string>{"a.mtl", "b.mtl"}));
}

TEST_F(ImportProcess, AnErrorOfTheCallersFilesReachesTheCaller) {
  const auto companion = [](const std::string& name) -> std::optional<std::string> { throw std::domain_error(name); };
  EXPECT_THROW(static_cast<void>(import_in_child("a.obj", companion,
                                                 [](const MeshCompanion& beside) {
                                                   static_cast<void>(beside("a.mtl"));
                                                   return box_mesh({0.1, 0.2, 0.3});
                                                 })),
               std::domain_error);
}

TEST_F(ImportProcess, AChildThatEndsIsOneError) {
  EXPECT_EQ(refusal([](const MeshCompanion&) -> TriangleMesh { std::abort(); }),
            "a file at which the mesh library ends with signal 6, 'a.dae'");
  EXPECT_EQ(refusal([](const MeshCompanion&) -> TriangleMesh { _exit(0); }),
            "a file at which the mesh library ends with status 0, 'a.dae'");
  EXPECT_EQ(refusal([](const MeshCompanion&) -> TriangleMesh { throw 1; }),
            "a file at which the mesh library ends with status 102, 'a.dae'");
}

TEST_F(ImportProcess, AHandlerOfTheProgramDoesNotRunInTheChild) {
  const auto before = std::signal(SIGABRT, [](int) { _exit(0); });
  EXPECT_EQ(refusal([](const MeshCompanion&) -> TriangleMesh { std::abort(); }),
            "a file at which the mesh library ends with signal 6, 'a.dae'");
  std::signal(SIGABRT, before);
}

TEST_F(ImportProcess, AChildThatTakesTooLongIsEnded) {
  ImportLimits limits;
  limits.wall = std::chrono::seconds(1);
  EXPECT_EQ(refusal(
                [](const MeshCompanion&) -> TriangleMesh {
                  while (true) {
                    pause();
                  }
                },
                limits),
            "a file that takes longer than 1 s, 'a.dae'");
  limits = {};
  limits.processor = std::chrono::seconds(1);
  EXPECT_EQ(refusal(
                [](const MeshCompanion&) -> TriangleMesh {
                  volatile int count = 0;
                  while (true) {
                    count = count + 1;
                  }
                },
                limits),
            "a file that takes longer than 1 s, 'a.dae'");
}

TEST_F(ImportProcess, AChildThatWaitsForALockOfAnotherThreadIsReplaced) {
  // Shared with the children: the number of those that began.
  void* const memory =
      mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  auto& children = *new (memory) std::atomic<int>(0);
  std::mutex mutex;
  std::promise<void> is_held;
  std::promise<void> is_forked;
  std::thread holder([&] {
    const std::scoped_lock lock(mutex);
    is_held.set_value();
    is_forked.get_future().wait();
  });
  is_held.get_future().wait();
  ImportLimits limits;
  limits.wall = std::chrono::hours(1);
  std::vector<std::string> asked;
  const auto companion = [&](const std::string& name) -> std::optional<std::string> {
    asked.push_back(name);
    return std::nullopt;
  };
  const TriangleMesh mesh = import_in_child(
      "a.obj", companion,
      [&](const MeshCompanion& beside) {
        static_cast<void>(beside("a.mtl"));
        if (++children < 4) {
          const std::scoped_lock lock(mutex);
        }
        return box_mesh({0.1, 0.2, 0.3});
      },
      limits);
  is_forked.set_value();
  holder.join();
  EXPECT_EQ(children, 4);
  EXPECT_EQ(mesh.triangles.size(), 12);
  EXPECT_EQ(asked, std::vector<std::string>(4, "a.mtl"));
  munmap(memory, sizeof children);
}

TEST_F(ImportProcess, AChildThatAsksForTooManyFilesIsEnded) {
  EXPECT_EQ(refusal([](const MeshCompanion& beside) -> TriangleMesh {
              while (true) {
                static_cast<void>(beside("a.mtl"));
              }
            }),
            "a file that names more than 1000 other files, 'a.dae'");
}

TEST_F(ImportProcess, NumbersOfTheChildAreNotTrusted) {
  const std::string damage = "a file at which the mesh library fails, 'a.dae'";
  const TriangleMesh box = box_mesh({0.1, 0.2, 0.3});
  TriangleMesh mesh = box;
  mesh.triangles[3][1] = static_cast<std::uint32_t>(box.vertices.size());
  EXPECT_EQ(refusal([&](const MeshCompanion&) { return mesh; }), damage);
  mesh = box;
  mesh.vertices[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&](const MeshCompanion&) { return mesh; }), damage);
  mesh = box;
  mesh.colours.resize(1, Eigen::Vector3f::Zero());
  EXPECT_EQ(refusal([&](const MeshCompanion&) { return mesh; }), damage);
  mesh = box;
  mesh.triangles.resize(max_triangles + 1, box.triangles.front());
  EXPECT_EQ(refusal([&](const MeshCompanion&) { return mesh; }), damage);
  EXPECT_EQ(refusal([&](const MeshCompanion&) { return TriangleMesh(); }), damage);
}

}  // namespace
}  // namespace proleg::sim
