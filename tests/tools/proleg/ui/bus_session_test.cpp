// A robot on virtual time behind the page: what it does with operations that it refuses, and after errors.

#include "tools/proleg/ui/bus_session.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "shipped.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/robot/simulated_transport.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

/// What the session has told its viewers.
class BusViewers final : public host::SessionOutput {
 public:
  struct Answer {
    bool is_done = false;
    std::string error;
  };

  void publish(const std::string& document, const json& value) override {
    change([&] { documents_[document] = value; });
  }
  void set_signals(const host::SignalLayout& /*layout*/, std::uint32_t /*tick_us*/) override {}
  void add_row(std::uint16_t /*run*/, std::uint32_t /*tick*/, std::span<const std::int32_t> /*row*/) override {}
  void answer(host::RequestId request, const json& /*value*/) override {
    change([&] { answers_[request] = {true, {}}; });
  }
  void refuse(host::RequestId request, const std::string& error) override {
    change([&] { answers_[request] = {false, error}; });
  }
  void stopped(host::RequestId request, unsigned /*confirmed*/, unsigned /*of*/, double /*ms*/) override {
    change([&] { answers_[request] = {true, {}}; });
  }
  void notice(host::NoticeLevel /*level*/, const std::string& text) override {
    change([&] { notices_ += text + '\n'; });
  }

  Answer wait_for_answer(host::RequestId request) {
    wait_for([&] { return answers_.contains(request); });
    const std::lock_guard lock(mutex_);
    return answers_[request];
  }
  /// A document, when it is as it is waited for.
  json wait_for_document(const std::string& name, const std::function<bool(const json&)>& is_so) {
    wait_for([&] { return documents_.contains(name) && is_so(documents_[name]); });
    const std::lock_guard lock(mutex_);
    return documents_[name];
  }
  std::string notices() {
    const std::lock_guard lock(mutex_);
    return notices_;
  }

 private:
  void change(const std::function<void()>& action) {
    const std::lock_guard lock(mutex_);
    action();
    changed_.notify_all();
  }
  void wait_for(const std::function<bool()>& condition) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, std::chrono::minutes(2), condition)) {
      throw std::runtime_error("it did not come in 2 minutes");
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<host::RequestId, Answer> answers_;
  std::map<std::string, json> documents_;
  std::string notices_;
};

/// A simulated robot behind an adapter that fails when it is told to.
class FailingTransport final : public host::Transport {
 public:
  FailingTransport(const sim::Scenario& scenario, std::atomic<bool>& fails, host::TransportListener& listener)
      : robot_(scenario, "a test", listener), fails_(fails) {}

  [[nodiscard]] Microseconds now() const override { return robot_.now(); }
  [[nodiscard]] bool send(const CanFrame& frame) override { return robot_.send(frame); }
  void run_until(Microseconds deadline) override {
    if (fails_.exchange(false)) {
      throw std::runtime_error("the adapter\nhas failed");
    }
    robot_.run_until(deadline);
  }
  [[nodiscard]] const host::BusState& state() const override { return robot_.state(); }
  [[nodiscard]] host::Statistics statistics() const override { return robot_.statistics(); }
  [[nodiscard]] std::string description() const override { return robot_.description(); }

 private:
  SimulatedTransport robot_;
  std::atomic<bool>& fails_;
};

class BusSessionTest : public ::testing::Test {
 protected:
  BusViewers::Answer ask(const std::string& name, const json& arguments = json::object()) {
    requests_.operate({++request_, name, arguments, 1, "a test"});
    return viewers_.wait_for_answer(request_);
  }
  json wait_for_state(const std::string& state) {
    return viewers_.wait_for_document("session", [&](const json& session) { return session["state"] == state; });
  }
  json wait_for_drives(const std::string& drive) {
    return viewers_.wait_for_document("bus", [&](const json& bus) {
      return bus["modules"].size() == scenario_.modules.size() &&
             std::ranges::all_of(bus["modules"], [&](const json& module) { return module["drive"] == drive; });
    });
  }
  void SetUp() override {
    requests_.holder_changed(true, false);
    session_.emplace(scenario_, bus_, "a test", BusSessionOptions{folder_ / "", "test"}, sharing_, requests_, viewers_);
    wait_for_drives("no power");
  }

  const sim::Scenario scenario_ = sim::shipped("travelling_wave/uniform");
  TemporaryFolder folder_;
  std::atomic<bool> adapter_fails_ = false;
  BusAccess bus_{[this](host::TransportListener& listener) {
    return std::make_unique<FailingTransport>(scenario_, adapter_fails_, listener);
  }};
  SessionRequests requests_;
  BusViewers viewers_;
  host::RequestId request_ = 0;
  BusSharing sharing_;
  std::optional<BusSession> session_;
};

TEST_F(BusSessionTest, ARefusedChangeIsNotMade) {
  const BusViewers::Answer answer = ask("set", {{"words", {"amplitude:J2=30", "current_phase:J1=90"}}});
  EXPECT_FALSE(answer.is_done) << "an internal value needs a robot with power";
  EXPECT_EQ(answer.error, "the servos have no power");
  EXPECT_EQ(ask("undo").error, "there is nothing to undo");
  EXPECT_FALSE(viewers_.wait_for_document("session", [](const json&) { return true; })["changed"]);
}

TEST_F(BusSessionTest, ChangesWithoutPowerAreMadeAndUndone) {
  EXPECT_TRUE(ask("set", {{"words", {"amplitude:J2=30"}}}).is_done);
  viewers_.wait_for_document("session", [](const json& session) { return session["changed"] == true; });
  EXPECT_TRUE(ask("undo").is_done);
  viewers_.wait_for_document("session", [](const json& session) { return session["changed"] == false; });
  EXPECT_EQ(ask("undo").error, "there is nothing to undo");
}

TEST_F(BusSessionTest, AfterAnErrorTheRobotHasNoPowerAndViewersAreStillServed) {
  EXPECT_TRUE(ask("power", {{"on", true}}).is_done);
  wait_for_state("held");
  wait_for_drives("operation enabled");
  adapter_fails_ = true;
  EXPECT_EQ(wait_for_state("failed")["failure"], "the adapter has failed");
  wait_for_drives("no power");
  EXPECT_NE(viewers_.notices().find("the adapter has failed\n"), std::string::npos);
  EXPECT_TRUE(ask("ping").is_done);
  EXPECT_EQ(ask("power", {{"on", true}}).error, "the session has failed; start proleg ui again");
  requests_.stop({++request_, "a test"});
  EXPECT_TRUE(viewers_.wait_for_answer(request_).is_done);
}

}  // namespace
}  // namespace proleg::tools
