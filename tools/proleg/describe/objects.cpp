// proleg objects: prints the object dictionary of a module for the user, as docs/objects.md for the documentation, and
// as docs/proleg.eds for CANopen tools; prints the frames of a robot as docs/proleg.dbc for CAN tools.

#include <algorithm>
#include <array>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "shared/canopen/messages.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/describe/object_files.hpp"

namespace {

using namespace proleg;
using namespace proleg::canopen;

constexpr std::size_t columns = 8;
using Line = std::array<std::string, columns>;
const Line titles{"object", "sub", "name", "type", "access", "default", "range", "what it is"};

/// Text of a value: identifiers and codes in hexadecimal, quantities in decimal.
std::string number(const Object& object, std::uint32_t value) {
  if (is_signed(object.type)) {
    return std::to_string(static_cast<std::int32_t>(value));
  }
  const bool is_code = object.adds_node_id || object.access == Access::constant || object.also_allowed;
  return is_code && size_of(object.type) > 1 ? hexadecimal(value, 1) : std::to_string(value);
}

std::string type_name(DataType type) {
  switch (type) {
    case DataType::visible_string:
      return "string";
    case DataType::octet_string:
      return "octets";
    case DataType::domain:
      return "domain";
    default:
      return (is_signed(type) ? "i" : "u") + std::to_string(8 * size_of(type));
  }
}

std::string access_name(Access access) {
  switch (access) {
    case Access::read_only:
      return "ro";
    case Access::read_write:
      return "rw";
    case Access::constant:
      return "const";
    case Access::write_only:
      return "wo";
    case Access::by_pdo:
      break;
  }
  return "ro, PDO";
}

std::string default_text(const ObjectRow& row) {
  const Object& object = *row.first;
  if (object.adds_node_id) {
    return number(object, object.default_value) + " + node";
  }
  if (is_long(object.type)) {
    return std::string(object.text);
  }
  if (object.access == Access::read_only || object.access == Access::by_pdo) {
    return "";
  }
  return number(object, object.default_value) +
         (row.default_step != 0 ? " + j * " + hexadecimal(row.default_step, 1) : "");
}

std::string range_text(const Object& object) {
  if (object.access != Access::read_write && object.access != Access::write_only) {
    return "";
  }
  if (object.minimum == min_value(object.type) && object.maximum == max_value(object.type)) {
    return "any";
  }
  std::string text = number(object, object.minimum);
  if (object.minimum != object.maximum) {
    text += " to " + number(object, object.maximum);
  }
  if (is_long(object.type)) {
    return text + " bytes";
  }
  return object.also_allowed ? text + ", " + number(object, *object.also_allowed) : text;
}

Line line_of(const ObjectRow& row) {
  const Object& object = *row.first;
  const ObjectGroup* group = find_group(object.address.index);
  const std::string index = hexadecimal(object.address.index, 4) + (row.indices > 1 ? " + j" : "");
  std::string sub;
  if (group != nullptr) {
    sub = std::to_string(object.address.sub);
    if (row.subs > 1) {
      sub += "-" + std::to_string(object.address.sub + row.subs - 1);
    }
  }
  std::string name = group != nullptr ? std::string(group->name) : "";
  name += (row.indices > 1 ? " j" : "") + std::string(group != nullptr ? ": " : "") + std::string(object.name);
  return {index,
          sub,
          name,
          type_name(object.type),
          access_name(object.access),
          default_text(row),
          range_text(object),
          std::string(object.help)};
}

/// Text "0x3080 to 0x3086", or "none".
std::string index_range(ValueKind kind, const Declaration& declaration) {
  const std::size_t count =
      kind == ValueKind::internal_value ? declaration.internal_values.size() : declaration.parameters.size();
  if (count == 0) {
    return "none";
  }
  const auto index = [&](std::size_t number) {
    return hexadecimal(address_of({kind, declaration.id, static_cast<std::uint8_t>(number), 0}).index, 4);
  };
  return count == 1 ? index(0) : index(0) + " to " + index(count - 1);
}

void print_markdown(std::ostream& out) {
  const auto print_line = [&](const auto& cells) {
    for (const std::string& cell : cells) {
      out << (cell.empty() ? "| " : "| " + cell + " ");
    }
    out << "|\n";
  };
  out << "# Object dictionary\n\n"
         "After this page you can find every object of a module that can be read and set over the bus.\n\n"
         "Written by `proleg objects --markdown` from the declarations in `shared/canopen`; a test "
         "keeps the two the same. For\nCANopen tools there is `proleg.eds` (`proleg objects --eds`). j is a joint, 0 "
         "to "
         "63. Sub-index 0 of an object with sub-indices is\nthe highest of them. \"ro, PDO\": SDO reads, a PDO "
         "writes.\n\n";
  print_line(titles);
  print_line(std::vector<std::string>(columns, "---"));
  for (const ObjectRow& row : object_rows()) {
    print_line(line_of(row));
  }
  out << "\n## Values of the algorithms\n\nOne index a value in the order of `algorithms.md`, which has names, units "
         "and "
         "ranges; the sub-index is the slot, 1 to 4; all are\ni32, rw. Parameters in force are written before the "
         "start, "
         "the others at any time: they are staged.\n\n";
  print_line(std::array<std::string, 4>{"algorithm", "parameters in force", "staged", "internal values"});
  print_line(std::vector<std::string>(4, "---"));
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const Declaration& declaration = algorithm_at(i).declaration();
    print_line(std::array<std::string, 4>{std::string(declaration.name), index_range(ValueKind::parameter, declaration),
                                          index_range(ValueKind::staged_parameter, declaration),
                                          index_range(ValueKind::internal_value, declaration)});
  }
}

void print_text(std::ostream& out) {
  std::vector<Line> lines{titles};
  for (const ObjectRow& row : object_rows()) {
    lines.push_back(line_of(row));
  }
  std::array<std::size_t, columns> widths{};
  for (const Line& line : lines) {
    for (std::size_t i = 0; i < columns; ++i) {
      widths[i] = std::max(widths[i], line[i].size());
    }
  }
  for (const Line& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < columns; ++i) {
      text += line[i] + std::string(widths[i] - line[i].size() + 2, ' ');
    }
    out << text.substr(0, text.find_last_not_of(' ') + 1) << '\n';
  }
  out << "\nj is a joint, 0 to 63. Values of the algorithms, sub-index = slot 1 to 4:\n";
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const Declaration& declaration = algorithm_at(i).declaration();
    out << "  " << declaration.name << ": parameters " << index_range(ValueKind::parameter, declaration) << ", staged "
        << index_range(ValueKind::staged_parameter, declaration) << ", internal values "
        << index_range(ValueKind::internal_value, declaration) << '\n';
  }
}

/// Number of joints of the shipped robots.
constexpr unsigned default_nodes = 5;

void print_dbc(std::ostream& out, const std::string& scenario, const std::optional<std::string>& nodes) {
  if (!scenario.empty()) {
    sim::DiskFiles files;
    tools::print_dbc(out, sim::read_scenario(scenario, files));
    return;
  }
  const std::optional<unsigned> count = nodes ? parse_whole<unsigned>(*nodes) : default_nodes;
  if (!count || *count < min_node_id || *count > max_node_id) {
    throw InputError("--nodes", 0, in_quotes(*nodes), "a whole number from 1 to " + std::to_string(max_node_id));
  }
  tools::print_dbc(out, *count);
}

}  // namespace

int main(int argc, char** argv) {
  proleg::tools::CommandLine command_line(
      "proleg objects",
      "Lists the object dictionary of a module: the objects that can be read and set over the bus. With --dbc: the "
      "frames on the bus.");
  bool eds = false;
  bool units = false;
  bool markdown = false;
  command_line.add_flag("--eds", eds, "print an Electronic Data Sheet (CiA 306) for CANopen tools");
  command_line.add_flag("--markdown", markdown, "print Markdown tables").excludes("--eds");
  command_line
      .add_flag("--units", units,
                "with --eds: also units and help texts, with the keys of python-canopen; strict readers refuse them")
      .excludes("--markdown");
  bool dbc = false;
  std::string scenario;
  std::optional<std::string> nodes;
  command_line
      .add_flag("--dbc", dbc, "print a DBC file for CAN tools: the frames of the robot of FILE, or of any robot")
      .excludes("--eds")
      .excludes("--markdown");
  add_scenario(command_line, scenario, "for --dbc: scenario");
  command_line.add_option("--nodes", nodes, "for --dbc without FILE: node ids 1 to this; 5 by default")
      .value_name("N")
      .excludes("FILE");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] {
    if (!dbc && (!scenario.empty() || nodes)) {
      throw InputError(scenario.empty() ? "--nodes" : "FILE", 0, in_quotes(scenario.empty() ? *nodes : scenario),
                       "it only with --dbc");
    }
    if (units && !eds) {
      throw InputError("--units", 0, "it without --eds", "it only with --eds");
    }
    if (dbc) {
      print_dbc(std::cout, scenario, nodes);
    } else if (eds) {
      using proleg::tools::EdsKeys;
      proleg::tools::print_eds(std::cout, units ? EdsKeys::with_units : EdsKeys::of_the_standard);
    } else if (markdown) {
      print_markdown(std::cout);
    } else {
      print_text(std::cout);
    }
    return proleg::tools::exit_success;
  });
}
