#pragma once

// A DBC file: the messages of a CAN bus and their signals, for cantools, SavvyCAN and other tools.

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace proleg::tools {

/// A name for a raw value.
struct DbcChoice {
  std::int64_t value;
  std::string text;
};

/// Name in the place of a node that means no particular one.
inline constexpr const char* any_node = "Vector__XXX";

/// All signals are little-endian: the lowest bit is the start bit. value = raw * factor.
struct DbcSignal {
  std::string name;
  unsigned start = 0;  ///< bit 8 is the lowest bit of byte 1
  unsigned bits = 1;
  bool is_signed = false;
  double factor = 1.0;
  double minimum = 0.0;  ///< bounds of the value, in the unit; both 0: not given
  double maximum = 0.0;
  std::string unit = {};
  std::string receiver = any_node;
  std::string comment = {};
  std::vector<DbcChoice> choices = {};
  /// "M": this signal selects the others by its value; "m3": the frame has it if that value is 3; "": the frame always
  /// has it.
  std::string multiplex = {};
};

struct DbcMessage {
  std::uint16_t identifier;
  std::string name;
  unsigned length;  ///< bytes
  std::string sender;
  std::string comment;
  std::vector<DbcSignal> signals = {};
};

struct DbcNode {
  std::string name;
  std::string comment;
};

/// Names of values that have no fixed place in a frame.
struct DbcTable {
  std::string name;
  std::vector<DbcChoice> choices;
};

struct DbcFile {
  std::string version;
  std::string comment;
  std::vector<DbcNode> nodes;
  std::vector<DbcTable> tables;
  std::vector<DbcMessage> messages;
};

/// Longest name that old tools accept.
inline constexpr std::size_t max_dbc_name = 32;

/// Text with all characters but ASCII letters and digits replaced by '_', with a letter at the start.
[[nodiscard]] std::string dbc_name(std::string_view text);

/// The range of the raw values of the signal's bits, times its factor; not given if a double cannot hold it.
void set_full_range(DbcSignal& signal);

void write_dbc(std::ostream& out, const DbcFile& file);

}  // namespace proleg::tools
