// proleg algorithms: prints the declarations of the core's algorithms and the measures of a run for the user and, as
// docs/algorithms.md and the table of docs/gait-measures.md, for the documentation.

#include <iostream>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/gait/registry.hpp"
#include "sim/measure/measure.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace {

using namespace proleg;

std::string number(std::int32_t value, Unit unit) { return std::string(format_decimal(value, unit).view()); }

std::string symbol(Unit unit) { return scale_of(unit).symbol; }

/// Text of a unit, as " [deg]"; empty for a ratio or a count.
std::string in_brackets(Unit unit) {
  const std::string text = sim::shown_unit(unit);
  return text.empty() ? "" : " [" + text + "]";
}

std::string range(const Parameter& parameter) {
  if (wraps(parameter.unit)) {
    return "any angle";
  }
  return number(parameter.minimum, parameter.unit) + " to " + number(parameter.maximum, parameter.unit);
}

/// Text "bytes 0-3 phase, bytes 4-5 current_amplitude".
std::string frame_layout(const Declaration& declaration) {
  std::string layout;
  unsigned position = 0;
  for (const FrameField& field : declaration.frame) {
    layout += layout.empty() ? "" : ", ";
    layout += "bytes " + std::to_string(position) + "-" + std::to_string(position + field.bytes - 1) + " " +
              std::string(declaration.internal_values[field.internal_value].name);
    position += field.bytes;
  }
  return layout.empty() ? "nothing" : layout;
}

void print_names(std::ostream& out) {
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const Declaration& declaration = algorithm_at(i).declaration();
    out << declaration.name << "\n    " << declaration.help << '\n';
  }
  out << "\n'proleg algorithms NAME' lists the parameters of an algorithm.\n";
}

void print_markdown(std::ostream& out, const Declaration& declaration) {
  out << "## " << declaration.name << "\n\n"
      << declaration.help << "; id " << unsigned{declaration.id} << ". Broadcasts " << frame_layout(declaration)
      << ".\n\n| parameter | unit | default | range | object | what it is |\n| --- | --- | --- | --- | --- | --- |\n";
  for (std::size_t i = 0; i < declaration.parameters.size(); ++i) {
    const Parameter& parameter = declaration.parameters[i];
    const unsigned index = 0x3000U + 32U * declaration.id + static_cast<unsigned>(i);
    out << "| `" << parameter.name << "` | " << symbol(parameter.unit) << " | "
        << number(parameter.default_value, parameter.unit) << " | " << range(parameter) << " | "
        << hexadecimal(index, 4) << " | " << parameter.help << " |\n";
  }
  if (!declaration.internal_values.empty()) {
    out << "\n| internal value | unit | what it is |\n| --- | --- | --- |\n";
    for (const InternalValue& value : declaration.internal_values) {
      out << "| `" << value.name << "` | " << symbol(value.unit) << " | " << value.help << " |\n";
    }
  }
}

void print_text(std::ostream& out, const Declaration& declaration) {
  out << declaration.name << ": " << declaration.help << "\n\nParameters:\n";
  for (const Parameter& parameter : declaration.parameters) {
    out << "  " << parameter.name << in_brackets(parameter.unit) << ", " << range(parameter) << ", default "
        << number(parameter.default_value, parameter.unit) << "\n      " << parameter.help << '\n';
  }
  if (!declaration.internal_values.empty()) {
    out << "\nInternal values:\n";
    for (const InternalValue& value : declaration.internal_values) {
      out << "  " << value.name << in_brackets(value.unit) << "\n      " << value.help << '\n';
    }
  }
  out << "\nBroadcasts " << frame_layout(declaration) << ".\n";
}

int print_all_markdown(std::ostream& out) {
  out << "# Algorithms\n\n"
         "After this page you can choose an algorithm, and set its parameters within their ranges.\n\n"
         "Written by `proleg algorithms --markdown` from the declarations in `shared/gait`; a test keeps "
         "the two the same.\n\"Object\" is the index in the object dictionary; the sub-index is the slot, 1 to 4.\n";
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    out << '\n';
    print_markdown(out, algorithm_at(i).declaration());
  }
  return tools::exit_success;
}

int list_measures(std::ostream& out, bool markdown) {
  if (markdown) {
    out << "| measure | unit | better | what it is |\n| --- | --- | --- | --- |\n";
  }
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    const char* better = measure.higher_is_better ? "higher" : "lower";
    if (markdown) {
      out << "| `" << measure.name << "` | " << measure.unit << " | " << better << " | " << measure.help << " |\n";
    } else {
      out << measure.name << (measure.unit.empty() ? "" : " [" + std::string(measure.unit) + "]") << ", the " << better
          << ", the better\n    " << measure.help << '\n';
    }
  }
  return tools::exit_success;
}

int describe(const std::string& name, bool markdown) {
  if (name.empty()) {
    if (markdown) {
      return print_all_markdown(std::cout);
    }
    print_names(std::cout);
    return tools::exit_success;
  }
  const ActuationModule* algorithm = find_algorithm(std::string_view(name));
  if (algorithm == nullptr) {
    std::vector<std::string> known;
    for (std::size_t i = 0; i < algorithm_count(); ++i) {
      known.emplace_back(algorithm_at(i).declaration().name);
    }
    throw InputError("NAME", 0, in_quotes(name), "one of " + listed(known));
  }
  if (markdown) {
    print_markdown(std::cout, algorithm->declaration());
  } else {
    print_text(std::cout, algorithm->declaration());
  }
  return tools::exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  proleg::tools::CommandLine command_line(
      "proleg algorithms", "Lists the algorithms that can move a robot, or the parameters of one algorithm.");
  std::string name;
  bool markdown = false;
  command_line.add_option("NAME", name, "name of an algorithm");
  command_line.add_flag("--markdown", markdown, "print Markdown tables");
  bool measures = false;
  command_line.add_flag("--measures", measures, "list the measures of a run instead (docs/gait-measures.md)")
      .excludes("NAME");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv,
                          [&] { return measures ? list_measures(std::cout, markdown) : describe(name, markdown); });
}
