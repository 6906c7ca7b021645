#include "host/remote/remote_document.hpp"

#include "host/remote/binding_file.hpp"

namespace proleg::host {

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
