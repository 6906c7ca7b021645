#include "tools/proleg/ui/seat_limits.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "viewers.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t mebibyte = 1024 * 1024;

TEST(SeatLimits, TheShareOfTheProcessorsIsOneAtLeast) {
  EXPECT_EQ(limits_of_learner(12, 2).workers, 1U);
  EXPECT_EQ(limits_of_learner(12, 64).workers, 5U);
  EXPECT_EQ(limits_of_learner(1, 8).workers, 8U);
}

TEST(SeatLimits, TheClassGivesThemToTheProgramOfASeat) {
  SeatLimits limits;
  limits.workers = 3;
  limits.folder_mib = 7;
  const auto read = limits_in(limits_json(limits));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->workers, 3U);
  EXPECT_EQ(read->folder_mib, 7U);
  EXPECT_FALSE(limits_in(nullptr)) << "the teacher has none";
}

TEST(ProgramShare, LimitsTheWorkersOfALearnerOnly) {
  const TemporaryFolder folder;
  const ProgramShare learner(folder.path(), SeatLimits{});
  EXPECT_EQ(learner.processors(), 1U);
  EXPECT_EQ(learner.workers(std::nullopt), 1U) << "not one for each processor";
  EXPECT_EQ(learner.workers(1), 1U);
  for (const std::uint32_t wanted : {0U, 2U, 60U, 1024U}) {
    try {
      static_cast<void>(learner.workers(wanted));
      ADD_FAILURE() << wanted;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()), "workers: found " + std::to_string(wanted) +
                                               ", expected 1 to 1, the share that a learner of this class has of the "
                                               "processors");
    }
  }
  const ProgramShare alone(folder.path(), std::nullopt);
  EXPECT_EQ(alone.workers(1024), 1024U);
  EXPECT_THROW(static_cast<void>(alone.workers(1025)), InputError);
  EXPECT_EQ(alone.workers(std::nullopt), parse_workers(std::nullopt));
}

TEST(ProgramShare, SearchesAndSweepsShareTheirPlaces) {
  const TemporaryFolder folder;
  ProgramShare share(folder.path(), SeatLimits{});
  const fs::path one = folder.path() / "searches/one/store.sqlite";
  const fs::path two = folder.path() / "sweeps/two/sweep.tsv";
  share.claim(one);
  try {
    share.claim(two);
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).find("found 1 searches and sweeps that go on (one), expected fewer than 1"), 0U)
        << error.what();
  }
  share.release(one);
  share.claim(two);
  share.release(two);
  ProgramShare unlimited(folder.path(), std::nullopt);
  for (int i = 0; i < 100; ++i) {
    unlimited.claim(one);
  }
}

TEST(DiskLimits, SayWhatWasFoundAndExpected) {
  const SeatLimits limits;
  const std::uint64_t enough = limits.free_mib * mebibyte;
  EXPECT_EQ(disk_problem(limits, {limits.folder_mib * mebibyte, limits.files, {}}, enough), "");
  EXPECT_EQ(disk_problem(limits, {1200 * mebibyte, 10, {}}, enough),
            "found 1200 MiB in the folder of this learner, expected at most 1024 MiB; remove files in it, or ask your "
            "teacher");
  EXPECT_NE(disk_problem(limits, {0, limits.files + 1, {}}, enough).find("found 20001 files"), std::string::npos);
  EXPECT_EQ(disk_problem(limits, {}, 5 * mebibyte),
            "found 5 MiB free on the disk of the class, expected at least 1024 MiB; ask your teacher");
}

TEST(DiskLimits, LinksAreNotFollowed) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "a/b");
  std::ofstream(folder.path() / "a/b/c") << std::string(100'000, 'x');
  fs::create_symlink("/usr", folder.path() / "link");
  const FolderUse use = measure_folder(folder.path());
  EXPECT_EQ(use.files, 4U);
  EXPECT_GE(use.bytes, 100'000U);
  EXPECT_LT(use.bytes, 1'000'000U);
}

/// A robot that takes note of what it is asked for.
class AskedRobot final : public host::RobotSession {
 public:
  void operate(const host::OperationRequest& request) override {
    const std::lock_guard lock(mutex_);
    asked_.push_back(request.name);
    changed_.notify_all();
  }
  void wait_until_asked() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !asked_.empty(); });
  }
  void stop(const host::StopRequest& /*request*/) override { ++stops; }
  void holder_changed(bool /*has_holder*/, bool /*is_away*/) override {}

  [[nodiscard]] std::vector<std::string> asked() {
    const std::lock_guard lock(mutex_);
    return asked_;
  }
  int stops = 0;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> asked_;
};

TEST(DiskGuard, EndsWhatFillsTheDiskAndRefusesMore) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "large") << std::string(3 * mebibyte, 'x');
  SeatLimits limits;
  limits.folder_mib = 2;
  limits.free_mib = 0;
  AskedRobot robot;
  Viewers viewers;
  DiskGuard guard(folder.path(), limits, robot);
  std::optional<DiskWatch> watch(std::in_place, guard, viewers);
  robot.wait_until_asked();
  EXPECT_EQ(robot.asked().front(), "record") << "the recording ends";
  host::RequestId request = 0;
  for (const char* name : {"record", "save_as", "draft.save_as", "search.start", "search.resume", "sweep.start"}) {
    guard.operate({++request, name, {{"file", "a.proleg"}}, 1, "Anna"});
    EXPECT_NE(viewers.answer(request).text.find("expected at most 2 MiB"), std::string::npos) << name;
    EXPECT_FALSE(viewers.answer(request).is_done) << name;
  }
  for (const char* name : {"set", "draft.save", "pause"}) {
    guard.operate({++request, name, nlohmann::json::object(), 1, "Anna"});
    EXPECT_EQ(robot.asked().back(), name);
  }
  guard.operate({++request, "record", {{"file", nullptr}}, 1, "Anna"});
  EXPECT_EQ(robot.asked().back(), "record") << "an end is no beginning";
  guard.stop({++request, "Anna"});
  EXPECT_EQ(robot.stops, 1);
  watch.reset();
  EXPECT_EQ(viewers.notices().find("what fills the disk has been ended: found 3 MiB in the folder"), 0U);
}

TEST(DiskGuard, APersonAtHisOwnComputerHasNoLimits) {
  const TemporaryFolder folder;
  AskedRobot robot;
  Viewers viewers;
  DiskGuard guard(folder.path(), std::nullopt, robot);
  const DiskWatch watch(guard, viewers);
  guard.operate({1, "search.start", nlohmann::json::object(), 1, "I"});
  EXPECT_EQ(robot.asked(), std::vector<std::string>{"search.start"});
}

}  // namespace
}  // namespace proleg::tools
