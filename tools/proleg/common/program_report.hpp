#pragma once

// The forms in which a program reports what it does: text for people, one JSON object at its end (--json), or one JSON
// object for each event (--json-lines).

#include <initializer_list>
#include <string_view>

#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {

class CommandLine;

/// By default the form is text for people.
class ProgramReport {
 public:
  /// Adds --json and --json-lines, which exclude each other. This object must outlive the command line.
  void add_options(CommandLine& command_line);
  /// To be called before work begins: with --json-lines a reader that ends does not end this program by SIGPIPE, so
  /// that it can clean up.
  void begin() const;

  /// Whether the result is text for people.
  [[nodiscard]] bool is_text() const { return !is_object_ && !has_events_; }
  [[nodiscard]] bool has_events() const { return has_events_; }

  /// With --json-lines prints {"event": NAME, members...} on a line of standard output, at once. Otherwise does
  /// nothing. Throws std::runtime_error if it cannot be written.
  void print_event(std::string_view name, std::initializer_list<JsonMember> members) const;
  /// Prints the object of --json, or the last event, `result`, which has this object as its value. Does nothing if the
  /// form is text. Throws as print_event().
  void print_result(const Json& value) const;

 private:
  bool is_object_ = false;
  bool has_events_ = false;
};

}  // namespace proleg::tools
