#include "sim/urdf/urdf_values.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr double largest = 1e12;
constexpr std::string_view xacro_hint = "plain URDF: run 'xacro FILE >ROBOT.urdf' first, and import ROBOT.urdf";

/// An attribute with numbers.
struct NumberAttribute {
  std::string_view element;
  std::string_view attribute;
  std::size_t count;
  Range range;
};

constexpr Range colours{0.0, 1.0, ""};
constexpr Range angles{-1e4, 1e4, "rad"};
constexpr Range sizes{1e-6, 1e4, "m"};
constexpr Range efforts{0.0, 1e6, "Nm"};
constexpr Range velocities{0.0, 1e6, "rad/s"};
constexpr Range inertia_moments{-largest, largest, "kg m^2"};
constexpr Range any{-largest, largest, ""};

constexpr std::array number_attributes{NumberAttribute{"origin", "xyz", 3, coordinates},
                                       NumberAttribute{"origin", "rpy", 3, angles},
                                       NumberAttribute{"axis", "xyz", 3, directions},
                                       NumberAttribute{"box", "size", 3, sizes},
                                       NumberAttribute{"sphere", "radius", 1, sizes},
                                       NumberAttribute{"cylinder", "radius", 1, sizes},
                                       NumberAttribute{"cylinder", "length", 1, sizes},
                                       NumberAttribute{"mesh", "scale", 3, any},
                                       NumberAttribute{"inertia", "ixx", 1, inertia_moments},
                                       NumberAttribute{"inertia", "ixy", 1, inertia_moments},
                                       NumberAttribute{"inertia", "ixz", 1, inertia_moments},
                                       NumberAttribute{"inertia", "iyy", 1, inertia_moments},
                                       NumberAttribute{"inertia", "iyz", 1, inertia_moments},
                                       NumberAttribute{"inertia", "izz", 1, inertia_moments},
                                       NumberAttribute{"mass", "value", 1, any},
                                       NumberAttribute{"limit", "lower", 1, angles},
                                       NumberAttribute{"limit", "upper", 1, angles},
                                       NumberAttribute{"limit", "effort", 1, efforts},
                                       NumberAttribute{"limit", "velocity", 1, velocities},
                                       NumberAttribute{"color", "rgba", 4, colours},
                                       NumberAttribute{"dynamics", "damping", 1, any},
                                       NumberAttribute{"dynamics", "friction", 1, any}};

void check_numbers(const XmlElement& element, const NumberAttribute& known) {
  const std::optional<std::string> text = element.attribute(known.attribute);
  if (!text) {
    return;
  }
  const std::vector<std::string_view> parts = words(*text);
  const bool is_good = parts.size() == known.count && std::ranges::all_of(parts, [&](std::string_view word) {
                         return parse_number_in(word, known.range).has_value();
                       });
  if (!is_good) {
    std::string expected = known.count == 1 ? "a number" : std::to_string(known.count) + " numbers";
    if (known.range.max < largest) {
      expected += " from " + number_text(known.range.min) + " to " + number_text(known.range.max);
      expected += known.range.unit.empty() ? "" : " " + std::string(known.range.unit);
    }
    element.refuse(std::string(known.attribute) + "=" + in_quotes(*text) + " in " + element.label(), expected);
  }
}

}  // namespace

void check_urdf_values(const XmlElement& element) {
  if (lower_case(element.label()).starts_with("<xacro:")) {
    element.refuse(element.label(), std::string(xacro_hint));
  }
  for (const std::string_view attribute :
       {"name", "type", "link", "xyz", "rpy", "size", "radius", "length", "value", "filename", "lower", "upper",
        "effort", "velocity", "ixx", "scale", "rgba"}) {
    const std::optional<std::string> text = element.attribute(attribute);
    if (text && (text->find("${") != std::string::npos || text->find("$(") != std::string::npos)) {
      element.refuse("the expression " + in_quotes(*text) + " in " + element.label(), std::string(xacro_hint));
    }
  }
  for (const NumberAttribute& known : number_attributes) {
    if (element.is(known.element)) {
      check_numbers(element, known);
    }
  }
  for (const XmlElement& child : element.children()) {
    check_urdf_values(child);
  }
}

void require_urdf_sizes(const XmlElement& shape) {
  for (const NumberAttribute& known : number_attributes) {
    if (shape.is(known.element) && known.attribute != "scale") {  // without it a mesh has its own size
      static_cast<void>(shape.required_attribute(known.attribute));
    }
  }
}

}  // namespace proleg::sim
