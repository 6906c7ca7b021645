#include "tools/proleg/ui/simulated_session.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "shipped.hpp"
#include "sim/record/recording.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

/// What the session has told its viewers.
class Viewers final : public host::SessionOutput {
 public:
  struct Answer {
    bool is_done;
    std::string text;
  };

 private:
  template <typename Action>
  void change(const Action& action) {
    const std::lock_guard lock(mutex_);
    action();
    changed_.notify_all();
  }
  template <typename Condition, typename Result>
  auto when(const Condition& condition, const Result& result) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, std::chrono::minutes(2), condition)) {
      throw std::runtime_error("it did not come in 2 minutes");
    }
    return result();
  }

 public:
  void publish(const std::string& document, const json& value) override {
    change([&] { documents_[document] = value; });
  }
  void set_signals(const host::SignalLayout& layout, std::uint32_t /*tick_us*/) override {
    row_size_ = layout.row_size();
  }
  void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) override {
    change([&] {
      is_gapless_ = is_gapless_ && (tick == 0 || (tick == last_tick_ + 1 && run == run_)) && row.size() == row_size_;
      run_ = run;
      last_tick_ = tick;
      ++rows_;
    });
  }
  void answer(std::uint64_t request, const json& value) override {
    change([&] { answers_[request] = {true, value.dump()}; });
  }
  void refuse(std::uint64_t request, const std::string& why) override {
    change([&] { answers_[request] = {false, why}; });
  }
  void stopped(std::uint64_t request, unsigned confirmed, unsigned joints, double /*milliseconds*/) override {
    change([&] { answers_[request] = {true, std::to_string(confirmed) + " of " + std::to_string(joints)}; });
  }
  void notice(host::NoticeLevel /*level*/, const std::string& text) override {
    change([&] { notices_ += text + '\n'; });
  }

  Answer answer(std::uint64_t request) {
    return when([&] { return answers_.contains(request); }, [&] { return answers_[request]; });
  }
  /// The document `session`, when it is as it is waited for.
  json session(const std::function<bool(const json&)>& is_so) {
    json document;
    return when([&] { return is_so(document = documents_["session"]); }, [&] { return document; });
  }
  json state(const std::string& name) {
    return session([&](const json& document) { return document["state"] == name; });
  }
  json document(const std::string& name) {
    return when([] { return true; }, [&] { return documents_[name]; });
  }
  void wait_for_tick(std::uint32_t tick) {
    when([&] { return rows_ > 0 && last_tick_ >= tick; }, [] { return 0; });
  }
  std::uint64_t rows() {
    return when([] { return true; }, [&] { return rows_; });
  }
  bool is_gapless() {
    return when([] { return true; }, [&] { return is_gapless_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, json> documents_;
  std::map<std::uint64_t, Answer> answers_;
  std::string notices_;
  std::size_t row_size_ = 0;
  std::uint64_t rows_ = 0;
  std::uint32_t last_tick_ = 0;
  std::uint16_t run_ = 0;
  bool is_gapless_ = true;
};

class SimulatedSessionTest : public ::testing::Test {
 protected:
  void open(bool starts_paused) {
    session_.reset();
    requests_.emplace();
    session_.emplace(scenario_, nullptr,
                     SimulatedSessionOptions{
                         folder_ / "", "proleg simulate uniform.simulation.xml", {}, false, "test", starts_paused},
                     *requests_, viewers_);
  }
  Viewers::Answer ask(const std::string& name, const json& arguments = json::object()) {
    requests_->operate({++request_, name, arguments, 1, "a test"});
    return viewers_.answer(request_);
  }
  Viewers::Answer stop() {
    requests_->stop({++request_, "a test"});
    return viewers_.answer(request_);
  }

  sim::Scenario scenario_ = sim::shipped("travelling_wave/uniform");
  TemporaryFolder folder_;
  Viewers viewers_;
  std::uint64_t request_ = 0;
  std::optional<host::SessionRequests> requests_;
  std::optional<SimulatedSession> session_;
};

TEST_F(SimulatedSessionTest, MovesFromTheStartAndShowsEveryTick) {
  open(false);
  viewers_.wait_for_tick(30);
  EXPECT_TRUE(viewers_.is_gapless());
  EXPECT_EQ(viewers_.document("robot")["joints"].size(), 5U);
  EXPECT_EQ(viewers_.document("robot")["links"].size(), 6U);
}

TEST_F(SimulatedSessionTest, StepsByTicks) {
  open(true);
  EXPECT_EQ(viewers_.rows(), 0U);
  EXPECT_TRUE(ask("step", {{"ticks", 7}}).is_done);
  viewers_.session([](const json& session) { return session["tick"] == 7; });
  EXPECT_EQ(viewers_.rows(), 7U);
}

TEST_F(SimulatedSessionTest, StopHoldsFromEveryState) {
  for (const bool starts_paused : {true, false}) {
    open(starts_paused);
    EXPECT_EQ(stop().text, "5 of 5");
    viewers_.state("stopped");
    const std::uint64_t rows = viewers_.rows();
    EXPECT_TRUE(ask("set", {{"words", {"amplitude=30"}}}).is_done);
    EXPECT_EQ(viewers_.rows(), rows);
    EXPECT_TRUE(ask("run").is_done);
    viewers_.state("running");
  }
}

TEST_F(SimulatedSessionTest, WhatWasAskedForBeforeAStopHasNoEffectAfterIt) {
  open(true);
  for (int round = 0; round < 50; ++round) {
    requests_->operate({++request_, "run", json::object(), 1, "a test"});
    const std::uint64_t run = request_;
    stop();
    viewers_.answer(run);
    EXPECT_EQ(viewers_.state("stopped")["state"], "stopped");
    const std::uint64_t rows = viewers_.rows();
    ask("command_line");
    EXPECT_EQ(viewers_.rows(), rows);
  }
}

TEST_F(SimulatedSessionTest, ARunOfOperationsIsTheRunOfItsCommandLine) {
  open(true);
  ask("factor", {{"value", 0}});
  ask("step", {{"ticks", 100}});
  viewers_.session([](const json& session) { return session["tick"] == 100; });
  EXPECT_EQ(ask("set", {{"words", {"amplitude:J2=30"}}, {"gesture", 1}}).text, R"({"tick":100})");
  EXPECT_TRUE(ask("record", {{"file", "run.proleg"}}).is_done);
  ask("step", {{"ticks", 100}});
  viewers_.session([](const json& session) { return session["tick"] == 200; });
  EXPECT_EQ(json::parse(ask("command_line").text)["text"],
            "proleg simulate uniform.simulation.xml --set 1.amplitude:J2=30@100 --seconds 2");
  EXPECT_TRUE(ask("record", {{"file", nullptr}}).is_done);
  const sim::Recording recording(folder_ / "run.proleg");
  EXPECT_TRUE(recording.finished());
  EXPECT_EQ(recording.last_tick(), 199U);
}

TEST_F(SimulatedSessionTest, RefusesInOneLineWhatItCannotDo) {
  open(true);
  std::ofstream(folder_ / "there.proleg") << "a file of the user";
  const std::pair<const char*, json> operations[] = {
      {"fly", json::object()},
      {"step", {{"ticks", 0}}},
      {"step", {{"ticks", 1'000'000}}},
      {"step", {{"ticks", "many"}}},
      {"factor", {{"value", 0.01}}},
      {"factor", {{"value", 1e9}}},
      {"factor", json::object()},
      {"set", json::object()},
      {"set", {{"words", "amplitude=30"}}},
      {"set", {{"words", {"amplitude=30\nrun"}}}},
      {"reset", {{"names", {"nothing"}}}},
      {"reset", {{"names", {"9.amplitude"}}}},
      {"reset", {{"names", "amplitude"}}},
      {"restart", {{"parameters", "mine"}}},
      {"undo", json::object()},
      {"redo", json::object()},
      {"record", {{"file", "../run.proleg"}}},
      {"record", {{"file", "/tmp/run.proleg"}}},
      {"record", {{"file", "run.txt"}}},
      {"record", {{"file", ""}}},
      {"record", {{"file", "there.proleg"}}},
  };
  for (const auto& [name, arguments] : operations) {
    SCOPED_TRACE(name + (' ' + arguments.dump()));
    const Viewers::Answer answer = ask(name, arguments);
    EXPECT_FALSE(answer.is_done);
    EXPECT_EQ(answer.text.find('\n'), std::string::npos);
    EXPECT_FALSE(answer.text.empty());
  }
  EXPECT_EQ(viewers_.rows(), 0U);
}

TEST_F(SimulatedSessionTest, ARestartIsAnotherRun) {
  open(true);
  ask("step", {{"ticks", 5}});
  const json before = viewers_.session([](const json& session) { return session["tick"] == 5; });
  ask("restart");
  const json after = viewers_.session([](const json& session) { return session["tick"] == 0; });
  EXPECT_NE(before["run"], after["run"]);
  EXPECT_EQ(after["state"], "paused");
}

TEST_F(SimulatedSessionTest, ARobotWithoutFilesRefusesToWriteThem) {
  open(true);
  EXPECT_TRUE(ask("set", {{"words", {"amplitude=30"}}}).is_done);
  for (const char* operation : {"file.diff", "file.apply"}) {
    const Viewers::Answer answer = ask(operation);
    EXPECT_FALSE(answer.is_done);
    EXPECT_EQ(answer.text, "this robot has no file; `proleg new robot --joints 5` writes one like it");
  }
}

TEST_F(SimulatedSessionTest, MovesAPausedRobotAndRepeatsItInTheCommand) {
  open(true);
  EXPECT_TRUE(ask("step", {{"ticks", 5}}).is_done);
  viewers_.session([](const json& session) { return session["tick"] == 5; });
  EXPECT_EQ(ask("move", {{"position", {0.5, 0.25, 0.125}}, {"turn", 30}}).text, R"({"tick":5})");
  const json session = viewers_.session([](const json& document) { return document["moved"] == true; });
  EXPECT_NEAR(session["head"][0].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(session["head"][2].get<double>(), 0.125, 1e-9);
  EXPECT_TRUE(ask("step", {{"ticks", 5}}).is_done);
  viewers_.session([](const json& document) { return document["tick"] == 10 && document["moved"] == false; });
  EXPECT_EQ(json::parse(ask("command_line").text)["text"],
            "proleg simulate uniform.simulation.xml --move 0.5,0.25,0.125,30@5 --seconds 0.1");
}

TEST_F(SimulatedSessionTest, RefusesToMoveARobotThatRunsOrToABadPlace) {
  open(true);
  for (const json& position : {json({1, 2}), json("here"), json(), json({1e300, 0, 0}), json({5000, 0, 0})}) {
    EXPECT_FALSE(ask("move", {{"position", position}}).is_done) << position;
  }
  EXPECT_TRUE(ask("run").is_done);
  EXPECT_EQ(ask("move", {{"position", {0, 0, 0.1}}}).text,
            "move: found a simulation that is not paused, expected a paused one");
}

}  // namespace
}  // namespace proleg::tools
