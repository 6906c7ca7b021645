#include "tools/proleg/ui/json_program.hpp"

namespace proleg::tools {
void JsonProgram::start(const std::vector<std::string>& command, std::chrono::seconds longest) {
  program_ = std::make_unique<CommandSequence>(std::vector<std::vector<std::string>>{command}, folder().string(),
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
  const std::string line = without_program_name(last_line_of(program_->errors()));
  return End{nullptr, line.empty() ? "it ended with status " + std::to_string(end->status) : line};
}

}  // namespace proleg::tools
