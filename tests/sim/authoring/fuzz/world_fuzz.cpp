// Reads arbitrary input as an environment file in a draft, and changes it. An input is bytes of the operations, up to a
// line "===", then the text; behind a second line "===" a text that is pasted first. For every input each operation
// must have its effect or throw an InputError of one line and have none; and undo must return to every earlier text.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "memory_files.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/authoring/draft.hpp"
#include "sim/authoring/own_mesh.hpp"
#include "sim/authoring/world_change.hpp"
#include "sim/authoring/world_clipboard.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using namespace proleg::sim;
using test::require;

constexpr const char* file = "environment.xml";
constexpr std::size_t most_operations = 24;

double number(test::FuzzInput& input) { return (static_cast<double>(input.byte()) - 128.0) / 16.0; }

Eigen::Vector3d vector(test::FuzzInput& input) {
  const double x = number(input);
  const double y = number(input);
  return {x, y, number(input)};
}

/// A closed tetrahedron, or a sheet.
const OwnMesh& own_mesh(bool is_closed) {
  static const OwnMesh closed =
      read_own_mesh({{"a.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"}});
  static const OwnMesh sheet = read_own_mesh({{"b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}});
  return is_closed ? closed : sheet;
}

void change(WorldChange& world, test::FuzzInput& input) {
  const std::uint8_t kind = input.byte() % 14;
  const std::size_t at = input.byte() % 8;
  const bool group = input.byte() % 2 == 0;
  switch (kind) {
    case 0: {
      const Eigen::Vector3d place = vector(input);
      const Eigen::Quaterniond turn(number(input), number(input), number(input), 1.0);
      return world.place(at, {place, turn.normalized()}, group);
    }
    case 1: {
      std::vector<double> size(input.byte() % 4);
      std::ranges::generate(size, [&] { return number(input); });
      return world.set_size(at, input.byte() % 3, size);
    }
    case 2:
      return world.set_friction(at, group ? std::nullopt : std::optional(number(input)));
    case 3:
      return world.set_colour(at, vector(input) / 8.0);
    case 4:
      return world.set_moves(at, group);
    case 5:
      return world.set_mass(at, number(input));
    case 6:
      return world.rename(at, std::string(input.byte() % 70, static_cast<char>(input.byte())));
    case 7:
      return world.remove({at}, group);
    case 8:
      return world.duplicate({at, 1}, group, vector(input), input.byte() % 4);
    case 9: {
      const LibraryDeclaration& item = library()[input.byte() % library().size()];
      std::map<std::string, double> values;
      for (const LibraryParameter& parameter : item.parameters) {
        if (input.byte() % 2 == 0) {
          values[std::string(parameter.name)] = number(input);
        }
      }
      return world.add(item.item, values, vector(input), number(input) * 50.0);
    }
    case 10:
      return group ? world.add_ruler(vector(input), vector(input)) : world.set_ruler(at, vector(input), vector(input));
    case 11:
      return world.remove_ruler(at);
    case 12: {
      const std::array<unsigned, 3> quarters{input.byte() % 5U, input.byte() % 5U, input.byte() % 5U};
      const MeshFit fit{number(input), quarters, vector(input) / 8.0};
      return world.add_mesh(own_mesh(at % 2 == 0), fit, group, vector(input), number(input) * 50.0);
    }
    default:
      return world.set_start(vector(input), vector(input));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  constexpr std::string_view separator = "===\n";
  const std::size_t end = all.find(separator);
  if (end == std::string_view::npos) {
    return 0;
  }
  MemoryFiles files = small_scenario();
  // Behind a second separator is the text of a clipboard.
  const std::string_view behind = all.substr(end + separator.size());
  const std::size_t middle = behind.find(separator);
  files.texts[file] = std::string(behind.substr(0, middle));
  std::optional<Draft> draft;
  try {
    draft.emplace(files.scenario(), files);
  } catch (const InputError&) {
    return 0;  // the scenario reader has a target of its own
  }
  test::FuzzInput input(std::span(data, end));
  std::vector<std::string> states{draft->text(file)};
  for (std::size_t i = 0; i < most_operations && !input.empty(); ++i) {
    const WorldContents world = read_world_contents(*draft);
    const bool pastes = i == 0 && middle != std::string_view::npos;
    try {
      draft->change("change", std::nullopt, [&](DraftChange& edit) {
        if (pastes) {
          return paste_objects(world, edit, behind.substr(middle + separator.size()), {0.5, 0.0, 0.0});
        }
        WorldChange world_change(world, edit);
        change(world_change, input);
      });
    } catch (const InputError& error) {
      require(draft->text(file) == states.back(), "what is refused changes nothing");
      const std::string_view message = error.what();
      require(std::ranges::none_of(message, [](char c) { return static_cast<unsigned char>(c) < 0x20; }),
              "a message is one line");
    }
    if (draft->text(file) != states.back()) {
      states.push_back(draft->text(file));
    }
  }
  for (std::size_t i = states.size() - 1; i > 0; --i) {
    require(draft->undo() && draft->text(file) == states[i - 1], "undo returns to the text before");
  }
  require(!draft->undo(), "each change is one entry");
  return 0;
}
