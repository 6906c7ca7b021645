#include "sim/scenario/mesh_reader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/mesh/mesh_checks.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/mesh/mesh_geometry.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/tag_scanner.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr Range scales{1e-6, 1e6, ""};
constexpr double least_size = 0.001;   // m
constexpr double most_of_link = 5.0;   // m
constexpr double most_of_world = 1e3;  // m
constexpr std::uint64_t most_columns = 1024;
constexpr double no_height = -9999.0;  // as programs for maps write it; the other usual numbers are out of the range
constexpr std::string_view height_hint = "; a file has heights alone: no header, and no number for an unknown height";

/// The file and the scale that an element names.
struct FileMention {
  std::string file;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

std::function<bool(const std::string& path)> file_test(const XmlElement& element, SourceSet& sources) {
  return [&](const std::string& path) { return sources.has(element, path); };
}

FileMention read_mention(const XmlElement& element, SourceSet& sources) {
  const std::string text = element.text();
  const auto [path, rest] = split_file_text(text, file_test(element, sources));
  const std::vector<std::string_view> parts = words(rest);
  if (path.empty() || parts.size() == 2 || parts.size() > 3) {
    element.refuse(in_quotes(text) + " in " + element.label(), "a file, or a file and 1 or 3 scales");
  }
  FileMention mention{std::string(path), Eigen::Vector3d::Ones()};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::optional<double> scale = parse_number_in(parts[i], scales);
    if (!scale) {
      element.refuse("the scale " + in_quotes(parts[i]) + " in " + element.label(),
                     "a number from " + number_text(scales.min) + " to " + number_text(scales.max));
    }
    if (parts.size() == 1) {
      mention.scale.setConstant(*scale);
    } else {
      mention.scale[static_cast<Eigen::Index>(i)] = *scale;
    }
  }
  return mention;
}

/// Turns a mesh into what its use needs. Throws MeshError.
TriangleMesh made_for(TriangleMesh mesh, MeshUse use, bool is_open, const std::string& name,
                      std::vector<std::string>& remarks) {
  require_size(mesh, least_size, use == MeshUse::surface ? most_of_world : most_of_link);
  switch (use) {
    case MeshUse::look:
      return without_slivers(std::move(mesh));
    case MeshUse::hull: {
      ConvexHull hull = convex_hull(mesh);
      if (hull.deviation > 0.0) {
        remarks.push_back(one_line(name + ": the convex hull keeps " + std::to_string(hull.mesh.vertices.size()) +
                                   " corners; the mesh is at most " + number_text(hull.deviation * 1000.0) +
                                   " mm outside of it"));
      }
      return std::move(hull.mesh);
    }
    case MeshUse::surface:
      break;
  }
  require_area(mesh);
  if (!is_open) {
    require_closed(mesh);
    if (solid_of(mesh).volume < 0.0) {
      for (std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
        std::swap(triangle[1], triangle[2]);
      }
      remarks.push_back(one_line(name + ": the triangles face inwards; they are turned"));
    }
  }
  return mesh;
}

template <typename Make>
auto with_place(const XmlElement& element, const std::string& what, const Make& make) {
  try {
    return make();
  } catch (const MeshError& error) {
    element.refuse(error.found + (what.empty() ? "" : " in " + what), error.expected);
  }
}

/// A text of numbers: that of an element, or of the file that an element names.
struct NumberText {
  std::string text;
  std::string name;  ///< in messages
  bool is_file = false;

  /// Where a word of the text is.
  [[nodiscard]] std::string place_of(std::string_view word) const {
    return is_file ? "line " + std::to_string(line_at(text, static_cast<std::size_t>(word.data() - text.data()))) +
                         " of " + name
                   : name;
  }
};

/// The mesh of a file that `mention` names as `reference`, imported now or by an earlier read of the same bytes.
KnownMeshes::Import& imported(const XmlElement& mention, const std::string& reference, const SourceSet::Bytes& file,
                              SourceSet& sources) {
  std::map<std::string, KnownMeshes::Import>& imports = sources.meshes().imports();
  const std::string name = name_of(file.path);
  const auto is_as_it_was = [&](const KnownMeshes::Import& import) {
    return import.source == file.source &&
           std::ranges::all_of(import.companions, [&](const KnownMeshes::Companion& companion) {
             return sources.companion(mention, companion.path) == companion.text;
           });
  };
  if (const auto known = imports.find(name); known != imports.end() && is_as_it_was(known->second)) {
    known->second.is_used = true;
    return known->second;
  }
  KnownMeshes::Import import;
  import.source = file.source;
  const auto beside = [&](const std::string& companion) {
    std::filesystem::path path = file.path.parent_path() / std::filesystem::path(companion).filename();
    std::optional<std::string> text = sources.companion(mention, path);
    import.companions.push_back({std::move(path), text});
    return text;
  };
  const auto read = [&] { return read_mesh_file(reference, bytes_of_source(import.source), beside); };
  import.mesh = std::make_shared<const TriangleMesh>(with_place(mention, "", read));
  return imports.insert_or_assign(name, std::move(import)).first->second;
}

NumberText numbers_of(const XmlElement& element) { return {element.text(), element.label()}; }

NumberText numbers_of_file(const XmlElement& data, SourceSet& sources) {
  const std::string bytes = bytes_of_source(sources.find_bytes(data, data.text()).source);
  return {std::string(without_byte_order_mark(bytes)), in_quotes(data.text()), true};
}

/// hint: what else a message says about the numbers that are expected.
std::vector<double> all_numbers(const XmlElement& element, const NumberText& source, const Range& range,
                                std::size_t most, std::string_view hint = "") {
  std::vector<double> numbers;
  for (const std::string_view word : words(source.text)) {
    const std::optional<double> number = parse_number_in(word, range);
    if (!number) {
      element.refuse(in_quotes(word) + " in " + source.place_of(word), "numbers from " + number_text(range.min) +
                                                                           " to " + number_text(range.max) + ' ' +
                                                                           std::string(range.unit) + std::string(hint));
    }
    if (numbers.size() == most) {
      element.refuse("more than " + std::to_string(most) + " numbers in " + source.name, "at most that");
    }
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace

FileText split_file_text(std::string_view text, const std::function<bool(const std::string& path)>& is_file) {
  const std::vector<std::string_view> parts = words(text);
  const bool is_quoted = text.starts_with('\'') || text.starts_with('"');
  if (parts.size() < 2 && !is_quoted) {
    return {text, {}};
  }
  const auto split_behind = [&](std::string_view word) -> FileText {
    const auto size = static_cast<std::size_t>(word.data() + word.size() - text.data());
    return {text.substr(0, size), text.substr(size)};
  };
  for (auto last = parts.rbegin(); last != parts.rend(); ++last) {
    if (const FileText split = split_behind(*last); is_file(std::string(split.path))) {
      return split;
    }
  }
  if (const std::size_t end = is_quoted ? text.find(text.front(), 1) : text.npos; end != text.npos) {
    return {text.substr(1, end - 1), text.substr(end + 1)};
  }
  std::size_t count = parts.size();
  while (count > 1 && parts.size() - count < 3 && parse_number(parts[count - 1])) {
    --count;
  }
  return split_behind(parts[count - 1]);
}

std::string mesh_file_named_by(const XmlElement& element, SourceSet& sources) {
  const std::string text = element.text();
  return std::string(split_file_text(text, file_test(element, sources)).path);
}

std::shared_ptr<const TriangleMesh> read_mesh_of_file(const XmlElement& element, MeshUse use, bool is_open,
                                                      SourceSet& sources, std::vector<std::string>& remarks) {
  const FileMention mention = read_mention(element, sources);
  const SourceSet::Bytes file = sources.find_bytes(element, mention.file);
  const std::string name = name_of(file.path);
  KnownMeshes::Import& import = imported(element, mention.file, file, sources);
  const std::string key = exact_text(mention.scale.x()) + ' ' + exact_text(mention.scale.y()) + ' ' +
                          exact_text(mention.scale.z()) + '\n' + std::to_string(static_cast<int>(use)) +
                          (is_open ? " open" : "");
  auto known = import.made.find(key);
  if (known == import.made.end()) {
    TriangleMesh mesh = *import.mesh;
    for (Eigen::Vector3d& vertex : mesh.vertices) {
      vertex = vertex.cwiseProduct(mention.scale);
    }
    KnownMeshes::Made made;
    made.mesh = with_place(element, in_quotes(mention.file), [&] {
      return std::make_shared<const TriangleMesh>(made_for(std::move(mesh), use, is_open, name, made.remarks));
    });
    known = import.made.emplace(key, std::move(made)).first;
  }
  known->second.is_used = true;
  // Links that share a mesh share its remark.
  for (const std::string& remark : known->second.remarks) {
    if (std::ranges::find(remarks, remark) == remarks.end()) {
      remarks.push_back(remark);
    }
  }
  return known->second.mesh;
}

std::shared_ptr<const TriangleMesh> read_mesh_of_text(const XmlElement& element, MeshUse use, bool is_open,
                                                      std::vector<std::string>& remarks) {
  const XmlElement vertices = element.required_child("vertices");
  const std::vector<double> numbers = all_numbers(vertices, numbers_of(vertices), coordinates, 9 * max_triangles);
  if (numbers.empty() || numbers.size() % 3 != 0) {
    vertices.refuse(std::to_string(numbers.size()) + " numbers in " + vertices.label(), "x y z of each vertex");
  }
  TriangleMesh mesh;
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    mesh.vertices.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  }
  const auto triangles = element.child("triangles");
  const XmlElement& place = triangles ? *triangles : vertices;
  std::vector<std::uint32_t> corners;
  if (triangles) {
    const std::string text = triangles->text();
    for (const std::string_view word : words(text)) {
      const std::optional<std::uint32_t> corner = parse_whole<std::uint32_t>(word);
      if (!corner || *corner >= mesh.vertices.size()) {
        triangles->refuse(in_quotes(word) + " in " + triangles->label(),
                          "numbers of vertices, 0 to " + std::to_string(mesh.vertices.size() - 1));
      }
      corners.push_back(*corner);
    }
  } else {
    for (std::uint32_t corner = 0; corner < mesh.vertices.size(); ++corner) {
      corners.push_back(corner);
    }
  }
  if (corners.empty() || corners.size() % 3 != 0 || corners.size() > 3 * max_triangles) {
    place.refuse(std::to_string(corners.size()) + " corners of triangles in " + place.label(),
                 "three of each triangle, 1 to " + std::to_string(max_triangles) + " triangles");
  }
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  }
  const std::string name = vertices.document().name() + ':' + std::to_string(vertices.line());
  return with_place(place, place.label(), [&] {
    return std::make_shared<const TriangleMesh>(made_for(std::move(mesh), use, is_open, name, remarks));
  });
}

void read_height_field(const XmlElement& element, SourceSet& sources, Geometry& geometry) {
  HeightField field;
  const std::vector<double> sides = read_numbers(element.required_child("extents"), 2, lengths);
  field.half_x = sides[0];
  field.half_y = sides[1];
  field.columns = read_whole(element.required_child("columns"), 2, most_columns);
  field.rows = read_whole(element.required_child("rows"), 2, most_columns);
  const std::size_t count = field.columns * field.rows;
  if (2 * (field.columns - 1) * (field.rows - 1) > max_triangles) {
    element.refuse("a grid of " + std::to_string(field.columns) + " x " + std::to_string(field.rows) + " heights",
                   "one of at most " + std::to_string(max_triangles / 2) + " cells");
  }
  const auto heights = element.child("heights");
  const auto data = element.child("data");
  if (heights.has_value() == data.has_value()) {
    element.refuse((heights ? "both <heights> and <data> in " : "neither <heights> nor <data> in ") + element.label(),
                   "one of them");
  }
  const XmlElement& place = heights ? *heights : *data;
  const NumberText source = heights ? numbers_of(*heights) : numbers_of_file(*data, sources);
  field.heights = all_numbers(place, source, coordinates, count, height_hint);
  if (field.heights.size() != count) {
    place.refuse(std::to_string(field.heights.size()) + " heights in " + source.name,
                 std::to_string(count) + ", one for each column of each row");
  }
  if (const auto unknown = std::ranges::find(field.heights, no_height); unknown != field.heights.end()) {
    const std::string_view word = words(source.text)[static_cast<std::size_t>(unknown - field.heights.begin())];
    place.refuse(in_quotes(word) + " in " + source.place_of(word) + ", which stands for an unknown height",
                 "a height at each place of the grid");
  }
  geometry.shape = Shape::height_field;
  geometry.mesh = std::make_shared<const TriangleMesh>(surface_of(field));
  const auto largest = std::ranges::max_element(field.heights, {}, [](double height) { return std::abs(height); });
  geometry.extents = {field.half_x, field.half_y, std::max(std::abs(*largest), lengths.min)};
  geometry.heights = std::make_shared<const HeightField>(std::move(field));
}

std::shared_ptr<const TriangleMesh> painted(const std::shared_ptr<const TriangleMesh>& mesh,
                                            const Eigen::Vector3f& colour, SourceSet& sources) {
  std::shared_ptr<const TriangleMesh>& known = sources.painted_meshes()[{mesh, {colour.x(), colour.y(), colour.z()}}];
  if (!known) {
    TriangleMesh copy = *mesh;
    copy.colours.assign(copy.vertices.size(), colour);
    known = std::make_shared<const TriangleMesh>(std::move(copy));
  }
  return known;
}

}  // namespace proleg::sim
