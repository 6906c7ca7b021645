#include "tools/proleg/ui/remote_session.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "host/remote/binding.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

/// Values that one thread writes and another one waits for.
class Log {
 public:
  void add(const std::string& line) {
    const std::lock_guard lock(mutex_);
    text_ += line + '\n';
    changed_.notify_all();
  }
  /// Whether the line comes, now or later.
  bool has(const std::string& line) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(5), [&] { return text_.find(line) != std::string::npos; });
  }
  std::string text() {
    const std::lock_guard lock(mutex_);
    return text_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string text_;
};

/// A robot that is asked.
class Robot final : public host::RobotSession {
 public:
  void operate(const host::OperationRequest& request) override {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request.request);
    log.add(request.name + ' ' + request.arguments.value("words", json()).dump());
  }
  void stop(const host::StopRequest& request) override { log.add("STOP by " + request.by); }
  void holder_changed(bool has_holder, bool /*is_away*/) override { log.add(has_holder ? "holder" : "no holder"); }
  host::RequestId last_request() {
    const std::lock_guard lock(mutex_);
    return requests_.back();
  }

  Log log;

 private:
  std::mutex mutex_;
  std::vector<host::RequestId> requests_;
};

/// What viewers get.
class Viewers final : public host::SessionOutput {
 public:
  void publish(const std::string& document, const json& value) override { log.add(document + ' ' + value.dump()); }
  void set_signals(const host::SignalLayout& /*layout*/, std::uint32_t /*tick_us*/) override {}
  void add_row(std::uint16_t /*run*/, std::uint32_t tick, std::span<const std::int32_t> /*row*/) override {
    log.add("row " + std::to_string(tick));
  }
  void answer(host::RequestId request, const json& value) override {
    log.add("answer " + std::to_string(request) + ' ' + value.dump());
  }
  void refuse(host::RequestId request, const std::string& error) override {
    log.add("refuse " + std::to_string(request) + ' ' + error);
  }
  void stopped(host::RequestId request, unsigned /*confirmed*/, unsigned /*of*/, double /*ms*/) override {
    log.add("stopped " + std::to_string(request));
  }
  void notice(host::NoticeLevel /*level*/, const std::string& text) override { log.add("notice " + text); }

  Log log;
};

/// Devices that the test moves. Its calls wait in a queue for the thread of the remote control.
class Hand final : public host::DeviceSource {
 public:
  explicit Hand(TaskQueue& queue) : queue_(queue) {}
  void add_descriptors(std::vector<pollfd>& descriptors) const override {
    descriptors.push_back({queue_.descriptor(), POLLIN, 0});
  }
  [[nodiscard]] bool is_watching() const override { return true; }
  void read() override { queue_.run(); }

 private:
  TaskQueue& queue_;
};

class Remote : public testing::Test {
 protected:
  Remote() {
    thread.emplace(session, viewers);
    session.publish("robot", {{"kind", "simulation"}, {"joints", json::array()}, {"slots", json::array()}});
    session.publish("parameters", json::array({{{"slot", 1},
                                                {"name", "amplitude"},
                                                {"internal", false},
                                                {"scale", 1},
                                                {"minimum", 0},
                                                {"maximum", 90},
                                                {"wraps", false},
                                                {"joints", {0}},
                                                {"wanted", {45}}}}));
    hand.post([this] {
      listener->plugged(
          {1, "Pad", {{"ABS_X", host::ElementKind::axis}, {"BTN_SOUTH", host::ElementKind::button}}, {0, 0}});
    });
  }
  ~Remote() override { thread.reset(); }

  void ask(host::RequestId request, const std::string& name, const json& arguments) {
    session.operate({request, name, arguments, 1, "viewer"});
  }
  void move(std::size_t element, double position) {
    hand.post([this, element, position] { listener->moved({1, element}, position); });
  }
  /// Somebody drives, and holds the button for which the robot runs.
  void hold_to_run() {
    session.holder_changed(true, false);
    ask(1, "remote.bind", bound_button("hold_to_run"));
    ASSERT_TRUE(viewers.log.has("answer 1"));
    move(1, 1);
    ASSERT_TRUE(robot.log.has("run"));
  }
  static json bound_axis() {
    return {{"binding",
             {{"device", "Pad"},
              {"element", "ABS_X"},
              {"parameters", {"amplitude"}},
              {"lower", 0},
              {"upper", 90},
              {"step", 1}}}};
  }
  static json bound_button(const std::string& action) {
    return {{"binding", {{"device", "Pad"}, {"element", "BTN_SOUTH"}, {"action", action}}}};
  }

  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "robot.remote.json";
  Robot robot;
  Viewers viewers;
  TaskQueue hand;
  host::DeviceListener* listener = nullptr;
  RemoteSession session{robot, host::BindingStore(path), [this](host::DeviceListener& receiver) {
                          listener = &receiver;
                          return std::make_unique<Hand>(hand);
                        }};
  std::optional<RemoteThread> thread;
};

TEST_F(Remote, PassesOnWhatItDoesNotNeed) {
  session.answer(7, json::object());
  session.refuse(9, "no");
  session.stopped(8, 1, 1, 1);
  session.add_row(1, 3, {});
  for (const char* line : {"answer 7 {}", "refuse 9 no", "stopped 8", "row 3"}) {
    EXPECT_TRUE(viewers.log.has(line)) << line;
  }
}

TEST_F(Remote, SetsAParameterWhileSomebodyDrives) {
  session.holder_changed(true, false);
  ask(1, "remote.bind", bound_axis());
  ASSERT_TRUE(viewers.log.has("answer 1 {\"place\":0}"));
  move(0, 0.2);
  EXPECT_TRUE(robot.log.has("set [\"amplitude=54\"]"));
  session.answer(robot.last_request(), {{"tick", 3}});
  move(0, 1);
  EXPECT_TRUE(robot.log.has("set [\"amplitude=90\"]"));
  EXPECT_EQ(viewers.log.text().find("\"tick\""), std::string::npos);  // nobody has asked for this answer
}

TEST_F(Remote, ShowsWhyTheRobotRefuses) {
  session.holder_changed(true, false);
  ask(1, "remote.bind", bound_axis());
  ASSERT_TRUE(viewers.log.has("answer 1"));
  move(0, 0.2);
  ASSERT_TRUE(robot.log.has("set"));
  session.refuse(robot.last_request(), "the robot sleeps");
  EXPECT_TRUE(viewers.log.has("\"problems\":[\"the robot sleeps\"]"));
}

TEST_F(Remote, PausesWhenTheHolderGoesAwayWhileAButtonIsHeld) {
  hold_to_run();
  session.answer(robot.last_request(), json::object());
  session.holder_changed(true, true);
  EXPECT_TRUE(robot.log.has("pause"));
}

TEST_F(Remote, StopsARobotThatRefusesToPause) {
  hold_to_run();
  move(1, 0);
  ASSERT_TRUE(robot.log.has("pause"));
  session.refuse(robot.last_request(), "no");
  EXPECT_TRUE(robot.log.has("STOP by hold-to-run"));
  EXPECT_TRUE(viewers.log.has("notice remote control: no"));
}

TEST_F(Remote, PausesAndAnswersViewersAfterAnErrorOfADevice) {
  hold_to_run();
  session.answer(robot.last_request(), json::object());
  hand.post([] { throw std::runtime_error("the pad is broken"); });
  EXPECT_TRUE(viewers.log.has("notice remote control: the pad is broken"));
  EXPECT_TRUE(robot.log.has("pause"));
  ask(2, "remote.unbind", {{"place", 0}});
  EXPECT_TRUE(viewers.log.has("answer 2 {}"));
}

TEST(RemoteWithoutDevices, AnswersViewersIfTheDevicesCannotBeRead) {
  const TemporaryFolder folder;
  Robot robot;
  Viewers viewers;
  RemoteSession session(robot, host::BindingStore(folder / "robot.remote.json"),
                        [](host::DeviceListener& /*receiver*/) -> std::unique_ptr<host::DeviceSource> {
                          throw std::runtime_error("no driver");
                        });
  const RemoteThread thread(session, viewers);
  EXPECT_TRUE(viewers.log.has("gamepads cannot be read: no driver"));
  session.operate({1, "remote.unbind", {{"place", 0}}, 1, "viewer"});
  EXPECT_TRUE(viewers.log.has("refuse 1 "));
}

TEST_F(Remote, StopsWithoutControl) {
  ask(1, "remote.bind", bound_button("stop"));
  ASSERT_TRUE(viewers.log.has("answer 1"));
  move(1, 1);
  EXPECT_TRUE(robot.log.has("STOP by Pad"));
}

TEST_F(Remote, TellsWhichElementWasMoved) {
  ask(4, "remote.learn", json::object());
  ASSERT_TRUE(viewers.log.has("\"learning\":true"));
  move(0, -0.9);
  EXPECT_TRUE(viewers.log.has(R"(answer 4 {"device":"Pad","element":"ABS_X","kind":"axis"})"));
}

TEST_F(Remote, EndsLearningWhenItIsAskedTo) {
  ask(4, "remote.learn", json::object());
  ask(5, "remote.learn", {{"end", true}});
  EXPECT_TRUE(viewers.log.has("refuse 4 no element was moved clearly"));
  EXPECT_TRUE(viewers.log.has("answer 5 {}"));
}

TEST_F(Remote, ReplacesRemovesAndSavesBindings) {
  ask(1, "remote.bind", bound_button("run"));
  json replaced = bound_button("pause");
  replaced["place"] = 0;
  ask(2, "remote.bind", replaced);
  ask(3, "remote.bind", bound_axis());
  ask(4, "remote.unbind", {{"place", 1}});
  ask(5, "remote.save", json::object());
  ASSERT_TRUE(viewers.log.has("answer 5"));
  const std::vector<host::Binding> saved = host::read_bindings(file_contents(path), "saved");
  ASSERT_EQ(saved.size(), 1U);
  EXPECT_EQ(std::get<host::RemoteAction>(saved[0].target), host::RemoteAction::pause);
  EXPECT_TRUE(viewers.log.has("\"saved\":true"));
}

TEST_F(Remote, RefusesWhatItCannotDo) {
  json unknown = bound_axis();
  unknown["binding"]["parameters"] = {"speed"};
  ask(1, "remote.bind", unknown);
  ask(2, "remote.unbind", {{"place", 0}});
  ask(3, "remote.fly", json::object());
  ask(4, "remote.bind", {{"binding", 7}});
  EXPECT_TRUE(viewers.log.has("refuse 1 binding: speed: found no such parameter, expected one of 1.amplitude"));
  EXPECT_TRUE(viewers.log.has("refuse 2 place: found 0, expected a binding, and there is none"));
  EXPECT_TRUE(viewers.log.has("refuse 3 operation: found 'remote.fly'"));
  EXPECT_TRUE(viewers.log.has("refuse 4 binding: found 7, expected an object"));
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(Remote, ShowsPositionsToThoseWhoLook) {
  ask(1, "remote.watch", json::object());
  EXPECT_TRUE(viewers.log.has(R"(remote_values {"bindings":[],"devices":[{"id":1,"positions":[0.0,0.0]}]})"));
  move(0, 0.5);
  EXPECT_TRUE(viewers.log.has(R"(remote_values {"bindings":[],"devices":[{"id":1,"positions":[0.5,0.0]}]})"));
}

}  // namespace
}  // namespace proleg::tools
