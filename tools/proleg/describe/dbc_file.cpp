#include "tools/proleg/describe/dbc_file.hpp"

#include <cmath>
#include <limits>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A string in ASCII without quotation marks: the format has no escape for them that all readers know, and not all
/// readers accept other characters.
std::string dbc_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    result += c == '"' ? '\'' : (c < ' ' || c > '~' ? '?' : c);
  }
  return result + '"';
}

std::string choices_text(const std::vector<DbcChoice>& choices) {
  std::string text;
  for (const DbcChoice& choice : choices) {
    text += ' ' + std::to_string(choice.value) + ' ' + dbc_string(choice.text);
  }
  return text + " ;\n";
}

void write_message(std::ostream& out, const DbcMessage& message) {
  out << "BO_ " << message.identifier << ' ' << message.name << ": " << message.length << ' ' << message.sender << '\n';
  for (const DbcSignal& signal : message.signals) {
    out << " SG_ " << signal.name << (signal.multiplex.empty() ? "" : " " + signal.multiplex) << " : " << signal.start
        << '|' << signal.bits << "@1" << (signal.is_signed ? '-' : '+') << " (" << exact_text(signal.factor) << ",0) ["
        << exact_text(signal.minimum) << '|' << exact_text(signal.maximum) << "] " << dbc_string(signal.unit) << ' '
        << signal.receiver << '\n';
  }
  out << '\n';
}

}  // namespace

std::string dbc_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    name += is_letter(c) || is_digit(c) ? c : '_';
  }
  return name.empty() || !is_letter(name[0]) ? "n" + name : name;
}

void set_full_range(DbcSignal& signal) {
  if (signal.bits > std::numeric_limits<double>::digits) {
    return;  // the range is not given; readers take limits as floating point
  }
  const int magnitude = static_cast<int>(signal.bits) - (signal.is_signed ? 1 : 0);
  signal.minimum = signal.is_signed ? -std::ldexp(signal.factor, magnitude) : 0.0;
  signal.maximum = (std::ldexp(1.0, magnitude) - 1.0) * signal.factor;
}

void write_dbc(std::ostream& out, const DbcFile& file) {
  out << "VERSION " << dbc_string(file.version) << "\n\nNS_ :\n\nBS_:\n\nBU_:";
  for (const DbcNode& node : file.nodes) {
    out << ' ' << node.name;
  }
  out << '\n';
  for (const DbcTable& table : file.tables) {
    out << "VAL_TABLE_ " << table.name << choices_text(table.choices);
  }
  out << '\n';
  for (const DbcMessage& message : file.messages) {
    write_message(out, message);
  }
  out << "CM_ " << dbc_string(file.comment) << ";\n";
  for (const DbcNode& node : file.nodes) {
    out << "CM_ BU_ " << node.name << ' ' << dbc_string(node.comment) << ";\n";
  }
  for (const DbcMessage& message : file.messages) {
    out << "CM_ BO_ " << message.identifier << ' ' << dbc_string(message.comment) << ";\n";
    for (const DbcSignal& signal : message.signals) {
      if (!signal.comment.empty()) {
        out << "CM_ SG_ " << message.identifier << ' ' << signal.name << ' ' << dbc_string(signal.comment) << ";\n";
      }
    }
  }
  for (const DbcMessage& message : file.messages) {
    for (const DbcSignal& signal : message.signals) {
      if (!signal.choices.empty()) {
        out << "VAL_ " << message.identifier << ' ' << signal.name << choices_text(signal.choices);
      }
    }
  }
}

}  // namespace proleg::tools
