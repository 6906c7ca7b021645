#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tools/proleg/ui/page_access.hpp"

namespace proleg::tools {

/// `proleg ui --class`: one address, at which each learner of a class gets a robot, and a teacher sees all.
struct ClassOptions {
  std::string seats_per_address;        ///< of the command line
  std::string learners;                 ///< the greatest number of robots that run at a time; of the command line
  std::optional<std::string> scenario;  ///< with which all begin
  std::filesystem::path folder;         ///< of the class; made if there is none
  std::filesystem::path page;           ///< folder of the page
  std::uint16_t port = 0;
  LanOptions lan;
  bool allow_code = false;
  bool no_browser = false;
};

/// Returns at the end of the program, with its exit status. Throws InputError, BadInput, FileError.
[[nodiscard]] int serve_class(const ClassOptions& options);

}  // namespace proleg::tools
