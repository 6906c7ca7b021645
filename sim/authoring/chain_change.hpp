#pragma once

// Changes of the length and the order of a robot's chain.

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/authoring/draft.hpp"

namespace proleg::sim {

/// Adds, removes and exchanges joints. Joints are counted from the tail, from 0. A joint comes and goes with the link
/// in front of it; the last one with the link behind it, so that the head stays. The actuation file follows: joint
/// configurations, and the values of single joints. So do the sensors and modules that name a joint or a link.
/// Names that count ("J1", "J2", ... and "1Seg", "2Seg", ...) count without a gap afterwards; others stay.
/// All calls throw InputError for a joint that does not exist, and for a chain of another form than read_chain_text()
/// takes.
class ChainChange {
 public:
  explicit ChainChange(DraftChange& change) : change_(change) {}

  /// Adds a copy of a joint, and of its link, in front of it.
  void duplicate(std::size_t joint);
  /// Removes a joint and its link. At least one joint stays.
  void remove(std::size_t joint);
  /// Adds or removes joints at the head, up to 64. If the axes of the last two joints differ, new ones alternate.
  void set_joint_count(std::size_t count);
  /// Joint i becomes what joint order[i] was: axis, limits, servo, and what drives it. Each joint is there once. Links
  /// stay where they are.
  void order(const std::vector<std::size_t>& order);
  /// Moves a joint to the place of another one; those between them close up. Its link goes along, with the sensors on
  /// it: the one in front of the joint, of the last joint the one behind it. Links whose <Body> stands in the robot's
  /// file, or whose joints are in the frame of the link behind, stay where they are.
  void move(std::size_t from, std::size_t to);

 private:
  struct State;
  using MaskEdit = std::function<void(std::string&)>;

  [[nodiscard]] State read();
  void duplicate_link(const State& state, std::size_t link);
  void remove_link(State state, std::size_t link);
  void move_link(std::size_t from, std::size_t to);
  void move_sensors(const State& state, const std::map<std::string, std::string>& links);
  void assign(const State& state, const std::vector<std::size_t>& source);
  void assign_properties(const State& state, const std::vector<std::size_t>& source);
  void assign_values(const State& state, const std::vector<std::size_t>& source);
  void copy_joint(const State& state, std::size_t joint, const std::string& name, const std::string& link);
  void copy_link(const State& state, std::size_t link, const std::string& name, const Eigen::Vector3d& shift);
  void remove_mentions(const State& state, const std::string& joint, const std::string& link);
  void edit_masks(const State& state, const MaskEdit& edit);
  void copy_values(const State& state, const std::string& joint, const std::string& copy);
  void add_module(const State& state, const std::string& joint);
  void count_names(const State& before, const std::vector<std::string>& links, const std::vector<std::string>& joints);

  DraftChange& change_;
};

}  // namespace proleg::sim
