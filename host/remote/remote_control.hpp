#pragma once

// Input devices, and what their elements are bound to. One thread; the time comes as an argument.

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/remote/binding.hpp"
#include "host/remote/device_listener.hpp"
#include "host/remote/element_learning.hpp"
#include "host/remote/parameter_changes.hpp"
#include "host/remote/parameter_motion.hpp"
#include "host/remote/remote_buttons.hpp"
#include "host/remote/remote_target.hpp"

namespace proleg::host {

class RemoteControl final : public DeviceListener {
 public:
  struct Learned {
    std::string device;
    Element element;
  };
  /// Nothing: no element has moved clearly in time, or learning was ended.
  using LearnedFunction = std::function<void(const std::optional<Learned>&)>;

  struct Bound {
    Binding binding;
    std::optional<ParameterMotion> motion;  ///< of a binding to parameters, once its element has been seen
    std::optional<RemoteTime> moved_at;
  };

  /// target: must outlive this.
  explicit RemoteControl(RemoteTarget& target) : target_(target), buttons_(target), changes_(target) {}

  /// What happens from now on happens at this time. Sends what is due.
  void advance(RemoteTime now);
  /// When advance() has something to do at the latest.
  [[nodiscard]] std::optional<RemoteTime> due() const;

  // DeviceListener
  void plugged(const InputDevice& device) override;
  void moved(const ElementPlace& place, double position) override;
  void unplugged(DeviceId device) override;
  void problems_changed(const std::vector<std::string>& problems) override;

  /// Somebody drives, and is not away. Else only `stop` has an effect.
  void set_allowed(bool is_allowed);
  /// The robot is a real one: only hold-to-run may run it.
  void require_hold(bool is_required) { buttons_.require_hold(is_required); }
  /// Somebody, perhaps this remote control, has stopped the robot.
  void robot_stopped() { buttons_.robot_stopped(); }
  /// refusal: empty if the set had its effect.
  void set_answered(const std::string& refusal);
  void command_answered(RobotCommand command, bool is_ok) { buttons_.command_answered(command, is_ok); }

  void set_bindings(std::vector<Binding> bindings);
  /// The element that moves next is told once, and has no other effect until then; `stop` works. An earlier learning
  /// ends.
  void learn(LearnedFunction function);
  void end_learning() { finish_learning(std::nullopt); }

  [[nodiscard]] const std::map<DeviceId, InputDevice>& devices() const { return devices_; }
  [[nodiscard]] const std::vector<Bound>& bindings() const { return bindings_; }
  [[nodiscard]] std::vector<std::string> problems() const;
  [[nodiscard]] bool is_learning() const { return learning_.has_value(); }
  [[nodiscard]] bool is_allowed() const { return is_allowed_; }
  /// Counts what changes devices() but for positions, bindings() but for motions, problems(), is_learning() or
  /// is_allowed().
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// Counts movements.
  [[nodiscard]] std::uint64_t movements() const { return movements_; }

 private:
  static bool is_of(const Binding& binding, const InputDevice& device, const Element& element);
  void place_motions(const InputDevice& device);
  void move(Bound& bound, ElementKind kind, double position);
  /// The element is pressed or released.
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
  std::uint64_t movements_ = 0;
};

}  // namespace proleg::host
