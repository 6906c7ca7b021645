#include "sim/scenario/chain.hpp"

#include <algorithm>
#include <optional>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/joint_mask.hpp"

namespace proleg::sim {
namespace {

[[noreturn]] void refuse(const Origin& origin, const std::string& found, const std::string& expected) {
  throw InputError(origin.file, origin.line, found, expected);
}

class ChainBuilder {
 public:
  ChainBuilder(const KinBodyContents& contents, const Origin& robot)
      : bodies_(&contents.bodies), joints_(&contents.joints), robot_(&robot), joints_of_(contents.bodies.size()) {}

  Chain build() {
    if (joints_->empty()) {
      refuse(*robot_, "a robot without joints", "1 to " + std::to_string(max_joints) + " joints");
    }
    connect();
    return walk(find_head());
  }

 private:
  void connect() {
    for (std::size_t j = 0; j < joints_->size(); ++j) {
      const JointEntry& entry = (*joints_)[j];
      for (const std::string& name : entry.bodies) {
        std::vector<std::size_t>& joints = joints_of_[body_index(name)];
        joints.push_back(j);
        if (joints.size() > 2) {
          refuse(entry.origin,
                 "joint " + in_quotes(entry.joint.name) + " as the third joint of body " + in_quotes(name),
                 "an unbranched chain");
        }
      }
    }
  }

  [[nodiscard]] std::size_t find_head() const {
    std::optional<std::size_t> head;
    std::optional<std::size_t> last_end;
    for (std::size_t b = 0; b < bodies_->size(); ++b) {
      if (joints_of_[b].size() != 1) {
        continue;
      }
      last_end = b;
      const BodyEntry& body = (*bodies_)[b];
      if (!lower_case(body.link.name).ends_with("head")) {
        continue;
      }
      if (head) {
        refuse(body.origin,
               "two heads, " + in_quotes((*bodies_)[*head].link.name) + " and " + in_quotes(body.link.name),
               "one end of the robot with a name that ends with 'Head'");
      }
      head = b;
    }
    if (!last_end) {
      refuse(joints_->back().origin, "joint " + in_quotes(joints_->back().joint.name) + " in a ring of bodies",
             "a chain with two ends");
    }
    return head.value_or(*last_end);
  }

  [[nodiscard]] Chain walk(std::size_t body) const {
    Chain chain;
    std::vector<bool> reached(bodies_->size(), false);
    std::optional<std::size_t> arrived_by;
    for (;;) {
      reached[body] = true;
      chain.links.push_back((*bodies_)[body].link);
      chain.link_origins.push_back((*bodies_)[body].origin);
      const std::optional<std::size_t> next = joint_onward(body, arrived_by);
      if (!next) {
        break;
      }
      const std::size_t tailward = append_joint(chain, *next, body);
      arrived_by = next;
      body = tailward;
    }
    chain.joint_map = "joints from the head, where recordings count from 0: " + chain.joint_map;
    for (std::size_t b = 0; b < bodies_->size(); ++b) {
      if (!reached[b]) {
        refuse((*bodies_)[b].origin,
               "body " + in_quotes((*bodies_)[b].link.name) + ", which no joint connects to the head " +
                   in_quotes(chain.links.front().name),
               "one connected chain");
      }
    }
    return chain;
  }

  [[nodiscard]] std::optional<std::size_t> joint_onward(std::size_t body, std::optional<std::size_t> arrived_by) const {
    for (const std::size_t joint : joints_of_[body]) {
      if (joint != arrived_by) {
        return joint;
      }
    }
    return std::nullopt;
  }

  /// Adds the joint between a body and the next one towards the tail; returns that body.
  std::size_t append_joint(Chain& chain, std::size_t joint, std::size_t headward) const {
    const JointEntry& entry = (*joints_)[joint];
    const bool headward_first = entry.bodies[0] == (*bodies_)[headward].link.name;
    const std::string& tailward = entry.bodies[headward_first ? 1 : 0];
    chain.joints.push_back(entry.joint);
    if (headward_first) {
      // The angle in the file is the rotation of the second body relative to the first. The rotation of the first
      // relative to the second is the same angle about the opposite axis.
      chain.joints.back().axis *= -1.0;
    }
    chain.kernel_limits.push_back(entry.kernel_limits);
    chain.joint_origins.push_back(entry.origin);
    chain.headward_first.push_back(headward_first);
    chain.is_in_frame_of_link.push_back(entry.is_in_frame_of_body);
    chain.joint_map += (chain.joints.size() > 1 ? ", " : "") + entry.joint.name + " (" +
                       (*bodies_)[headward].link.name + " - " + tailward + ")";
    return body_index(tailward);
  }

  [[nodiscard]] std::size_t body_index(const std::string& name) const {
    const auto body = std::ranges::find(*bodies_, name, [](const BodyEntry& entry) { return entry.link.name; });
    return static_cast<std::size_t>(body - bodies_->begin());
  }

  const std::vector<BodyEntry>* bodies_;
  const std::vector<JointEntry>* joints_;
  const Origin* robot_;
  std::vector<std::vector<std::size_t>> joints_of_;  ///< of each body, positions in joints_
};

}  // namespace

Chain make_chain(const KinBodyContents& contents, const Origin& robot) { return ChainBuilder(contents, robot).build(); }

}  // namespace proleg::sim
