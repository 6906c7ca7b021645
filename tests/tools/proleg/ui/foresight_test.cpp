#include "tools/proleg/ui/foresight.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "shipped.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

/// All paths that were published, in their order.
class Paths final : public host::SessionOutput {
 public:
  void publish(const std::string& /*document*/, const json& value) override {
    const std::lock_guard lock(mutex_);
    paths_.push_back(value);
    changed_.notify_all();
  }
  void set_signals(const host::SignalLayout& /*layout*/, std::uint32_t /*tick_us*/) override {}
  void add_row(std::uint16_t /*run*/, std::uint32_t /*tick*/, std::span<const std::int32_t> /*row*/) override {}
  void answer(host::RequestId /*request*/, const json& /*value*/) override {}
  void refuse(host::RequestId /*request*/, const std::string& /*error*/) override {}
  void stopped(host::RequestId /*request*/, unsigned /*confirmed*/, unsigned /*of*/, double /*ms*/) override {}
  void notice(host::NoticeLevel /*level*/, const std::string& /*text*/) override {}

  std::vector<json> until(const std::function<bool(const json&)>& is_last) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(
        changed_.wait_for(lock, std::chrono::minutes(5), [&] { return !paths_.empty() && is_last(paths_.back()); }));
    return paths_;
  }
  std::size_t count() {
    const std::lock_guard lock(mutex_);
    return paths_.size();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<json> paths_;
};

std::shared_ptr<const sim::Scenario> caterpillar() {
  return std::make_shared<const sim::Scenario>(sim::shipped("travelling_wave/uniform"));
}

TEST(ForesightTest, TheFirstSecondsComeBeforeTheWhole) {
  Paths output;
  Foresight foresight(output);
  foresight.look_at(caterpillar(), 3);
  const std::vector<json> paths = output.until([](const json& path) { return path["is_complete"] == true; });
  ASSERT_EQ(paths.size(), 2U);
  const json& start = paths[0];
  const json& whole = paths[1];
  EXPECT_EQ(start["is_complete"], false);
  EXPECT_EQ(start["distance"], json()) << "of the whole only";
  for (const json& path : paths) {
    EXPECT_EQ(path["revision"], 3);
    EXPECT_EQ(path["engine"], "reduced");
  }
  EXPECT_EQ(whole["path"].size(), 301U);
  EXPECT_LT(start["path"].size(), whole["path"].size());
  for (std::size_t i = 0; i < start["path"].size(); ++i) {
    EXPECT_EQ(start["path"][i], whole["path"][i]) << i;
  }
}

// The path is that of another engine then; a simulation would fail.
TEST(ForesightTest, SaysWhyTheEngineOfTheScenarioRefusesIt) {
  const auto with_engine = [](sim::PhysicsEngine engine) {
    sim::Scenario scenario = sim::shipped("retreat/wall");  // it has touch sensors
    scenario.environment.engine = engine;
    return std::make_shared<const sim::Scenario>(scenario);
  };
  Paths output;
  Foresight foresight(output);
  const auto whole = [](std::uint64_t revision) {
    return [revision](const json& path) { return path["revision"] == revision && path["is_complete"] == true; };
  };
  foresight.look_at(with_engine(sim::PhysicsEngine::reduced), 1);
  const json refused = output.until(whole(1)).back();
  EXPECT_EQ(refused["engine"], "ode");
  EXPECT_NE(refused["refusal"].get<std::string>().find("TactileSensor"), std::string::npos) << refused["refusal"];
  foresight.look_at(with_engine(sim::PhysicsEngine::ode), 2);
  EXPECT_EQ(output.until(whole(2)).back()["refusal"], json());
}

// A person who drags something makes changes faster than a path is computed.
TEST(ForesightTest, PathsComeWhileChangesDo) {
  Paths output;
  Foresight foresight(output);
  const std::shared_ptr<const sim::Scenario> scenario = caterpillar();
  std::uint64_t revision = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (output.count() < 4 && std::chrono::steady_clock::now() < end) {
    foresight.look_at(scenario, ++revision);
  }
  EXPECT_GE(output.count(), 4U);
  foresight.look_at(scenario, ++revision);
  const std::vector<json> paths =
      output.until([&](const json& path) { return path["revision"] == revision && path["is_complete"] == true; });
  std::uint64_t before = 0;
  for (const json& path : paths) {
    EXPECT_GE(path["revision"], before) << "the newest is computed next";
    before = path["revision"];
  }
}

}  // namespace
}  // namespace proleg::tools
