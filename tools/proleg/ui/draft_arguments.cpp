#include "tools/proleg/ui/draft_arguments.hpp"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

using nlohmann::json;

double number(const json& arguments, const char* name) {
  const auto value = argument<double>(arguments, name, "a number");
  if (!value) {
    throw InputError(name, 0, "none", "a number");
  }
  return *value;
}

std::vector<double> numbers(const json& arguments, const char* name) {
  return argument<std::vector<double>>(arguments, name, "numbers").value_or(std::vector<double>{});
}

Eigen::Vector3d vector(const json& arguments, const char* name) {
  const std::vector<double> values = numbers(arguments, name);
  if (values.size() != 3) {
    throw InputError(name, 0, std::to_string(values.size()) + " numbers", "three numbers");
  }
  return {values[0], values[1], values[2]};
}

sim::Pose pose(const json& arguments) {
  const std::vector<double> values = numbers(arguments, "pose");
  if (values.size() != 7) {
    throw InputError("pose", 0, std::to_string(values.size()) + " numbers", "x, y, z, and a quaternion w, x, y, z");
  }
  const Eigen::Quaterniond turn(values[3], values[4], values[5], values[6]);
  constexpr double least_norm = 1e-3;
  constexpr double greatest_norm = 1e3;
  if (!(turn.norm() >= least_norm && turn.norm() <= greatest_norm)) {
    throw InputError("pose", 0, "a quaternion of the length " + number_text(turn.norm()), "one of the length 1");
  }
  return {{values[0], values[1], values[2]}, turn.normalized()};
}

std::size_t position_of(const json& arguments, const char* name) {
  const auto position = argument<std::uint32_t>(arguments, name, "a position in the list");
  if (!position) {
    throw InputError(name, 0, "none", "a position in the list");
  }
  return *position;
}

bool is_set(const json& arguments, const char* name) {
  return argument<bool>(arguments, name, "true or false").value_or(false);
}

std::vector<std::size_t> positions(const json& arguments, const char* name) {
  const auto all = argument<std::vector<std::uint32_t>>(arguments, name, "positions in the list");
  return all ? std::vector<std::size_t>(all->begin(), all->end()) : std::vector<std::size_t>{};
}

std::vector<std::size_t> links_from_tail(std::vector<std::size_t> links, const sim::Draft& draft) {
  const std::size_t count = draft.scenario().robot.links.size();
  for (std::size_t& link : links) {
    if (link >= count) {
      throw InputError("link", 0, std::to_string(link), "a number below " + std::to_string(count));
    }
    link = count - 1 - link;
  }
  std::ranges::sort(links);
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

JointMask joints(const json& arguments) {
  JointMask mask;
  for (const std::size_t joint : positions(arguments, "joints")) {
    if (joint >= max_joints) {
      throw InputError("joints", 0, std::to_string(joint), "joints below " + std::to_string(max_joints));
    }
    mask.insert(static_cast<unsigned>(joint));
  }
  return mask;
}

std::string text(const json& arguments, const char* name) {
  return argument<std::string>(arguments, name, "a text").value_or("");
}

}  // namespace proleg::tools
