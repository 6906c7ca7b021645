#pragma once

// The arguments of operations of a draft. Each function throws InputError, with the name of the argument, if it is
// missing or of another kind.

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "shared/gait/joint_mask.hpp"
#include "sim/authoring/draft.hpp"
#include "sim/robot/pose.hpp"

namespace proleg::tools {

[[nodiscard]] double number(const nlohmann::json& arguments, const char* name);
/// No numbers if the argument is missing.
[[nodiscard]] std::vector<double> numbers(const nlohmann::json& arguments, const char* name);
[[nodiscard]] Eigen::Vector3d vector(const nlohmann::json& arguments, const char* name);
/// The pose in the argument `pose`: [x, y, z, qw, qx, qy, qz].
[[nodiscard]] sim::Pose pose(const nlohmann::json& arguments);
/// A position in a list.
[[nodiscard]] std::size_t position_of(const nlohmann::json& arguments, const char* name);
/// Positions in a list; none if the argument is missing.
[[nodiscard]] std::vector<std::size_t> positions(const nlohmann::json& arguments, const char* name);
/// The joints in the argument `joints`: numbers in kernel order.
[[nodiscard]] JointMask joints(const nlohmann::json& arguments);
/// Links in kernel order, counted from the tail, ascending and each once.
[[nodiscard]] std::vector<std::size_t> links_from_tail(std::vector<std::size_t> links, const sim::Draft& draft);
/// False if the argument is missing.
[[nodiscard]] bool is_set(const nlohmann::json& arguments, const char* name);
/// Empty if the argument is missing.
[[nodiscard]] std::string text(const nlohmann::json& arguments, const char* name);

}  // namespace proleg::tools
