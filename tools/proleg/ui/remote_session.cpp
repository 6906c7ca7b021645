#include "tools/proleg/ui/remote_session.hpp"

#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "host/remote/binding.hpp"
#include "host/remote/event_devices.hpp"
#include "host/remote/remote_control.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using host::RemoteTime;
using nlohmann::json;

/// Requests of the remote control have this bit; the server counts from 1.
constexpr host::RequestId own_request = host::RequestId{1} << 63U;
constexpr const char* own_name = "remote control";

constexpr RemoteTime values_period{100};
/// Time for which the values are published after a viewer has said that it looks at them.
constexpr RemoteTime watch_time{5'000};
constexpr RemoteTime search_period{1'000};

bool is_own(host::RequestId request) { return (request & own_request) != 0; }

}  // namespace

TaskQueue::TaskQueue() : event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!event_.is_open()) {
    throw std::system_error(errno, std::generic_category(), "eventfd");
  }
}

void TaskQueue::post(std::function<void()> task) {
  const std::lock_guard lock(mutex_);
  tasks_.push_back(std::move(task));
  // It fails only if the counter is full; then the descriptor can be read already.
  [[maybe_unused]] const int ignored = eventfd_write(event_.number(), 1);
}

void TaskQueue::run() {
  std::vector<std::function<void()>> tasks;
  {
    const std::lock_guard lock(mutex_);
    tasks.swap(tasks_);
    eventfd_t count = 0;
    [[maybe_unused]] const int ignored = eventfd_read(event_.number(), &count);
  }
  for (auto task = tasks.begin(); task != tasks.end(); ++task) {
    try {
      (*task)();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      tasks_.insert(tasks_.begin(), std::make_move_iterator(task + 1), std::make_move_iterator(tasks.end()));
      [[maybe_unused]] const int ignored = eventfd_write(event_.number(), 1);
      throw;
    }
  }
}

std::unique_ptr<host::DeviceSource> RemoteSession::kernel_devices(host::DeviceListener& listener) {
  return std::make_unique<host::EventDevices>(listener, host::EventDevices::Folders{});
}

std::unique_ptr<host::DeviceSource> RemoteSession::no_devices(host::DeviceListener& /*listener*/) {
  struct NoDevices final : host::DeviceSource {
    void add_descriptors(std::vector<pollfd>& /*descriptors*/) const override {}
    [[nodiscard]] bool is_watching() const override { return true; }
    void read() override {}
  };
  return std::make_unique<NoDevices>();
}

RemoteSession::RemoteSession(host::RobotSession& session, host::BindingStore store, MakeDevices make_devices)
    : session_(session), make_devices_(std::move(make_devices)), store_(std::move(store)) {
  remote_.set_bindings(store_.read_bindings());
}

RemoteTime RemoteSession::now() {
  return std::chrono::duration_cast<RemoteTime>(std::chrono::steady_clock::now().time_since_epoch());
}

void RemoteSession::run() {
  try {
    devices_ = make_devices_(remote_);
  } catch (const std::exception& error) {
    remote_.problems_changed({"gamepads cannot be read: " + one_line(error.what())});
  }
  constexpr std::chrono::milliseconds pause_after_error{20};
  while (!ends_) {
    try {
      serve();
    } catch (const std::exception& error) {
      fail(one_line(error.what()));
      std::this_thread::sleep_for(pause_after_error);  // an error that persists must not keep the processor busy
    }
  }
}

void RemoteSession::serve() {
  if (!has_failed_) {
    remote_.advance(now());
  }
  // Who has lost control is told before what a hand does now.
  tasks_.run();
  if (ends_) {
    return;
  }
  if (devices_) {
    devices_->read();
  }
  if (!has_failed_) {
    remote_.advance(now());
  }
  publish_news();
  wait();
}

/// Without devices nothing moves by a hand any more; what a button holds ends as if the holder went away.
void RemoteSession::fail(const std::string& why) {
  if (has_failed_) {
    return;
  }
  has_failed_ = true;
  viewers_->notice(host::NoticeLevel::error, std::string(own_name) + ": " + why);
  devices_.reset();
  try {
    remote_.problems_changed({"the remote control has failed: " + why});
    remote_.set_allowed(false);
  } catch (const std::exception& error) {
    viewers_->notice(host::NoticeLevel::error, std::string(own_name) + ": " + one_line(error.what()));
  }
}

void RemoteSession::wait() const {
  std::vector<pollfd> descriptors{{tasks_.descriptor(), POLLIN, 0}};
  std::optional<RemoteTime> due = remote_.due();
  const auto consider = [&due](RemoteTime time) { due = due ? std::min(*due, time) : time; };
  const RemoteTime present = now();
  if (devices_) {
    devices_->add_descriptors(descriptors);
    if (!devices_->is_watching()) {
      consider(present + search_period);
    }
  }
  if (present < watched_until_) {
    consider(values_due_);
  }
  // One millisecond more: the clock is rounded down.
  const int timeout =
      due ? static_cast<int>(std::max(RemoteTime{0}, *due - present).count()) + (*due > present ? 1 : 0) : -1;
  ::poll(descriptors.data(), descriptors.size(), timeout);
}

void RemoteSession::publish_news() {
  if (remote_.revision() != published_revision_ || is_saved_new_) {
    published_revision_ = remote_.revision();
    is_saved_new_ = false;
    json document = host::remote_document(remote_);
    document["file"] = store_.path().empty() ? json() : json(store_.path().filename().string());
    document["saved"] = store_.has(present_bindings());
    viewers_->publish("remote", document);
  }
  const RemoteTime present = now();
  if (present < watched_until_ && present >= values_due_) {
    values_due_ = present + values_period;
    json values = host::remote_values_document(remote_);
    if (values != published_values_) {
      viewers_->publish("remote_values", values);
      published_values_ = std::move(values);
    }
  }
}

// From viewers, on the server's thread.

void RemoteSession::operate(const host::OperationRequest& request) {
  tasks_.post([this, request] { carry_out(request); });
}

void RemoteSession::stop(const host::StopRequest& /*request*/) {
  tasks_.post([this] { remote_.robot_stopped(); });
}

void RemoteSession::holder_changed(bool has_holder, bool is_away) {
  tasks_.post([this, is_allowed = has_holder && !is_away] { remote_.set_allowed(is_allowed); });
}

// From the session, on its thread.

void RemoteSession::publish(const std::string& document, const json& value) {
  viewers_->publish(document, value);
  if (document == "robot" || document == "parameters" || document == "session") {
    tasks_.post([this, document, value] { receive(document, value); });
  }
}

void RemoteSession::set_signals(const host::SignalLayout& layout, std::uint32_t tick_us) {
  viewers_->set_signals(layout, tick_us);
}

void RemoteSession::add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) {
  viewers_->add_row(run, tick, row);
}

void RemoteSession::answer(host::RequestId request, const json& value) {
  if (is_own(request)) {
    tasks_.post([this, request] { own_request_answered(request, {}); });
  } else {
    viewers_->answer(request, value);
  }
}

void RemoteSession::refuse(host::RequestId request, const std::string& error) {
  if (is_own(request)) {
    tasks_.post([this, request, error] { own_request_answered(request, error); });
  } else {
    viewers_->refuse(request, error);
  }
}

void RemoteSession::stopped(host::RequestId request, unsigned confirmed, unsigned of, double ms) {
  if (!is_own(request)) {
    viewers_->stopped(request, confirmed, of, ms);
  }
}

void RemoteSession::notice(host::NoticeLevel level, const std::string& text) { viewers_->notice(level, text); }

// On the thread of the remote control.

void RemoteSession::receive(const std::string& document, const json& value) {
  if (document == "robot") {
    words_.set_robot(value);
    remote_.require_hold(value.value("kind", "") == "bus");
  } else if (document == "parameters") {
    words_.set_parameters(value);
  } else {
    const std::string state = value.value("state", "");
    is_running_ = state == "running" || state == "starting";
  }
}

void RemoteSession::own_request_answered(host::RequestId request, const std::string& refusal) {
  const auto asked = asked_.find(request);
  if (asked == asked_.end()) {
    return;
  }
  const std::optional<host::RobotCommand> command = asked->second;
  asked_.erase(asked);
  if (!command) {
    remote_.set_answered(refusal);
    return;
  }
  remote_.command_answered(*command, refusal.empty());
  if (!refusal.empty()) {
    viewers_->notice(host::NoticeLevel::warning, std::string(own_name) + ": " + refusal);
  }
}

host::RequestId RemoteSession::ask(const std::string& name, const json& arguments) {
  const host::RequestId request = own_request | ++last_request_;
  session_.operate({request, name, arguments, 0, own_name});
  return request;
}

void RemoteSession::set(const std::vector<std::string>& words, std::uint64_t gesture) {
  asked_[ask("set", {{"words", words}, {"gesture", gesture}})] = std::nullopt;
}

void RemoteSession::command(host::RobotCommand command) {
  constexpr const char* names[] = {"run", "pause", "step", "restart"};
  asked_[ask(names[static_cast<std::size_t>(command)], json::object())] = command;
}

void RemoteSession::stop(const std::string& by) {
  session_.stop({own_request | ++last_request_, by});
  remote_.robot_stopped();
}

std::optional<double> RemoteSession::present(const std::string& parameter) const {
  try {
    return words_.find(parameter).wanted;
  } catch (const std::exception&) {
    return std::nullopt;  // the robot has no such parameter any more
  }
}

void RemoteSession::carry_out(const host::OperationRequest& request) {
  static const std::map<std::string_view, Handler> handlers{{"remote.bind", &RemoteSession::bind},
                                                            {"remote.unbind", &RemoteSession::unbind},
                                                            {"remote.learn", &RemoteSession::learn},
                                                            {"remote.save", &RemoteSession::save},
                                                            {"remote.watch", &RemoteSession::watch}};
  try {
    (this->*handler_of(handlers, request.name))(request);
  } catch (const std::exception& error) {
    viewers_->refuse(request.request, one_line(error.what()));
  }
}

std::vector<host::Binding> RemoteSession::present_bindings() const {
  std::vector<host::Binding> bindings;
  bindings.reserve(remote_.bindings().size());
  for (const host::RemoteControl::Bound& bound : remote_.bindings()) {
    bindings.push_back(bound.binding);
  }
  return bindings;
}

std::size_t RemoteSession::place_of(const host::OperationRequest& request) const {
  const std::size_t count = remote_.bindings().size();
  const auto place = argument<std::size_t>(request.arguments, "place", "a whole number");
  if (!place || *place >= count) {
    throw InputError("place", 0, place ? std::to_string(*place) : "none",
                     count == 0 ? "a binding, and there is none" : "0 to " + std::to_string(count - 1));
  }
  return *place;
}

void RemoteSession::bind(const host::OperationRequest& request) {
  const auto value = argument<json>(request.arguments, "binding", "an object");
  host::Binding binding = host::read_binding(value.value_or(json()), "binding");
  check_binding(binding, words_, "binding");
  std::vector<host::Binding> bindings = present_bindings();
  std::size_t place = bindings.size();
  if (request.arguments.contains("place")) {
    place = place_of(request);
    bindings[place] = std::move(binding);
  } else if (place == host::max_bindings) {
    throw InputError("remote.bind", 0, "one binding more", "at most " + std::to_string(host::max_bindings));
  } else {
    bindings.push_back(std::move(binding));
  }
  remote_.set_bindings(std::move(bindings));
  viewers_->answer(request.request, {{"place", place}});
}

void RemoteSession::unbind(const host::OperationRequest& request) {
  const std::size_t place = place_of(request);
  std::vector<host::Binding> bindings = present_bindings();
  bindings.erase(bindings.begin() + static_cast<std::ptrdiff_t>(place));
  remote_.set_bindings(std::move(bindings));
  viewers_->answer(request.request, json::object());
}

void RemoteSession::learn(const host::OperationRequest& request) {
  if (argument<bool>(request.arguments, "end", "true or false").value_or(false)) {
    remote_.end_learning();
    viewers_->answer(request.request, json::object());
    return;
  }
  remote_.learn([this, number = request.request](const std::optional<host::RemoteControl::Learned>& learned) {
    if (!learned) {
      viewers_->refuse(number, "no element was moved clearly");
      return;
    }
    viewers_->answer(number, {{"device", learned->device},
                              {"element", learned->element.name},
                              {"kind", learned->element.kind == host::ElementKind::axis ? "axis" : "button"}});
  });
}

void RemoteSession::save(const host::OperationRequest& request) {
  store_.save(present_bindings());
  is_saved_new_ = true;
  viewers_->answer(request.request, {{"file", store_.path().string()}});
}

void RemoteSession::watch(const host::OperationRequest& request) {
  watched_until_ = now() + watch_time;
  published_values_ = nullptr;  // also for a viewer that has come since
  viewers_->answer(request.request, json::object());
}

RemoteThread::RemoteThread(RemoteSession& session, host::SessionOutput& viewers) : session_(session) {
  session_.viewers_ = &viewers;
  thread_ = std::thread([this] { session_.run(); });
}

RemoteThread::~RemoteThread() {
  session_.tasks_.post([this] { session_.ends_ = true; });
  thread_.join();
}

}  // namespace proleg::tools
