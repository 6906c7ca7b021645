#include "sim/urdf/urdf_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/joint_mask.hpp"

namespace proleg::sim {
namespace {

using std::numbers::pi;

/// The mass of two bodies that are one. Both in the same frame.
MassProperties joined(const MassProperties& one, const MassProperties& other) {
  const auto about = [](const MassProperties& part, const Eigen::Vector3d& center) {
    const Eigen::Vector3d arm = part.center - center;
    const Eigen::Matrix3d parallel_axes = arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
    return Eigen::Matrix3d(part.inertia + part.mass * parallel_axes);
  };
  MassProperties whole;
  whole.mass = one.mass + other.mass;
  whole.center = (one.mass * one.center + other.mass * other.center) / whole.mass;
  whole.inertia = about(one, whole.center) + about(other, whole.center);
  return whole;
}

MassProperties moved(const MassProperties& mass, const Pose& pose) {
  const Eigen::Matrix3d rotation = pose.orientation.toRotationMatrix();
  return {mass.mass, pose * mass.center, rotation * mass.inertia * rotation.transpose()};
}

class ChainMaker {
 public:
  explicit ChainMaker(const UrdfRobot& robot)
      : robot_(&robot),
        joints_below_(robot.links.size()),
        poses_(robot.links.size()),
        body_of_(robot.links.size(), 0),
        zero_(robot.joints.size(), 0.0) {}

  UrdfChain make() {
    find_zero_angles();
    walk_from_root();
    const std::vector<std::size_t> order = order_from_tail();
    std::vector<std::size_t> place(bodies_.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      place[order[i]] = i;
      chain_.bodies.push_back(std::move(bodies_[order[i]].body));
    }
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
      const auto between = std::ranges::find_if(movable_, [&](std::size_t joint) {
        const auto [a, b] = std::minmax(place[parent_body(joint)], place[child_body(joint)]);
        return a == i && b == i + 1;
      });
      chain_.joints.push_back(hinge_of(*between, place));
    }
    return std::move(chain_);
  }

 private:
  struct Group {
    UrdfBody body;
    std::size_t link = 0;  ///< whose name and frame the body has
    bool has_contents = false;
    std::vector<std::size_t> joints;  ///< movable ones
    std::size_t depth = 0;            ///< movable joints between it and the root
  };

  [[noreturn]] void refuse(int line, const std::string& found, const std::string& expected) const {
    throw InputError(robot_->file, line, found, expected);
  }

  /// Every joint of Proleg starts at angle 0, which must be within its limits.
  void find_zero_angles() {
    for (std::size_t j = 0; j < robot_->joints.size(); ++j) {
      const UrdfJoint& joint = robot_->joints[j];
      if (joint.kind == UrdfJoint::Kind::revolute && (joint.lower > 0.0 || joint.upper < 0.0)) {
        zero_[j] = (joint.lower + joint.upper) / 2.0;
        chain_.notes.push_back("joint " + in_quotes(joint.name) + ": its limits exclude 0; angle 0 is now " +
                               number_text(zero_[j]) + " rad of the file, in their middle");
      }
    }
  }

  /// Poses of all links, and the bodies that they form, without recursion: a file may have a long chain of links.
  void walk_from_root() {
    for (std::size_t j = 0; j < robot_->joints.size(); ++j) {
      joints_below_[robot_->joints[j].parent].push_back(j);
    }
    // ROS robots point along x, robots of Proleg along y.
    poses_[robot_->root].orientation =
        Eigen::Quaterniond(std::numbers::sqrt2 / 2.0, 0.0, 0.0, std::numbers::sqrt2 / 2.0);
    begin_body(robot_->root, 0);
    std::vector<std::size_t> links{robot_->root};
    for (std::size_t i = 0; i < links.size(); ++i) {
      const std::size_t link = links[i];
      add_to_body(link);
      for (const std::size_t j : joints_below_[link]) {
        const UrdfJoint& joint = robot_->joints[j];
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(zero_[j], joint.axis));
        poses_[joint.child] = poses_[link] * joint.origin * Pose{Eigen::Vector3d::Zero(), turn};
        if (joint.kind == UrdfJoint::Kind::fixed) {
          body_of_[joint.child] = body_of_[link];
        } else {
          movable_.push_back(j);
          begin_body(joint.child, bodies_[body_of_[link]].depth + 1);
          bodies_[body_of_[link]].joints.push_back(j);
          bodies_[body_of_[joint.child]].joints.push_back(j);
        }
        links.push_back(joint.child);
      }
    }
  }

  void begin_body(std::size_t link, std::size_t depth) {
    body_of_[link] = bodies_.size();
    Group group;
    group.depth = depth;
    take_frame(group, link);
    bodies_.push_back(std::move(group));
  }

  void take_frame(Group& group, std::size_t link) const {
    group.link = link;
    group.body.name = robot_->links[link].name;
    group.body.line = robot_->links[link].line;
    group.body.pose = poses_[link];
  }

  void add_to_body(std::size_t number) {
    const UrdfLink& link = robot_->links[number];
    Group& group = bodies_[body_of_[number]];
    const bool has_contents = link.mass || !link.collisions.empty() || !link.visuals.empty();
    if (!has_contents) {
      return;
    }
    if (!group.has_contents) {
      take_frame(group, number);
      group.has_contents = true;
    }
    const bool is_own_frame = group.link == number;
    const Pose to_body = group.body.pose.inverse() * poses_[number];
    if (link.mass) {
      const MassProperties mass = is_own_frame ? *link.mass : moved(*link.mass, to_body);
      group.body.mass = group.body.mass ? joined(*group.body.mass, mass) : mass;
      group.body.lacks_inertia = group.body.lacks_inertia || mass.inertia.isZero(0.0);
    }
    const auto placed = [&](UrdfShape shape) {
      shape.pose = is_own_frame ? shape.pose : to_body * shape.pose;
      return shape;
    };
    for (const UrdfShape& shape : link.collisions) {
      group.body.collisions.push_back({placed(shape), link.friction});
    }
    for (const UrdfShape& shape : link.visuals) {
      group.body.visuals.push_back(placed(shape));
    }
  }

  /// The bodies in a row. Throws InputError if they are no chain.
  [[nodiscard]] std::vector<std::size_t> order_from_tail() const {
    if (movable_.empty()) {
      refuse(robot_->links[robot_->root].line, "no revolute or continuous joint",
             "1 to " + std::to_string(max_joints) + " of them");
    }
    if (movable_.size() > max_joints) {
      refuse(robot_->joints[movable_[max_joints]].line, std::to_string(movable_.size()) + " joints that move",
             "1 to " + std::to_string(max_joints));
    }
    std::vector<std::size_t> ends;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (bodies_[b].joints.size() > 2) {
        refuse_branch(bodies_[b]);
      }
      if (bodies_[b].joints.size() == 1) {
        ends.push_back(b);
      }
    }
    const std::size_t head = head_of({ends.at(0), ends.at(1)});
    std::vector<std::size_t> order{head == ends[0] ? ends[1] : ends[0]};
    std::size_t arrived_by = robot_->joints.size();
    while (order.back() != head) {
      const std::vector<std::size_t>& joints = bodies_[order.back()].joints;
      const std::size_t joint = joints.front() != arrived_by ? joints.front() : joints.back();
      order.push_back(parent_body(joint) == order.back() ? child_body(joint) : parent_body(joint));
      arrived_by = joint;
    }
    return order;
  }

  [[noreturn]] void refuse_branch(const Group& group) const {
    std::vector<std::string> children;
    for (const std::size_t joint : group.joints) {
      if (&bodies_[parent_body(joint)] == &group) {
        children.push_back(in_quotes(robot_->links[robot_->joints[joint].child].name));
      }
    }
    refuse(group.body.line,
           "link " + in_quotes(group.body.name) + " with " + std::to_string(children.size()) +
               " branches that move: " + listed(children),
           "a chain: at most two joints that move at each link (fixed links may branch)");
  }

  [[nodiscard]] std::size_t head_of(const std::array<std::size_t, 2>& ends) const {
    const auto is_named_head = [&](std::size_t end) { return lower_case(bodies_[end].body.name).ends_with("head"); };
    if (is_named_head(ends[0]) != is_named_head(ends[1])) {
      return is_named_head(ends[0]) ? ends[0] : ends[1];
    }
    const auto forward = [&](std::size_t end) {
      const UrdfBody& body = bodies_[end].body;
      return (body.pose * (body.mass ? body.mass->center : Eigen::Vector3d::Zero().eval())).y();
    };
    constexpr double same = 1e-6;  // m
    if (const double ahead = forward(ends[0]) - forward(ends[1]); std::abs(ahead) > same) {
      return ahead > 0.0 ? ends[0] : ends[1];
    }
    return bodies_[ends[0]].depth > bodies_[ends[1]].depth ? ends[0] : ends[1];
  }

  [[nodiscard]] UrdfHinge hinge_of(std::size_t number, const std::vector<std::size_t>& place) {
    const UrdfJoint& joint = robot_->joints[number];
    UrdfHinge hinge;
    hinge.name = joint.name;
    hinge.parent = place[parent_body(number)];
    hinge.child = place[child_body(number)];
    const UrdfBody& child = chain_.bodies[hinge.child];
    hinge.axis = joint.axis;
    if (bodies_[child_body(number)].link != joint.child) {
      const Pose to_body = child.pose.inverse() * poses_[joint.child];
      hinge.anchor = to_body.position;
      hinge.axis = to_body.orientation * joint.axis;
    }
    hinge.lower = joint.lower - zero_[number];
    hinge.upper = joint.upper - zero_[number];
    if (joint.kind == UrdfJoint::Kind::continuous) {
      hinge.lower = -pi;
      hinge.upper = pi;
      chain_.notes.push_back("joint " + in_quotes(joint.name) + " is continuous: its limits are -180 and 180 degrees");
    } else if (hinge.lower < -2.0 * pi || hinge.upper > 2.0 * pi) {
      hinge.lower = std::max(hinge.lower, -2.0 * pi);
      hinge.upper = std::min(hinge.upper, 2.0 * pi);
      chain_.notes.push_back("joint " + in_quotes(joint.name) + ": its limits are cut to " +
                             number_text(hinge.lower * 180.0 / pi) + " and " + number_text(hinge.upper * 180.0 / pi) +
                             " degrees");
    }
    hinge.effort = joint.effort;
    hinge.velocity = joint.velocity;
    hinge.line = joint.line;
    return hinge;
  }

  [[nodiscard]] std::size_t parent_body(std::size_t joint) const { return body_of_[robot_->joints[joint].parent]; }
  [[nodiscard]] std::size_t child_body(std::size_t joint) const { return body_of_[robot_->joints[joint].child]; }

  const UrdfRobot* robot_;
  std::vector<std::vector<std::size_t>> joints_below_;  ///< by link
  std::vector<Pose> poses_;                             ///< of the links, in the robot's frame
  std::vector<std::size_t> body_of_;                    ///< by link
  std::vector<double> zero_;                            ///< rad, by joint: the angle of the file that becomes 0
  std::vector<std::size_t> movable_;
  std::vector<Group> bodies_;
  UrdfChain chain_;
};

}  // namespace

UrdfChain make_urdf_chain(const UrdfRobot& robot) { return ChainMaker(robot).make(); }

}  // namespace proleg::sim
