#include "tools/proleg/ui/change_delivery.hpp"

#include <algorithm>

namespace proleg::tools {

void ChangeDelivery::begin_run() {
  edits_.parameters().begin_run();
  given_.clear();
  for (const ParameterPlace& place : edits_.parameters().places()) {
    given_.push_back(edits_.parameters().at(place).wanted);
  }
  internal_values_.clear();
}

void ChangeDelivery::add(const std::vector<Setting>& internal_values) {
  internal_values_.insert(internal_values_.end(), internal_values.begin(), internal_values.end());
}

std::vector<Setting> ChangeDelivery::next() {
  std::vector<Setting> settings;
  const auto has_room = [&](unsigned joint) {
    return std::ranges::count(settings, joint, &Setting::joint) < static_cast<std::ptrdiff_t>(max_staged_values);
  };
  std::erase_if(internal_values_, [&](const Setting& setting) {
    const bool fits = has_room(setting.joint);
    if (fits) {
      settings.push_back(setting);
    }
    return fits;
  });
  const ParameterTable& table = edits_.parameters();
  const std::vector<ParameterPlace>& places = table.places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::int32_t wanted = table.at(places[i]).wanted;
    if (wanted != given_[i] && has_room(places[i].joint)) {
      settings.push_back(setting_of(places[i], wanted));
      given_[i] = wanted;
    }
  }
  return settings;
}

void ChangeDelivery::confirm(const Change& change) {
  ParameterTable& table = edits_.parameters();
  const std::vector<ParameterPlace>& places = table.places();
  for (const Setting& setting : change.settings) {
    if (setting.internal) {
      continue;
    }
    const ParameterPlace place = place_of(setting);
    table.confirm(place, setting.value, change.tick);
    const auto at = static_cast<std::size_t>(std::ranges::find(places, place) - places.begin());
    if (table.at(place).wanted == given_[at]) {
      table.want(place, setting.value);  // a change of the file
      given_[at] = setting.value;
    }
  }
}

void ChangeDelivery::give_up() {
  ParameterTable& table = edits_.parameters();
  const std::vector<ParameterPlace>& places = table.places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::int32_t confirmed = table.at(places[i]).confirmed;
    if (given_[i] != confirmed) {
      given_[i] = confirmed;
      table.want(places[i], confirmed);
    }
  }
}

}  // namespace proleg::tools
