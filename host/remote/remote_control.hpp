#pragma once

// Input devices, and the bindings of their elements. All calls come from one thread; the time is an argument.

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/remote/binding.hpp"
#include "host/remote/bound_elements.hpp"
#include "host/remote/device_listener.hpp"

namespace proleg::host {

/// Sends changes of parameters to the robot: at most 50 a second, one at a time, each with the newest values, so that
/// no old changes queue up for a robot that answers slowly.
class ParameterChanges {
 public:
  static constexpr RemoteTime shortest_period{20};
  /// A pause of this length ends a gesture; a later movement is another entry for undo.
  static constexpr RemoteTime gesture_pause{500};
  /// After this time an answer is no longer expected.
  static constexpr RemoteTime answer_timeout{1000};

  explicit ParameterChanges(RemoteTarget& target) : target_(target) {}

  void want(RemoteTime now, const ParameterMotion::Value& value);
  /// Forgets changes that have not been sent.
  void clear() { pending_.clear(); }
  void answered() { sent_unanswered_.reset(); }
  void advance(RemoteTime now);
  /// Time at which advance() has something to do; nothing if it has nothing to do before the next change.
  [[nodiscard]] std::optional<RemoteTime> due() const;

 private:
  [[nodiscard]] RemoteTime next_set() const;

  RemoteTarget& target_;
  std::map<std::string, double> pending_;
  std::optional<RemoteTime> wanted_at_;
  std::optional<RemoteTime> sent_at_;
  std::optional<RemoteTime> sent_unanswered_;
  std::uint64_t gesture_ = 0;
};

/// Finds, once, the element that a person moves clearly after the request to do so.
class ElementLearning {
 public:
  static constexpr RemoteTime time_limit{10'000};
  /// Movement that counts as clear: half of the way from the middle to an end. A stick that trembles moves less.
  static constexpr double clear_movement = 0.5;

  explicit ElementLearning(RemoteTime now) : ends_(now + time_limit) {}

  /// Stores the position of an element when it is first seen after the request.
  void place(const ElementPlace& element, double position) { starts_.try_emplace(element, position); }
  /// Whether this element has moved clearly, and so is the one that was looked for.
  [[nodiscard]] bool is_moved(const ElementPlace& element, double position);
  [[nodiscard]] RemoteTime ends() const { return ends_; }

 private:
  RemoteTime ends_;
  std::map<ElementPlace, double> starts_;
};

class RemoteControl final : public DeviceListener {
 public:
  struct Learned {
    std::string device;
    Element element;
  };
  /// Receives the element that has moved clearly; nothing if none has moved in time, or learning was ended.
  using LearnedFunction = std::function<void(const std::optional<Learned>&)>;

  struct Bound {
    Binding binding;
    std::optional<ParameterMotion> motion;  ///< exists for a binding to parameters whose element has been seen
    std::optional<RemoteTime> moved_at;
  };

  /// target: must outlive this.
  explicit RemoteControl(RemoteTarget& target) : target_(target), buttons_(target), changes_(target) {}

  /// Sets the time of all later events. Sends changes that are due.
  void advance(RemoteTime now);
  /// The latest time at which advance() must be called.
  [[nodiscard]] std::optional<RemoteTime> due() const;

  // DeviceListener
  void plugged(const InputDevice& device) override;
  void moved(const ElementPlace& place, double position) override;
  void unplugged(DeviceId device) override;
  void problems_changed(const std::vector<std::string>& problems) override;

  /// is_allowed: a viewer drives and is not away; otherwise only `stop` has an effect.
  void set_allowed(bool is_allowed);
  /// is_required: the robot is real, and only hold-to-run may run it.
  void require_hold(bool is_required) { buttons_.require_hold(is_required); }
  /// Notes that the robot was stopped, perhaps by this remote control.
  void robot_stopped() { buttons_.robot_stopped(); }
  /// Receives the answer to RemoteTarget::set(). refusal: empty if the values were set.
  void set_answered(const std::string& refusal);
  void command_answered(RobotCommand command, bool is_ok) { buttons_.command_answered(command, is_ok); }

  void set_bindings(std::vector<Binding> bindings);
  /// Calls the function once with the element that moves next. Elements have no other effect until then, except
  /// `stop`. An earlier learning ends.
  void learn(LearnedFunction function);
  void end_learning() { finish_learning(std::nullopt); }

  [[nodiscard]] const std::map<DeviceId, InputDevice>& devices() const { return devices_; }
  [[nodiscard]] const std::vector<Bound>& bindings() const { return bindings_; }
  [[nodiscard]] std::vector<std::string> problems() const;
  [[nodiscard]] bool is_learning() const { return learning_.has_value(); }
  [[nodiscard]] bool is_allowed() const { return is_allowed_; }
  /// Counts changes of devices() (without positions), bindings() (without motions), problems(), is_learning() and
  /// is_allowed().
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

 private:
  static bool is_of(const Binding& binding, const InputDevice& device, const Element& element);
  void place_motions(const InputDevice& device);
  void move(Bound& bound, ElementKind kind, double position);
  /// Performs the action of an element that is pressed or released.
  void act(RemoteAction action, const InputDevice& device, const ElementPlace& place, bool is_press);
  void finish_learning(const std::optional<Learned>& learned);

  RemoteTarget& target_;
  RemoteButtons buttons_;
  ParameterChanges changes_;
  RemoteTime now_{};
  bool is_allowed_ = false;
  std::map<DeviceId, InputDevice> devices_;
  std::set<ElementPlace> pressed_;
  std::vector<Bound> bindings_;
  std::optional<ElementLearning> learning_;
  LearnedFunction learned_;
  std::vector<std::string> device_problems_;
  std::string refusal_;
  std::uint64_t revision_ = 1;
};

/// The members `devices`, `bindings`, `problems`, `learning` and `active` of the document `remote`
/// (docs/page-interface.md).
[[nodiscard]] nlohmann::json remote_document(const RemoteControl& remote);

/// The document `remote_values`: positions of elements, and the values that bindings make of them.
[[nodiscard]] nlohmann::json remote_values_document(const RemoteControl& remote);

}  // namespace proleg::host
