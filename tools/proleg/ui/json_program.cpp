#include "tools/proleg/ui/json_program.hpp"

#include <cstdlib>
#include <stdexcept>
#include <system_error>

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// "proleg optimise: TEXT" without the name of the program.
std::string without_program(const std::string& line) {
  const std::size_t name_end = line.starts_with("proleg ") ? line.find(": ") : std::string::npos;
  return name_end == std::string::npos ? line : line.substr(name_end + 2);
}

}  // namespace

JsonProgram::JsonProgram() {
  std::string folder = (fs::temp_directory_path() / "proleg_ui_XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw std::runtime_error("cannot make a folder in " + fs::temp_directory_path().string());
  }
  folder_ = folder;
}

JsonProgram::~JsonProgram() {
  program_.reset();
  std::error_code error;  // what is left does no harm
  fs::remove_all(folder_, error);
}

void JsonProgram::start(const std::vector<std::string>& command, std::chrono::seconds longest) {
  program_ = std::make_unique<CommandSequence>(std::vector<std::vector<std::string>>{command}, folder_.string(),
                                               longest, ChildProgram::Errors::apart);
}

std::optional<JsonProgram::End> JsonProgram::look() {
  const std::optional<CommandSequence::End> end = program_->look();
  if (!end) {
    return std::nullopt;
  }
  if (end->is_late) {
    return End{nullptr, "it took too long, and was ended"};
  }
  if (nlohmann::json object = nlohmann::json::parse(program_->output(), nullptr, false); object.is_object()) {
    return End{std::move(object), ""};
  }
  const std::string line = without_program(last_line_of(program_->errors()));
  return End{nullptr, line.empty() ? "it ended with status " + std::to_string(end->status) : line};
}

}  // namespace proleg::tools
