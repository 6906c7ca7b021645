// host_counting_robot FOLDER [CERTIFICATE]: a web server whose robot is a counter, for the tests in this folder. It
// prints one line, "PORT TOKEN ORIGIN", and ends when its standard input does. The robot has five joints and counts
// ticks in a thread of its own, 1 ms each ("rate" changes that).
//
//   free operations: "value" (the number that "add" changes), "rss" (resident memory of the process in KiB), "wait"
//   (answered by "finish"), "finish", "large" (a document of so many bytes, so many times)
//   others: "add" {"by": n}, "run", "rate" {"ticks_per_second": n}, "restart", "joints" {"count": n}

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "host/server/server_certificate.hpp"
#include "host/server/web_server.hpp"

namespace {

using namespace proleg::host;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

long resident_kib() {
  std::ifstream file("/proc/self/statm");
  long total = 0;
  long resident = 0;
  file >> total >> resident;
  return resident * 4;
}

/// What the server asks is put into a queue; the robot's thread takes it from there between two ticks.
class CountingRobot final : public RobotSession {
 public:
  void operate(const OperationRequest& request) override { put({request, {}, false}); }
  void stop(const StopRequest& request) override { put({{}, request, true}); }
  void holder_changed(bool /*has_holder*/, bool /*is_away*/) override {}  // a counter goes on alone

  void run(WebServer& server) {
    set_joints(server, 5);
    publish(server);
    Clock::time_point next_tick = Clock::now();
    while (!has_ended_) {
      next_tick += std::chrono::nanoseconds(1'000'000'000 / ticks_per_second_);
      next_tick = std::max(next_tick, Clock::now() - std::chrono::milliseconds(100));
      for (const Task& task : take_until(next_tick)) {
        perform(server, task);
      }
      if (!is_running_) {
        continue;
      }
      std::fill(row_.begin(), row_.end(), static_cast<std::int32_t>(tick_));
      row_.back() = count_;
      server.add_row(run_, tick_, row_);
      ++tick_;
    }
  }

  void end() { has_ended_ = true; }

 private:
  struct Task {
    OperationRequest operation;
    StopRequest stop;
    bool is_stop = false;
  };

  void put(Task task) {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
    condition_.notify_one();
  }

  std::deque<Task> take_until(Clock::time_point time) {
    std::unique_lock lock(mutex_);
    condition_.wait_until(lock, time, [this] { return !tasks_.empty(); });
    return std::exchange(tasks_, {});
  }

  void set_joints(WebServer& server, std::size_t joints) {
    const SignalLayout layout({{"angle", "degree", 0.5, joints, SignalOf::joint},
                               {"contact", "", 1, joints + 1, SignalOf::link},
                               {"count", "", 1, 1, SignalOf::robot}});
    row_.assign(layout.row_size(), 0);
    server.set_signals(layout, 1000);
  }

  void publish(WebServer& server) {
    server.publish("session", {{"state", is_running_ ? "running" : "stopped"}, {"count", count_}});
  }

  void perform(WebServer& server, const Task& task) {
    if (task.is_stop) {
      is_running_ = false;
      server.stopped(task.stop.request, 5, 5, 0.5);
      server.notice(NoticeLevel::warning, "stopped by " + task.stop.by);
      publish(server);
      return;
    }
    const RequestId request = task.operation.request;
    const std::string& name = task.operation.name;
    const json& arguments = task.operation.arguments;
    if (name == "add") {
      count_ += arguments.value("by", 1);
      publish(server);
      server.answer(request, {{"count", count_}});
    } else if (name == "value") {
      server.answer(request, {{"count", count_}});
    } else if (name == "rss") {
      server.answer(request, {{"kib", resident_kib()}});
    } else if (name == "wait") {
      waiting_.push_back(request);
    } else if (name == "finish") {
      for (const RequestId waiting : std::exchange(waiting_, {})) {
        server.answer(waiting, nullptr);
      }
      server.answer(request, nullptr);
    } else if (name == "large") {
      const std::string text(arguments.value("bytes", std::size_t{0}), 'x');
      for (int i = 0; i < arguments.value("times", 1); ++i) {
        server.publish("large", {{"number", i}, {"text", text}});
      }
      server.answer(request, nullptr);
    } else if (name == "rate") {
      ticks_per_second_ = arguments.value("ticks_per_second", 1000);
      server.answer(request, nullptr);
    } else if (name == "run") {
      is_running_ = true;
      publish(server);
      server.answer(request, nullptr);
    } else if (name == "restart") {
      ++run_;
      tick_ = 0;
      server.answer(request, nullptr);
    } else if (name == "joints") {
      set_joints(server, arguments.value("count", std::size_t{5}));
      server.answer(request, nullptr);
    } else {
      server.refuse(request, "found operation '" + name + "', expected one of this robot");
    }
  }

  std::mutex mutex_;
  std::condition_variable condition_;
  std::deque<Task> tasks_;
  std::atomic<bool> has_ended_ = false;

  int count_ = 0;
  bool is_running_ = true;
  int ticks_per_second_ = 1000;
  std::uint16_t run_ = 1;
  std::uint32_t tick_ = 0;
  std::vector<std::int32_t> row_;
  std::vector<RequestId> waiting_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    std::cerr << "found " << argc - 1 << " words, expected the folder of the page, and perhaps a certificate\n";
    return 2;
  }
  boost::asio::io_context context;
  CountingRobot robot;
  const AccessToken token = AccessToken::make();
  ServerOptions options{token, PageFiles(argv[1]), "counting robot 1", {"value", "rss", "wait", "finish", "large"}};
  if (argc == 3) {
    options.certificate = std::make_shared<ServerCertificate>(argv[2], argv[2]);
  }
  WebServer server(context, std::move(options), robot);
  std::cout << server.port() << ' ' << token.text() << ' ' << server.origin() << std::endl;

  std::thread serving([&context] { context.run(); });
  std::thread counting([&robot, &server] { robot.run(server); });
  while (std::cin.get() != EOF) {
  }
  robot.end();
  counting.join();
  server.stop();
  serving.join();  // the server leaves no work behind
  std::cerr << "ended\n";
  return 0;
}
