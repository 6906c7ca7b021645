#pragma once

// Remote control of a session: what the session answers passes through here. Input devices are read in a thread of its
// own.

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/remote/binding.hpp"
#include "host/remote/device_listener.hpp"
#include "host/remote/remote_control.hpp"
#include "host/server/robot_session.hpp"
#include "host/transport/descriptor.hpp"
#include "tools/proleg/ui/parameter_edits.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

/// Tasks that other threads give to a thread that waits for descriptors.
class TaskQueue {
 public:
  /// Throws std::system_error if the system has no descriptors left.
  TaskQueue();

  /// Posts a task, from any thread.
  void post(std::function<void()> task);
  /// Can be read when there are tasks.
  [[nodiscard]] int descriptor() const { return event_.number(); }
  /// Carries the tasks out in their order. If one throws, the later ones wait for the next call.
  void run();

 private:
  host::Descriptor event_;
  std::mutex mutex_;
  std::vector<std::function<void()>> tasks_;
};

class RemoteSession final : public host::RobotSession, public host::SessionOutput, private host::RemoteTarget {
 public:
  using MakeDevices = std::function<std::unique_ptr<host::DeviceSource>(host::DeviceListener&)>;

  /// The gamepads of this computer.
  [[nodiscard]] static std::unique_ptr<host::DeviceSource> kernel_devices(host::DeviceListener& listener);
  /// None.
  [[nodiscard]] static std::unique_ptr<host::DeviceSource> no_devices(host::DeviceListener& listener);
  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() { return {"remote.watch"}; }

  /// session: what is controlled. Must outlive this.
  RemoteSession(host::RobotSession& session, host::BindingStore store, MakeDevices make_devices);

  // RobotSession: from viewers, by the server's thread.
  void operate(const host::OperationRequest& request) override;
  void stop(const host::StopRequest& request) override;
  void holder_changed(bool has_holder, bool is_away) override;

  // SessionOutput: from the session.
  void publish(const std::string& document, const nlohmann::json& value) override;
  void set_signals(const host::SignalLayout& layout, std::uint32_t tick_us) override;
  void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) override;
  void answer(host::RequestId request, const nlohmann::json& value) override;
  void refuse(host::RequestId request, const std::string& error) override;
  void stopped(host::RequestId request, unsigned confirmed, unsigned of, double ms) override;
  void notice(host::NoticeLevel level, const std::string& text) override;

 private:
  friend class RemoteThread;
  using Handler = void (RemoteSession::*)(const host::OperationRequest&);

  // RemoteTarget
  void set(const std::vector<std::string>& words, std::uint64_t gesture) override;
  void command(host::RobotCommand command) override;
  void stop(const std::string& by) override;
  [[nodiscard]] std::optional<double> present(const std::string& parameter) const override;
  [[nodiscard]] bool is_running() const override { return is_running_; }

  void run();
  void serve();
  /// From now on only requests of viewers are answered.
  void fail(const std::string& why);
  void wait() const;
  [[nodiscard]] static host::RemoteTime now();
  void receive(const std::string& document, const nlohmann::json& value);
  /// refusal: empty if it was done.
  void own_request_answered(host::RequestId request, const std::string& refusal);
  [[nodiscard]] host::RequestId ask(const std::string& name, const nlohmann::json& arguments);
  void publish_news();

  // The operations: answer, or throw.
  void carry_out(const host::OperationRequest& request);
  void bind(const host::OperationRequest& request);
  void unbind(const host::OperationRequest& request);
  void learn(const host::OperationRequest& request);
  void save(const host::OperationRequest& request);
  void watch(const host::OperationRequest& request);
  [[nodiscard]] std::vector<host::Binding> present_bindings() const;
  [[nodiscard]] std::size_t place_of(const host::OperationRequest& request) const;

  host::RobotSession& session_;
  host::SessionOutput* viewers_ = nullptr;
  MakeDevices make_devices_;

  // The members from here on are used on the thread of the remote control only.
  host::BindingStore store_;
  ParameterWords words_;
  host::RemoteControl remote_{*this};
  std::unique_ptr<host::DeviceSource> devices_;
  bool is_running_ = false;
  std::uint64_t last_request_ = 0;
  std::map<host::RequestId, std::optional<host::RobotCommand>> asked_;  ///< nothing: a set
  host::RemoteTime watched_until_{};
  host::RemoteTime values_due_{};
  std::uint64_t published_revision_ = 0;
  nlohmann::json published_values_;
  bool is_saved_new_ = false;
  bool has_failed_ = false;

  TaskQueue tasks_;
  bool ends_ = false;
};

/// The thread of a remote control, while this object exists. It begins before the session does, which publishes through
/// the remote control, and ends after it.
class RemoteThread {
 public:
  /// viewers: must outlive this.
  RemoteThread(RemoteSession& session, host::SessionOutput& viewers);
  ~RemoteThread();
  RemoteThread(const RemoteThread&) = delete;
  RemoteThread& operator=(const RemoteThread&) = delete;

 private:
  RemoteSession& session_;
  std::thread thread_;
};

}  // namespace proleg::tools
