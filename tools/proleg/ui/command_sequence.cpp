#include "tools/proleg/ui/command_sequence.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {

std::string last_line_of(std::string_view output) {
  std::string last;
  TextLines lines(output);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (!trimmed(*line).empty()) {
      last = one_line(trimmed(*line));
    }
  }
  return last;
}

std::string last_line_of_file(const std::filesystem::path& log) {
  constexpr std::streamoff most = 64 * 1024;
  std::ifstream file(log, std::ios::binary);
  if (std::error_code error; !std::filesystem::is_regular_file(log, error) || !file.seekg(0, std::ios::end)) {
    return {};
  }
  file.seekg(std::max<std::streamoff>(0, file.tellg() - most));
  return last_line_of(std::string(std::istreambuf_iterator<char>(file), {}));
}

std::string without_program_name(const std::string& line) {
  const std::size_t name_end = line.starts_with("proleg ") ? line.find(": ") : std::string::npos;
  return name_end == std::string::npos ? line : line.substr(name_end + 2);
}

CommandSequence::CommandSequence(std::vector<std::vector<std::string>> commands, std::string folder,
                                 std::chrono::seconds longest, ChildProgram::Errors errors)
    : commands_(std::move(commands)), folder_(std::move(folder)), errors_kind_(errors), until_(Clock::now() + longest) {
  start_next();
}

void CommandSequence::start_next() {
  child_ = std::make_unique<ChildProgram>(commands_.front(), folder_, errors_kind_);
  commands_.erase(commands_.begin());
}

std::optional<CommandSequence::End> CommandSequence::look() {
  const std::optional<int> status = child_->status();
  const std::string output = child_->read();
  if (output_.size() + output.size() <= most_output) {
    output_ += output;
  }
  errors_ += child_->read_errors();
  errors_.erase(0, errors_.size() - std::min(errors_.size(), most_errors));
  if (!status) {
    if (Clock::now() >= until_ && !is_late_) {
      is_late_ = true;
      child_->end();
    }
    return std::nullopt;
  }
  if (*status == 0 && !commands_.empty() && !is_cancelled_ && !is_late_) {
    start_next();
    return std::nullopt;
  }
  return End{is_cancelled_, is_late_, *status};
}

void CommandSequence::cancel() {
  is_cancelled_ = true;
  child_->end();
}

}  // namespace proleg::tools
