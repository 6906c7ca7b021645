#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/common/scratch_folder.hpp"
#include "tools/proleg/ui/command_sequence.hpp"

namespace proleg::tools {

/// A program of ours that prints one JSON object (`--json`), beside this one, with a folder for its files. The end of
/// this object ends the program and removes the folder.
class JsonProgram {
 public:
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }

  /// Starts it in the folder. Throws std::runtime_error if it cannot be started.
  void start(const std::vector<std::string>& command, std::chrono::seconds longest);

  struct End {
    nlohmann::json object;  ///< null: it has printed none
    std::string error;      ///< why there is none, in one line
  };
  /// Nothing as long as it runs. Does not wait.
  [[nodiscard]] std::optional<End> look();

 private:
  ScratchFolder folder_;
  std::unique_ptr<CommandSequence> program_;
};

}  // namespace proleg::tools
