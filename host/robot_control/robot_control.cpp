#include "host/robot_control/robot_control.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

struct Kind {
  std::string_view name;
  double min;
  double max;
  std::string_view unit;
};

/// Kinds of information from plug-ins, with the range of plausible values.
constexpr std::array<Kind, 4> kinds{{{"position", -360.0, 360.0, " degrees"},
                                     {"current", -100'000.0, 100'000.0, " mA"},
                                     {"temperature", -100.0, 300.0, " degrees Celsius"},
                                     {"contact", 0.0, 1.0, ""}}};
/// Bound of the values of kinds that only the plug-in defines; they must be finite.
constexpr double max_number = std::numeric_limits<double>::max();

std::uint32_t microseconds(std::chrono::milliseconds time) {
  return static_cast<std::uint32_t>(std::chrono::microseconds(time).count());
}

/// The text of a plug-in, which need not end with a zero byte.
std::string bounded_text(const char* text, std::size_t size) { return {text, strnlen(text, size)}; }

}  // namespace

struct CallThread::Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::function<void()> call;  ///< the next call, or the one that runs
  bool is_running = false;
  bool must_end = false;
};

CallThread::CallThread() : shared_(std::make_shared<Shared>()) {
  std::thread([shared = shared_] {
    std::unique_lock lock(shared->mutex);
    for (;;) {
      shared->changed.wait(lock, [&] { return shared->call || shared->must_end; });
      if (!shared->call) {
        return;
      }
      lock.unlock();
      shared->call();
      lock.lock();
      shared->call = nullptr;  // objects that the call owns are destroyed here, in this thread
      shared->is_running = false;
      shared->changed.notify_all();
    }
  }).detach();
}

CallThread::~CallThread() {
  const std::lock_guard lock(shared_->mutex);
  shared_->must_end = true;
  shared_->changed.notify_all();
}

bool CallThread::run(std::function<void()> call, std::chrono::microseconds timeout) {
  if (is_lost_) {
    return false;
  }
  std::unique_lock lock(shared_->mutex);
  shared_->call = std::move(call);
  shared_->is_running = true;
  shared_->changed.notify_all();
  is_lost_ = !shared_->changed.wait_for(lock, timeout, [&] { return !shared_->is_running; });
  return !is_lost_;
}

/// Objects that the plug-in may use. They live as long as a call that did not return.
struct RobotControl::Session {
  Plugin plugin;
  RobotControlSetup setup;
  Show show;
  proleg_robot* robot = nullptr;

  static void show_line(void* context, const char* line) {
    const auto& session = *static_cast<const Session*>(context);
    if (line != nullptr && session.show) {
      session.show(one_line(session.plugin.name + ": " + line));
    }
  }
};

/// Results of a call. The host reads them when the call has returned.
struct RobotControl::Call {
  int result = PROLEG_FAILED;
  proleg_error error{};
  std::uint32_t count = 0;
  std::vector<double> values{};
  std::vector<std::uint8_t> bytes{};
  std::string text{};
  proleg_description description{};
};

RobotControl::RobotControl(Plugin plugin, RobotControlSetup setup, Show show, Patience patience)
    : patience_(patience), session_(std::make_shared<Session>()) {
  session_->plugin = std::move(plugin);
  session_->setup = std::move(setup);
  session_->show = std::move(show);
  open();
  try {
    describe();
  } catch (const RobotControlError&) {
    static_cast<void>(try_call(patience_.request, std::make_shared<Call>(), [](Session& session, Call&) {
      session.plugin.functions->close(session.robot);
      return PROLEG_OK;
    }));
    throw;
  }
}

RobotControl::~RobotControl() {
  static_cast<void>(try_call(patience_.request, std::make_shared<Call>(),
                             [timeout_us = microseconds(patience_.request)](Session& session, Call&) {
                               session.plugin.functions->disconnect(session.robot, timeout_us);
                               session.plugin.functions->close(session.robot);
                               return PROLEG_OK;
                             }));
}

const std::string& RobotControl::name() const { return session_->plugin.name; }
const RobotControlSetup& RobotControl::setup() const { return session_->setup; }

void RobotControl::fail(const std::string& text) const {
  throw RobotControlError("plug-in " + in_quotes(name()) + ": " + text);
}

bool RobotControl::try_call(std::chrono::milliseconds timeout, const std::shared_ptr<Call>& call,
                            const std::function<int(Session&, Call&)>& function) {
  return thread_.run([session = session_, call, function] { call->result = function(*session, *call); },
                     timeout + patience_.grace);
}

void RobotControl::call(const std::string& what, std::chrono::milliseconds timeout,
                        const std::function<int(Session&, Call&)>& function) {
  const auto call = std::make_shared<Call>();
  if (!try_call(timeout, call, function)) {
    fail("did not return from " + what + " within " + std::to_string((timeout + patience_.grace).count()) +
         " ms, expected an end in " + std::to_string(timeout.count()) +
         " ms; it is not called again: switch the robot off, then report this to the author of the plug-in");
  }
  if (call->result == PROLEG_UNSUPPORTED) {
    fail("does not support " + what);
  }
  if (call->result != PROLEG_OK) {
    const std::string text = bounded_text(call->error.text, sizeof call->error.text);
    fail(text.empty() ? what + " failed without a reason" : text);
  }
}

void RobotControl::open() {
  const auto call = std::make_shared<Call>();
  const bool has_returned = try_call(patience_.request, call, [](Session& session, Call& made) {
    std::vector<proleg_joint> joints;
    for (const RobotControlJoint& joint : session.setup.joints) {
      joints.push_back({joint.name.c_str(), joint.lower_limit_deg, joint.upper_limit_deg, joint.max_speed_deg_s});
    }
    std::vector<proleg_parameter> parameters;
    for (const RobotControlParameter& parameter : session.setup.parameters) {
      parameters.push_back({parameter.name.c_str(), parameter.value.c_str(), parameter.joint, parameter.line});
    }
    const proleg_setup setup{sizeof(proleg_setup),
                             session.setup.tick_us,
                             static_cast<std::uint32_t>(joints.size()),
                             static_cast<std::uint32_t>(parameters.size()),
                             joints.data(),
                             parameters.data(),
                             &Session::show_line,
                             &session};
    return session.plugin.functions->open(&setup, &session.robot, &made.error);
  });
  if (!has_returned) {
    fail("did not return from open; report this to the author of the plug-in");
  }
  if (call->result != PROLEG_OK) {
    const std::string text = bounded_text(call->error.text, sizeof call->error.text);
    const int line = call->error.line != 0 ? static_cast<int>(call->error.line) : session_->setup.line;
    throw RobotFileError(session_->setup.file + ":" + std::to_string(line) + ": " +
                         (text.empty() ? "found parameters that the plug-in rejects without a reason" : text) +
                         " (plug-in " + in_quotes(name()) + ")");
  }
  if (session_->robot == nullptr) {
    fail("opened no robot; report this to the author of the plug-in");
  }
}

void RobotControl::describe() {
  const auto call = std::make_shared<Call>();
  call->description.size = sizeof(proleg_description);
  if (!try_call(patience_.request, call, [](Session& session, Call& made) {
        return session.plugin.functions->describe(session.robot, &made.description, &made.error);
      })) {
    fail("did not return from describe; report this to the author of the plug-in");
  }
  if (call->result != PROLEG_OK) {
    fail("describe failed: " + bounded_text(call->error.text, sizeof call->error.text));
  }
  const proleg_description& found = call->description;
  const auto& joints = session_->setup.joints;
  if (found.joint_count != joints.size()) {
    fail("found a robot with " + std::to_string(found.joint_count) + " joints, expected the " +
         std::to_string(joints.size()) + " of " + session_->setup.file + "; correct the file or its parameters");
  }
  const bool has_no_sensors = found.sensor_module_count == 0 && found.sensors_per_module == 0;
  const bool has_links_with_sensors = found.sensor_module_count == joints.size() + 1 && found.sensors_per_module == 2;
  if (!has_no_sensors && !has_links_with_sensors) {
    fail("found " + std::to_string(found.sensor_module_count) + " sensor modules with " +
         std::to_string(found.sensors_per_module) + " sensors, expected none, or " + std::to_string(joints.size() + 1) +
         " with 2");
  }
  description_.sensor_modules = found.sensor_module_count;
  description_.sensors_per_module = found.sensors_per_module;
  description_.topology = shortened(one_line(bounded_text(found.topology, sizeof found.topology)));
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    const double lower = found.lower_limit_deg[joint];
    const double upper = found.upper_limit_deg[joint];
    if (!(lower >= -360.0 && lower <= 0.0 && upper >= 0.0 && upper <= 360.0)) {
      fail("found the limits " + number_text(lower) + " and " + number_text(upper) + " degrees for joint " +
           in_quotes(joints[joint].name) + ", expected -360 to 0 and 0 to 360");
    }
    description_.lower_limit_deg.push_back(lower);
    description_.upper_limit_deg.push_back(upper);
  }
}

void RobotControl::connect() {
  call("connect", patience_.connect, [timeout_us = microseconds(patience_.connect)](Session& session, Call& made) {
    return session.plugin.functions->connect(session.robot, timeout_us, &made.error);
  });
}

void RobotControl::disconnect() {
  call("disconnect", patience_.request, [timeout_us = microseconds(patience_.request)](Session& session, Call&) {
    session.plugin.functions->disconnect(session.robot, timeout_us);
    return PROLEG_OK;
  });
}

void RobotControl::enable_servos(bool on) {
  call("enable_servos", patience_.request,
       [on, timeout_us = microseconds(patience_.request)](Session& session, Call& made) {
         return session.plugin.functions->enable_servos(session.robot, on ? 1 : 0, timeout_us, &made.error);
       });
}

void RobotControl::send_command(const std::string& command, std::span<const double> values, std::uint32_t destination) {
  call("the command " + in_quotes(command), patience_.request,
       [command, destination, sent = std::vector<double>(values.begin(), values.end()),
        timeout_us = microseconds(patience_.request)](Session& session, Call& made) {
         return session.plugin.functions->send_command(session.robot, command.c_str(), sent.data(),
                                                       static_cast<std::uint32_t>(sent.size()), destination, timeout_us,
                                                       &made.error);
       });
}

void RobotControl::send_command_by_value(const std::string& command, double value) {
  call("the command " + in_quotes(command), patience_.request,
       [command, value, timeout_us = microseconds(patience_.request)](Session& session, Call& made) {
         return session.plugin.functions->send_command_by_value(session.robot, command.c_str(), value, timeout_us,
                                                                &made.error);
       });
}

std::vector<std::uint8_t> RobotControl::request_all_information() {
  constexpr std::size_t capacity = 65'536;
  std::vector<std::uint8_t> bytes;
  std::uint32_t count = 0;
  const auto result = std::make_shared<Call>();
  call("request_all_information", patience_.request,
       [result, timeout_us = microseconds(patience_.request)](Session& session, Call& made) {
         result->bytes.resize(capacity);
         return session.plugin.functions->request_all_information(session.robot, result->bytes.data(),
                                                                  static_cast<std::uint32_t>(capacity), &result->count,
                                                                  timeout_us, &made.error);
       });
  count = result->count;
  if (count > capacity) {
    fail("returned " + std::to_string(count) + " bytes of information, expected at most " + std::to_string(capacity));
  }
  bytes = std::move(result->bytes);
  bytes.resize(count);
  return bytes;
}

std::vector<double> RobotControl::request_information(const std::string& kind) {
  const bool is_of_sensors = kind == "contact";
  const std::size_t expected = is_of_sensors
                                   ? std::size_t{description_.sensor_modules} * description_.sensors_per_module
                                   : session_->setup.joints.size();
  const auto result = std::make_shared<Call>();
  call("the information " + in_quotes(kind), patience_.request,
       [kind, expected, result, timeout_us = microseconds(patience_.request)](Session& session, Call& made) {
         result->values.assign(expected, std::nan(""));
         return session.plugin.functions->request_information(session.robot, kind.c_str(), result->values.data(),
                                                              static_cast<std::uint32_t>(expected), &result->count,
                                                              timeout_us, &made.error);
       });
  if (result->count != expected) {
    fail("returned " + std::to_string(result->count) + " values of " + in_quotes(kind) + ", expected " +
         std::to_string(expected) + (is_of_sensors ? ", one for each sensor" : ", one for each joint"));
  }
  const auto range = std::ranges::find(kinds, kind, &Kind::name);
  const Kind allowed = range != kinds.end() ? *range : Kind{kind, -max_number, max_number, ""};
  for (std::size_t i = 0; i < expected; ++i) {
    const double value = result->values[i];
    if (!(value >= allowed.min && value <= allowed.max)) {
      const std::string part =
          is_of_sensors ? "sensor " + std::to_string(i) : "joint " + in_quotes(session_->setup.joints[i].name);
      std::string text = "returned " + number_text(value) + " as " + kind;
      text += " of " + part + ", expected " + number_text(allowed.min) + " to " + number_text(allowed.max);
      text += allowed.unit;
      fail(text);
    }
  }
  return std::move(result->values);
}

void RobotControl::test() {
  call("test", patience_.request, [timeout_us = microseconds(patience_.request)](Session& session, Call& made) {
    return session.plugin.functions->test(session.robot, timeout_us, &made.error);
  });
}

void RobotControl::reset_command_buffer() {
  call("reset_command_buffer", patience_.request, [](Session& session, Call& made) {
    return session.plugin.functions->reset_command_buffer(session.robot, &made.error);
  });
}

}  // namespace proleg::host
