#include "host/remote/remote_control.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "host/remote/binding.hpp"

namespace proleg::host {
namespace {

/// Number of the first gesture of a remote control; gestures of pages have smaller numbers.
constexpr std::uint64_t first_gesture = std::uint64_t{1} << 40U;

/// The setting in the form of --set, which takes decimal text without an exponent.
std::string set_argument(const std::string& parameter, double value) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.9f", value);
  std::string number = text.data();
  number.erase(number.find_last_not_of('0') + 1);
  if (number.back() == '.') {
    number.pop_back();
  }
  return parameter + '=' + (number == "-0" ? "0" : number);
}

}  // namespace

void ParameterChanges::want(RemoteTime now, const ParameterMotion::Value& value) {
  if (!wanted_at_ || now - *wanted_at_ >= gesture_pause) {
    gesture_ = std::max(gesture_ + 1, first_gesture);
  }
  wanted_at_ = now;
  pending_[value.parameter] = value.value;
}

RemoteTime ParameterChanges::next_set() const {
  const RemoteTime paced = sent_at_ ? *sent_at_ + shortest_period : RemoteTime::min();
  return sent_unanswered_ ? std::max(paced, *sent_unanswered_ + answer_timeout) : paced;
}

std::optional<RemoteTime> ParameterChanges::due() const {
  return pending_.empty() ? std::nullopt : std::optional(next_set());
}

void ParameterChanges::advance(RemoteTime now) {
  if (pending_.empty() || now < next_set()) {
    return;
  }
  std::vector<std::string> words;
  words.reserve(pending_.size());
  for (const auto& [parameter, value] : pending_) {
    words.push_back(set_argument(parameter, value));
  }
  pending_.clear();
  sent_at_ = sent_unanswered_ = now;
  target_.set(words, gesture_);
}

bool ElementLearning::is_moved(const ElementPlace& element, double position) {
  const auto [start, is_new] = starts_.try_emplace(element, position);
  return !is_new && std::abs(position - start->second) >= clear_movement;
}

bool RemoteControl::is_of(const Binding& binding, const InputDevice& device, const Element& element) {
  return binding.element == element.name && binding.device == device.name;
}

void RemoteControl::advance(RemoteTime now) {
  now_ = now;
  buttons_.advance(now);
  changes_.advance(now);
  if (learning_ && now >= learning_->ends()) {
    end_learning();
  }
}

std::optional<RemoteTime> RemoteControl::due() const {
  std::optional<RemoteTime> due;
  for (const std::optional<RemoteTime>& time :
       {buttons_.due(), changes_.due(), learning_ ? std::optional(learning_->ends()) : std::nullopt}) {
    if (time && (!due || *time < *due)) {
      due = time;
    }
  }
  return due;
}

void RemoteControl::plugged(const InputDevice& device) {
  devices_[device.id] = device;
  for (std::size_t i = 0; i < device.elements.size(); ++i) {
    if (is_pressed(device.positions[i], false)) {
      pressed_.insert({device.id, i});
    }
  }
  place_motions(device);
  ++revision_;
}

/// The position of an element when its device is plugged in, or when it is bound, has no effect.
void RemoteControl::place_motions(const InputDevice& device) {
  for (std::size_t i = 0; i < device.elements.size(); ++i) {
    if (learning_) {
      learning_->place({device.id, i}, device.positions[i]);
    }
    for (Bound& bound : bindings_) {
      const auto* const target = std::get_if<ParameterBinding>(&bound.binding.target);
      if (target != nullptr && is_of(bound.binding, device, device.elements[i])) {
        bound.motion.emplace(*target, device.elements[i].kind);
        bound.motion->place(device.positions[i]);
      }
    }
  }
}

void RemoteControl::moved(const ElementPlace& place, double position) {
  InputDevice& device = devices_.at(place.first);
  const double before = std::exchange(device.positions.at(place.second), position);
  if (before == position) {
    return;
  }
  const Element& element = device.elements[place.second];

  const bool was_pressed = pressed_.contains(place);
  const bool is_press = is_pressed(position, was_pressed);
  if (is_press) {
    pressed_.insert(place);
  } else {
    pressed_.erase(place);
  }
  for (Bound& bound : bindings_) {
    if (!is_of(bound.binding, device, element)) {
      continue;
    }
    if (const auto* const action = std::get_if<RemoteAction>(&bound.binding.target)) {
      if (is_press != was_pressed) {
        act(*action, device, place, is_press);
      }
    } else {
      move(bound, element.kind, position);
    }
  }
  if (learning_ && learning_->is_moved(place, position)) {
    finish_learning(Learned{device.name, element});
  }
}

void RemoteControl::move(Bound& bound, ElementKind kind, double position) {
  if (!bound.motion) {
    bound.motion.emplace(std::get<ParameterBinding>(bound.binding.target), kind);
  }
  if (!is_allowed_ || learning_) {
    bound.motion->place(position);
    return;
  }
  const bool begins = !bound.moved_at || now_ - *bound.moved_at >= ParameterChanges::gesture_pause;
  bound.moved_at = now_;
  for (const ParameterMotion::Value& value : bound.motion->move(position, begins, target_)) {
    changes_.want(now_, value);
  }
}

void RemoteControl::act(RemoteAction action, const InputDevice& device, const ElementPlace& place, bool is_press) {
  if (!is_press) {
    buttons_.release(now_, place);
  } else if (!learning_ || action == RemoteAction::stop) {
    buttons_.press(action, place, device.name);
  }
}

void RemoteControl::unplugged(DeviceId id) {
  const auto device = devices_.find(id);
  if (device == devices_.end()) {
    return;
  }
  buttons_.release_device(now_, id);
  changes_.clear();
  for (Bound& bound : bindings_) {
    if (bound.motion && bound.binding.device == device->second.name) {
      bound.motion->let_go();
    }
  }
  std::erase_if(pressed_, [id](const ElementPlace& place) { return place.first == id; });
  devices_.erase(device);
  ++revision_;
}

void RemoteControl::problems_changed(const std::vector<std::string>& problems) {
  device_problems_ = problems;
  ++revision_;
}

void RemoteControl::set_allowed(bool is_allowed) {
  if (is_allowed == is_allowed_) {
    return;
  }
  is_allowed_ = is_allowed;
  buttons_.set_allowed(now_, is_allowed);
  changes_.clear();
  for (Bound& bound : bindings_) {
    if (bound.motion) {
      bound.motion->let_go();
    }
  }
  if (!is_allowed) {
    end_learning();
  }
  ++revision_;
}

void RemoteControl::set_answered(const std::string& refusal) {
  changes_.answered();
  if (refusal != refusal_) {
    refusal_ = refusal;
    ++revision_;
  }
}

void RemoteControl::set_bindings(std::vector<Binding> bindings) {
  buttons_.release_all(now_);
  changes_.clear();
  bindings_.clear();
  for (Binding& binding : bindings) {
    bindings_.push_back({std::move(binding), std::nullopt, std::nullopt});
  }
  for (const auto& [id, device] : devices_) {
    place_motions(device);
  }
  ++revision_;
}

void RemoteControl::learn(LearnedFunction function) {
  end_learning();
  buttons_.release_all(now_);
  learning_.emplace(now_);
  learned_ = std::move(function);
  for (const auto& [id, device] : devices_) {
    place_motions(device);
  }
  ++revision_;
}

void RemoteControl::finish_learning(const std::optional<Learned>& learned) {
  if (!learning_) {
    return;
  }
  learning_.reset();
  ++revision_;
  // The function may start learning again.
  std::exchange(learned_, nullptr)(learned);
}

std::vector<std::string> RemoteControl::problems() const {
  std::vector<std::string> problems = device_problems_;
  if (!refusal_.empty()) {
    problems.push_back(refusal_);
  }
  return problems;
}

using nlohmann::json;

json remote_document(const RemoteControl& remote) {
  json devices = json::array();
  for (const auto& [id, device] : remote.devices()) {
    json elements = json::array();
    for (const Element& element : device.elements) {
      elements.push_back({{"name", element.name}, {"kind", element.kind == ElementKind::axis ? "axis" : "button"}});
    }
    devices.push_back({{"id", id}, {"name", device.name}, {"elements", std::move(elements)}});
  }
  json bindings = json::array();
  for (const RemoteControl::Bound& bound : remote.bindings()) {
    bindings.push_back(binding_json(bound.binding));
  }
  return {{"devices", std::move(devices)},
          {"bindings", std::move(bindings)},
          {"problems", remote.problems()},
          {"learning", remote.is_learning()},
          {"active", remote.is_allowed()}};
}

json remote_values_document(const RemoteControl& remote) {
  json devices = json::array();
  for (const auto& [id, device] : remote.devices()) {
    devices.push_back({{"id", id}, {"positions", device.positions}});
  }
  json bindings = json::array();
  for (const RemoteControl::Bound& bound : remote.bindings()) {
    const bool has_value = bound.motion && bound.motion->value();
    bindings.push_back(has_value ? json{{"value", *bound.motion->value()}, {"taken", bound.motion->taken()}} : json());
  }
  return {{"devices", std::move(devices)}, {"bindings", std::move(bindings)}};
}

}  // namespace proleg::host
