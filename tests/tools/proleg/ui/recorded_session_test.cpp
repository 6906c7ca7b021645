#include "tools/proleg/ui/recorded_session.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "shipped.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/ui/live_simulation.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What the session has told its viewers.
class RecordingViewers final : public host::SessionOutput {
 public:
  struct Answer {
    bool is_done = false;
    json value;
    std::string error;
  };

  void publish(const std::string& document, const json& value) override {
    change([&] { documents_[document] = value; });
  }
  void set_signals(const host::SignalLayout& /*layout*/, std::uint32_t /*tick_us*/) override {}
  void add_row(std::uint16_t /*run*/, std::uint32_t /*tick*/, std::span<const std::int32_t> /*row*/) override {}
  void answer(std::uint64_t request, const json& value) override {
    change([&] { answers_[request] = {true, value, {}}; });
  }
  void refuse(std::uint64_t request, const std::string& why) override {
    change([&] { answers_[request] = {false, {}, why}; });
  }
  void stopped(std::uint64_t request, unsigned confirmed, unsigned of, double /*ms*/) override {
    change([&] { answers_[request] = {true, std::to_string(confirmed) + " of " + std::to_string(of), {}}; });
  }
  void notice(host::NoticeLevel /*level*/, const std::string& /*text*/) override {}

  Answer wait_for(std::uint64_t request) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, std::chrono::minutes(5), [&] { return answers_.contains(request); })) {
      throw std::runtime_error("no answer in 2 minutes");
    }
    return answers_[request];
  }
  json document(const std::string& name) {
    const std::lock_guard lock(mutex_);
    return documents_[name];
  }

 private:
  void change(const std::function<void()>& action) {
    const std::lock_guard lock(mutex_);
    action();
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::uint64_t, Answer> answers_;
  std::map<std::string, json> documents_;
};

class RecordedSessionTest : public ::testing::Test {
 protected:
  void record(const std::string& name, unsigned ticks) {
    const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
    LiveSimulation live(scenario, {}, nullptr);
    ASSERT_TRUE(live.record(folder_ / name, "simulate", "test", [] { return true; }));
    for (unsigned tick = 0; tick < ticks; ++tick) {
      live.advance();
    }
    live.end_recording();
  }
  void begin(std::optional<std::string> file = std::nullopt) {
    session_.emplace(RecordedSessionOptions{folder_.path(), std::move(file), true}, requests_, viewers_);
  }
  RecordingViewers::Answer ask(const std::string& name, const json& arguments = json::object()) {
    requests_.operate({++request_, name, arguments, 1, "a test"});
    return viewers_.wait_for(request_);
  }

  TemporaryFolder folder_;
  RecordingViewers viewers_;
  SessionRequests requests_;
  std::uint64_t request_ = 0;
  std::optional<RecordedSession> session_;
};

TEST_F(RecordedSessionTest, SaysWhereTheRecordingsAre) {
  record("run.proleg", 5);
  begin("run.proleg");
  EXPECT_EQ(viewers_.document("recordings"),
            json({{"folder", fs::canonical(folder_.path()).filename()}, {"open", "run.proleg"}, {"alone", true}}));
  const json files = ask("recording.list").value["files"];
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0]["name"], "run.proleg");
}

TEST_F(RecordedSessionTest, OpensAndAnswersWithBytes) {
  record("run.proleg", 20);
  begin();
  const RecordingViewers::Answer open = ask("recording.open", {{"file", "run.proleg"}});
  ASSERT_TRUE(open.is_done) << open.error;
  EXPECT_EQ(open.value["recording"]["last_tick"], 19);
  const RecordingViewers::Answer rows =
      ask("recording.rows", {{"file", "run.proleg"}, {"signals", {"head", "angle"}}, {"from", 5}, {"to", 9}});
  ASSERT_TRUE(rows.is_done) << rows.error;
  ASSERT_TRUE(rows.value.is_binary());
  EXPECT_EQ(rows.value.get_binary().size(), 16U + 5U * (7U + 5U) * 4U);
}

TEST_F(RecordedSessionTest, OutlivesFilesAndRequestsThatAreWrong) {
  record("run.proleg", 5);
  std::ofstream(folder_ / "broken.proleg") << "no recording";
  begin();
  const std::pair<const char*, json> operations[] = {
      {"recording.fly", json::object()},
      {"run", json::object()},
      {"recording.open", json::object()},
      {"recording.open", {{"file", 5}}},
      {"recording.open", {{"file", "broken.proleg"}}},
      {"recording.open", {{"file", "../x.proleg"}}},
      {"recording.rows", {{"file", "run.proleg"}}},
      {"recording.rows", {{"file", "run.proleg"}, {"signals", "angle"}}},
      {"recording.rows", {{"file", "run.proleg"}, {"signals", {"angle"}}, {"from", -1}}},
      {"recording.rows", {{"file", "run.proleg"}, {"signals", {"angle"}}, {"from", 1.5}}},
      {"recording.rows", {{"file", "run.proleg"}, {"signals", {"angle"}}, {"to", 4294967296}}},
      {"recording.rows", {{"file", "run.proleg"}, {"signals", {"angle"}}, {"points", 1000000}}},
      {"recording.compare", {{"file", "run.proleg"}}},
      {"recording.compare", {{"file", "run.proleg"}, {"with", "broken.proleg"}}}};
  for (const auto& [name, arguments] : operations) {
    const RecordingViewers::Answer answer = ask(name, arguments);
    EXPECT_FALSE(answer.is_done) << name << arguments;
    EXPECT_NE(answer.error.find("expected"), std::string::npos) << answer.error;
    EXPECT_EQ(answer.error.find('\n'), std::string::npos) << answer.error;
  }
  EXPECT_TRUE(ask("recording.open", {{"file", "run.proleg"}}).is_done);
}

TEST_F(RecordedSessionTest, KeepsFewRecordingsOpenAndShowsAll) {
  const std::size_t files = RecordedSession::max_open_runs + 3;
  for (std::size_t file = 0; file < files; ++file) {
    record(std::to_string(file) + ".proleg", 5 + static_cast<unsigned>(file));
  }
  begin();
  for (int round = 0; round < 2; ++round) {
    for (std::size_t file = 0; file < files; ++file) {
      const RecordingViewers::Answer answer = ask("recording.open", {{"file", std::to_string(file) + ".proleg"}});
      ASSERT_TRUE(answer.is_done) << answer.error;
      EXPECT_EQ(answer.value["recording"]["last_tick"], 4 + file);
    }
  }
}

TEST_F(RecordedSessionTest, ShowsTheNewFileAfterOneWasReplaced) {
  record("run.proleg", 5);
  begin();
  EXPECT_EQ(ask("recording.open", {{"file", "run.proleg"}}).value["recording"]["last_tick"], 4);
  record("new.proleg", 30);
  fs::rename(folder_ / "new.proleg", folder_ / "run.proleg");
  EXPECT_EQ(ask("recording.open", {{"file", "run.proleg"}}).value["recording"]["last_tick"], 29);
}

TEST_F(RecordedSessionTest, ComparesTwoRecordingsWhileNobodyAsksForMore) {
  record("a.proleg", 400);
  record("b.proleg", 300);
  begin();
  const json pair{{"file", "a.proleg"}, {"with", "b.proleg"}};
  json document;
  for (int asked = 0; asked < 10'000 && document["compared"] != 300; ++asked) {
    const RecordingViewers::Answer answer = ask("recording.compare", pair);
    ASSERT_TRUE(answer.is_done) << answer.error;
    document = answer.value;
  }
  EXPECT_EQ(document["compared"], 300);
  EXPECT_TRUE(document["difference"].is_null());
}

TEST_F(RecordedSessionTest, ForgetsAComparisonWithAFileThatItCloses) {
  for (std::size_t file = 0; file < RecordedSession::max_open_runs + 3; ++file) {
    record(std::to_string(file) + ".proleg", 5);
  }
  begin();
  for (int round = 0; round < 2; ++round) {
    for (std::size_t file = 1; file < RecordedSession::max_open_runs + 3; ++file) {
      const RecordingViewers::Answer answer =
          ask("recording.compare", {{"file", "0.proleg"}, {"with", std::to_string(file) + ".proleg"}});
      ASSERT_TRUE(answer.is_done) << answer.error;
    }
  }
}

TEST_F(RecordedSessionTest, ComparesAFileWithItselfWhileItIsReplaced) {
  record("run.proleg", 5);
  record("other.proleg", 5);
  begin();
  std::atomic<bool> ends = false;
  std::thread replacing([&] {
    while (!ends) {
      ::renameat2(AT_FDCWD, (folder_ / "run.proleg").c_str(), AT_FDCWD, (folder_ / "other.proleg").c_str(),
                  RENAME_EXCHANGE);
    }
  });
  for (int round = 0; round < 100; ++round) {
    const RecordingViewers::Answer answer = ask("recording.compare", {{"file", "run.proleg"}, {"with", "run.proleg"}});
    EXPECT_TRUE(answer.is_done) << answer.error;
  }
  ends = true;
  replacing.join();
}

}  // namespace
}  // namespace proleg::tools
