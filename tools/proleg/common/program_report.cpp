#include "tools/proleg/common/program_report.hpp"

#include <csignal>
#include <iostream>
#include <stdexcept>

#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

void ProgramReport::add_options(CommandLine& command_line) {
  command_line.add_flag("--json", is_object_, "print one JSON object");
  command_line
      .add_flag("--json-lines", has_events_,
                "print one JSON object for each event, each on a line; the last one has the object of --json")
      .excludes("--json");
}

void ProgramReport::begin() const {
  if (has_events_) {
    std::signal(SIGPIPE, SIG_IGN);
  }
}

void ProgramReport::print_event(std::string_view name, std::initializer_list<JsonMember> members) const {
  if (!has_events_) {
    return;
  }
  Json event{{"event", name}};
  for (const JsonMember& member : members) {
    event.add(member.key, member.value);
  }
  std::cout << event.line() << '\n';
  if (!std::cout.flush()) {
    throw std::runtime_error("cannot write to standard output");
  }
}

void ProgramReport::print_result(const Json& value) const {
  if (is_object_) {
    std::cout << value.text() << '\n';
  }
  print_event("result", {{"value", value}});
}

}  // namespace proleg::tools
