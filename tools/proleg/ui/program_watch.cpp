#include "tools/proleg/ui/program_watch.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"

namespace proleg::tools {

host::DocumentFiles served_documentation() {
  const std::optional<std::filesystem::path> folder = documentation_folder();
  return folder ? host::DocumentFiles(*folder, "/docs/") : host::DocumentFiles();
}

ProgramWatch::ProgramWatch(const std::string& page_program, host::SessionOutput& page)
    : page_(page), is_other_version_(page_program != build_id), look_at_(Clock::now()) {
  publish();
}

void ProgramWatch::look(Clock::time_point now) {
  constexpr std::chrono::seconds period{2};
  if (is_replaced_ || now < look_at_) {
    return;
  }
  look_at_ = now + period;
  if (is_program_replaced()) {
    is_replaced_ = true;
    publish();
    print_warning("proleg ui",
                  "its files were replaced or removed, as by an update; it goes on, and what it starts is of "
                  "the new version: save your work, and start it again");
  }
}

void ProgramWatch::publish() {
  page_.publish("program", {{"version", build_id},
                            {"has_documentation", documentation_folder().has_value()},
                            {"is_replaced", is_replaced_},
                            {"is_other_version", is_other_version_}});
}

}  // namespace proleg::tools
