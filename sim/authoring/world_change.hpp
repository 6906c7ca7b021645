#pragma once

// Changes of the environment of a draft.

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/library_items.hpp"
#include "sim/authoring/own_mesh.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/authoring/world_contents.hpp"
#include "sim/robot/pose.hpp"

namespace proleg::sim {

/// The elements of objects in the environment file, the first one first, each once; with_group: of the whole groups
/// that they belong to. A group of one object goes with it. Throws InputError as WorldChange does.
[[nodiscard]] std::vector<ElementNumber> elements_of(const WorldContents& world,
                                                     const std::vector<std::size_t>& objects, bool with_group);

/// Adds the lines of a <KinBody> behind the last <KinBody> of a world. Returns the new element.
ElementNumber add_object(DraftChange& change, const std::string& file, const std::string& lines);

/// Changes of a world. All of them refer to the world as read_world_contents() gives it for the draft before the
/// change; a number of an object or a shape that does not exist, an object that cannot be edited, and a value out of
/// range are an InputError. Lengths are metres, angles degrees.
class WorldChange {
 public:
  WorldChange(const WorldContents& world, DraftChange& change) : world_(world), change_(change) {}

  /// Puts an object somewhere in the world, or the whole group that it belongs to, as a rigid body.
  void place(std::size_t object, const Pose& pose, bool with_group);
  /// The object keeps its lowest point: what stands on the ground stays there.
  void set_size(std::size_t object, std::size_t shape, const std::vector<double>& size);
  /// The coefficient of all its shapes; nothing: that of what it touches holds.
  void set_friction(std::size_t object, std::optional<double> friction);
  void set_colour(std::size_t object, const Eigen::Vector3d& colour);
  /// Whether it moves when something pushes it.
  void set_moves(std::size_t object, bool moves);
  void set_mass(std::size_t object, double mass);
  void rename(std::size_t object, const std::string& name);
  void remove(const std::vector<std::size_t>& objects, bool with_group);
  /// Adds `count` copies of each, moved by `step` from the one before.
  void duplicate(const std::vector<std::size_t>& objects, bool with_group, const Eigen::Vector3d& step, unsigned count);
  /// Adds an item of the library. values: by the names of its parameters; the usual values for those that are missing.
  void add(LibraryItem item, const std::map<std::string, double>& values, const Eigen::Vector3d& position,
           double turn_degrees);
  /// Adds a static object with the shape of a mesh, whose files come into a folder beside the environment file. It
  /// stands on the ground, turned about the vertical; position: m, of the middle of its front edge. is_sheet: its
  /// surface is not closed, and touches from the side that it faces.
  void add_mesh(const OwnMesh& mesh, const MeshFit& fit, bool is_sheet, const Eigen::Vector3d& position,
                double turn_degrees);
  void add_ruler(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
  void set_ruler(std::size_t ruler, const Eigen::Vector3d& from, const Eigen::Vector3d& to);
  void remove_ruler(std::size_t ruler);
  void set_start(const Eigen::Vector3d& position, const Eigen::Vector3d& degrees);

 private:
  [[nodiscard]] ElementNumber element_of_ruler(std::size_t ruler) const;
  [[nodiscard]] const XmlText& xml() { return change_.xml(world_.file); }
  void apply(const TextPatch& patch) { change_.apply(world_.file, patch); }
  /// Gives a mesh another scale.
  void write_scale(const WorldShape& shape, const std::vector<double>& size);
  void write_size(const WorldShape& shape, const std::vector<double>& size);
  void set_tag_of(ElementNumber parent, std::string_view tag, const std::string& content) {
    set_tag(change_, world_.file, parent, tag, content);
  }
  [[nodiscard]] std::string free_name(const std::string& wanted) const;

  const WorldContents& world_;
  DraftChange& change_;
};

}  // namespace proleg::sim
