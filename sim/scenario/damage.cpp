#include "sim/scenario/damage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr const char* damage_option = "--damage";
constexpr Range jam_angles{-90.0, 90.0, "deg"};
constexpr Range torque_shares{1.0, 100.0, "%"};
constexpr Range physical_shares{1.0, 1000.0, "%"};

/// Of the greatest torque of the robot: what holds a jammed joint.
constexpr double jam_strength = 10.0;
/// Of the servo's own torque, which must be above 0.
constexpr double no_power = 1e-6;

/// Of the damages that a robot may have.
constexpr std::array<int, 3> usual_jams{-20, 0, 20};  // degrees
constexpr const char* usual_percent = "50%";

struct DamageKind {
  std::string_view kind;
  std::string_view place;  ///< "JOINT", "LINK"; empty: none
  std::string_view value;  ///< "=PERCENT"; empty: none
  Range range;
};

constexpr std::array<DamageKind, 6> damage_kinds{{{"jammed", "JOINT", "[=DEGREES]", jam_angles},
                                                  {"torque", "JOINT", "=PERCENT", torque_shares},
                                                  {"powerless", "JOINT", "", {}},
                                                  {"lost", "JOINT", "", {}},
                                                  {"mass", "LINK", "=PERCENT", physical_shares},
                                                  {"friction", "", "=PERCENT", physical_shares}}};

std::string form_of(const DamageKind& form) {
  return std::string(form.kind) + (form.place.empty() ? "" : ":") + std::string(form.place) + std::string(form.value);
}

struct Damage {
  std::string_view kind;
  std::size_t place = 0;  ///< joint or link
  std::optional<double> value;
};

std::size_t find_damaged_link(const RobotModel& robot, const std::string& name) {
  const auto link = std::ranges::find(robot.links, name, &Link::name);
  if (link == robot.links.end()) {
    std::vector<std::string> names;
    std::ranges::transform(robot.links, std::back_inserter(names), &Link::name);
    throw InputError(damage_option, 0, "unknown link " + in_quotes(name), "one of " + listed(names));
  }
  return static_cast<std::size_t>(link - robot.links.begin());
}

std::size_t find_damaged_joint(const RobotModel& robot, const std::string& name) {
  const int joint = find_joint(robot, name);
  if (joint < 0) {
    throw InputError(damage_option, 0, "unknown joint " + in_quotes(name), "one of " + listed(joint_names(robot)));
  }
  return static_cast<std::size_t>(joint);
}

Damage read_damage(const RobotModel& robot, const std::string& word) {
  const std::size_t equals = std::min(word.find('='), word.size());
  const std::string head = word.substr(0, equals);
  const std::size_t colon = std::min(head.find(':'), head.size());
  const auto form = std::ranges::find(damage_kinds, std::string_view(head).substr(0, colon), &DamageKind::kind);
  if (form == damage_kinds.end()) {
    throw InputError(damage_option, 0, in_quotes(word), "one of " + damage_forms());
  }
  const bool has_value = equals < word.size();
  const bool is_optional = form->value.starts_with('[');
  const auto refuse = [&] {
    const std::string range =
        form->value.empty() ? ""
                            : ", a number from " + number_text(form->range.min) + " to " + number_text(form->range.max);
    throw InputError(damage_option, 0, in_quotes(word), form_of(*form) + range);
  };
  if ((colon < head.size()) == form->place.empty() ||
      (has_value ? form->value.empty() : !form->value.empty() && !is_optional)) {
    refuse();
  }
  Damage damage{form->kind, 0, {}};
  if (has_value) {
    std::string_view number = std::string_view(word).substr(equals + 1);
    number.remove_suffix(form->range.unit == "%" && number.ends_with('%') ? 1 : 0);
    damage.value = parse_number_in(number, form->range);
    if (!damage.value) {
      refuse();
    }
  }
  if (!form->place.empty()) {
    const std::string name = head.substr(colon + 1);
    damage.place = form->place == "LINK" ? find_damaged_link(robot, name) : find_damaged_joint(robot, name);
  }
  return damage;
}

std::int32_t raw_angle_of(double degrees) { return static_cast<std::int32_t>(std::lround(degrees / 90.0 * (1 << 30))); }

bool can_have(const AngleLimits& limits, double degrees) {
  return raw_angle_of(degrees) >= limits.lower && raw_angle_of(degrees) <= limits.upper;
}

/// strongest: the greatest torque of the robot.
void jam(Scenario& scenario, std::size_t joint, double degrees, double strongest) {
  AngleLimits& limits = scenario.joint_limits[joint];
  if (!can_have(limits, degrees)) {
    throw InputError(damage_option, 0, number_text(degrees) + " degrees for " + scenario.robot.joints[joint].name,
                     "an angle within the limits of the joint");
  }
  limits = {raw_angle_of(degrees), raw_angle_of(degrees)};
  scenario.robot.joints[joint].max_torque = jam_strength * strongest;
}

void scale_geometries(std::vector<Geometry>& geometries, double factor) {
  for (Geometry& geometry : geometries) {
    if (geometry.friction) {
      *geometry.friction *= factor;
    }
    if (geometry.friction_across) {
      *geometry.friction_across *= factor;
    }
  }
}

void apply_one(Scenario& scenario, const Damage& damage, double strongest) {
  RobotModel& robot = scenario.robot;
  if (damage.kind == "jammed") {
    jam(scenario, damage.place, damage.value.value_or(0.0), strongest);
  } else if (damage.kind == "torque") {
    robot.joints[damage.place].max_torque *= *damage.value / 100.0;
  } else if (damage.kind == "powerless" || damage.kind == "lost") {
    robot.joints[damage.place].max_torque *= no_power;
  } else if (damage.kind == "mass") {
    robot.links[damage.place].mass.mass *= *damage.value / 100.0;
    robot.links[damage.place].mass.inertia *= *damage.value / 100.0;
  } else {
    scale_friction(scenario, *damage.value / 100.0);
  }
}

bool is_of_joint(const Damage& damage) { return damage.kind != "mass" && damage.kind != "friction"; }

}  // namespace

void apply_damage(Scenario& scenario, const std::vector<std::string>& words) {
  std::vector<Damage> damages;
  for (const std::string& word : words) {
    const Damage damage = read_damage(scenario.robot, word);
    const bool is_second = std::ranges::any_of(damages, [&](const Damage& other) {
      return is_of_joint(damage) ? is_of_joint(other) && other.place == damage.place
                                 : other.kind == damage.kind && other.place == damage.place;
    });
    if (is_second) {
      throw InputError(damage_option, 0, "a second damage, " + in_quotes(word),
                       "one for each joint, link and the friction");
    }
    damages.push_back(damage);
  }
  const double strongest = std::ranges::max_element(scenario.robot.joints, {}, &Joint::max_torque)->max_torque;
  for (const Damage& damage : damages) {
    apply_one(scenario, damage, strongest);
  }
}

std::string damage_word(const Scenario& scenario, const std::string& word) {
  const RobotModel& robot = scenario.robot;
  const Damage damage = read_damage(robot, word);
  std::string text(damage.kind);
  if (damage.kind != "friction") {
    text += ':' + (is_of_joint(damage) ? robot.joints[damage.place].name : robot.links[damage.place].name);
  }
  if (damage.kind == "jammed") {
    return text + '=' + exact_text(damage.value.value_or(0.0) + 0.0);  // turns -0 into 0
  }
  return damage.value ? text + '=' + exact_text(*damage.value) + '%' : text;
}

std::vector<std::string> usual_damages(const Scenario& scenario) {
  std::vector<std::string> words;
  for (std::size_t joint = 0; joint < scenario.robot.joints.size(); ++joint) {
    const std::string& name = scenario.robot.joints[joint].name;
    if (name.find('=') != std::string::npos) {
      continue;  // no word can name it
    }
    words.push_back("powerless:" + name);
    words.push_back("torque:" + name + "=" + usual_percent);
    for (const int degrees : usual_jams) {
      if (can_have(scenario.joint_limits[joint], degrees)) {
        words.push_back("jammed:" + name + "=" + std::to_string(degrees));
      }
    }
  }
  words.push_back(std::string("friction=") + usual_percent);
  return words;
}

std::string usual_damages_text() {
  std::string angles;
  for (const int degrees : usual_jams) {
    const char* const before = degrees == usual_jams.back() ? " or " : ", ";
    angles += (angles.empty() ? "" : before) + std::to_string(degrees);
  }
  return std::string("each joint without power, with ") + usual_percent + " of its torque, or jammed at " + angles +
         " degrees, and " + usual_percent + " of all friction";
}

Losses losses_of_damage(const Scenario& scenario, const std::vector<std::string>& words) {
  std::vector<Loss> losses;
  for (const std::string& word : words) {
    const Damage damage = read_damage(scenario.robot, word);
    if (damage.kind != "lost") {
      continue;
    }
    for (std::uint32_t tick = 0; tick <= tick_count(scenario); ++tick) {
      for (std::uint8_t channel = 0; channel < max_channels; ++channel) {
        for (std::size_t receiver = 0; receiver < scenario.robot.joints.size(); ++receiver) {
          if (receiver != damage.place) {
            losses.push_back(
                {tick, static_cast<std::uint8_t>(damage.place), channel, static_cast<std::uint8_t>(receiver)});
          }
        }
      }
    }
  }
  return Losses(std::move(losses), damage_option);
}

std::string damage_forms() {
  std::string text;
  for (const DamageKind& form : damage_kinds) {
    text += (text.empty() ? "" : ", ") + form_of(form);
  }
  return text;
}

void scale_friction(Scenario& scenario, double factor) {
  scenario.environment.unspecified_friction *= factor;
  for (StaticObject& object : scenario.environment.objects) {
    scale_geometries(object.geometries, factor);
  }
  for (MovingObject& object : scenario.environment.moving_objects) {
    scale_geometries(object.geometries, factor);
  }
  for (Link& link : scenario.robot.links) {
    scale_geometries(link.geometries, factor);
  }
}

}  // namespace proleg::sim
