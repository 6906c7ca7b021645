#include "sim/scenario/overrides.hpp"

#include <numbers>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

double read_in(const char* option, const std::string& word, const Range& range) {
  const std::optional<double> value = parse_number_in(word, range);
  if (!value) {
    throw InputError(option, 0, in_quotes(word),
                     number_text(range.min) + " to " + number_text(range.max) +
                         (range.unit.empty() ? "" : ' ' + std::string(range.unit)));
  }
  return *value;
}

/// X,Y or X,Y,Z
void read_position(const std::string& word, Overrides& overrides) {
  std::vector<double> numbers;
  for (std::string_view rest = word;;) {
    const std::size_t comma = rest.find(',');
    const std::optional<double> number = parse_number_in(rest.substr(0, comma), coordinates);
    if (!number) {
      break;
    }
    numbers.push_back(*number);
    if (comma == std::string_view::npos) {
      if (numbers.size() == 2 || numbers.size() == 3) {
        overrides.at = Eigen::Vector2d(numbers[0], numbers[1]);
        overrides.height = numbers.size() == 3 ? std::optional(numbers[2]) : std::nullopt;
        return;
      }
      break;
    }
    rest.remove_prefix(comma + 1);
  }
  throw InputError("--at", 0, in_quotes(word),
                   "X,Y or X,Y,Z, each " + number_text(coordinates.min) + " to " + number_text(coordinates.max) + " m");
}

PhysicsEngine read_engine(const std::string& word) {
  const std::optional<PhysicsEngine> engine = engine_named(word);
  if (!engine) {
    throw InputError("--engine", 0, in_quotes(word), engine_words());
  }
  return *engine;
}

/// "X,Y" or "X,Y,Z" as read_position reads it; nothing without `at`.
std::optional<std::string> position_text(const Overrides& overrides) {
  if (!overrides.at) {
    return std::nullopt;
  }
  std::string text = exact_text(overrides.at->x()) + ',' + exact_text(overrides.at->y());
  return overrides.height ? text + ',' + exact_text(*overrides.height) : text;
}

}  // namespace

std::span<const OverrideDeclaration> override_declarations() {
  static const std::string engine_help =
      engine_words() +
      ": what computes the motion, instead of the engine of the environment. The reduced engine has chains in a plane "
      "or on a level floor; it is faster and gives the same bits on every machine. MuJoCo is another opinion, if the "
      "program is built with it.";
  static const OverrideDeclaration declarations[] = {
      {"engine", &OverrideWords::engine, true, engine_help},
      {"seed", &OverrideWords::seed, false, "seed of the run instead of that of the scenario"},
      {"friction", &OverrideWords::friction, true,
       "coefficient of friction of every object of the environment, also of those that state none; the links of the "
       "robot keep "
       "theirs"},
      {"at", &OverrideWords::at, true,
       "X,Y or X,Y,Z in metres: start position instead of that of the environment; without Z, the height of the "
       "environment. A robot inside the ground is lifted onto it."},
      {"heading", &OverrideWords::heading, true,
       "degrees by which the start pose is turned about the vertical, to the left. The measures are relative to this "
       "heading."}};
  return declarations;
}

OverrideWords words_of(const Overrides& overrides) {
  OverrideWords words;
  if (overrides.engine) {
    words.engine = std::string(name_of(*overrides.engine));
  }
  if (overrides.seed) {
    words.seed = std::to_string(*overrides.seed);
  }
  if (overrides.friction) {
    words.friction = exact_text(*overrides.friction);
  }
  words.at = position_text(overrides);
  if (overrides.heading_deg) {
    words.heading = exact_text(*overrides.heading_deg);
  }
  return words;
}

Overrides read_overrides(const OverrideWords& words) {
  Overrides overrides;
  if (words.engine) {
    overrides.engine = read_engine(*words.engine);
  }
  if (words.seed) {
    overrides.seed = parse_whole<std::uint64_t>(*words.seed);
    if (!overrides.seed) {
      throw InputError("--seed", 0, in_quotes(*words.seed), "a whole number from 0 to 18446744073709551615");
    }
  }
  if (words.friction) {
    overrides.friction = read_in("--friction", *words.friction, frictions);
  }
  if (words.at) {
    read_position(*words.at, overrides);
  }
  if (words.heading) {
    overrides.heading_deg = read_in("--heading", *words.heading, turns);
  }
  return overrides;
}

void set_friction(EnvironmentModel& environment, double friction) {
  const auto set = [friction](std::vector<Geometry>& geometries) {
    for (Geometry& geometry : geometries) {
      geometry.friction = friction;
    }
  };
  for (StaticObject& object : environment.objects) {
    set(object.geometries);
  }
  for (MovingObject& object : environment.moving_objects) {
    set(object.geometries);
  }
}

void apply_overrides(const Overrides& overrides, EnvironmentModel& environment) {
  environment.engine = overrides.engine.value_or(environment.engine);
  if (overrides.friction) {
    set_friction(environment, *overrides.friction);
  }
  Pose& pose = environment.robot_pose;
  if (overrides.at) {
    pose.position.head<2>() = *overrides.at;
    pose.position.z() = overrides.height.value_or(pose.position.z());
  }
  if (overrides.heading_deg) {
    const double angle = *overrides.heading_deg * (std::numbers::pi / 180.0);
    pose.orientation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * pose.orientation;
  }
}

}  // namespace proleg::sim
