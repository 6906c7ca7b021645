#include "sim/data_file/data_frame_text.hpp"

#include <array>
#include <charconv>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {
namespace {

void append_number(std::string& text, double value) {
  constexpr int digits = 9;
  std::array<char, 32> characters{};
  const auto end =
      std::to_chars(characters.data(), characters.data() + characters.size(), value, std::chars_format::general, digits)
          .ptr;
  text.append(characters.data(), end);
}

std::string joined_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : " ") + list_name(name);
  }
  return text;
}

}  // namespace

std::string list_name(std::string_view text) {
  std::string name;
  for (const char c : one_line(text)) {
    name += std::string_view(" <>&\"'").find(c) == std::string_view::npos ? c : '_';
  }
  return name.empty() ? "_" : name;
}

std::string tag_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool may_follow = (c >= '0' && c <= '9') || c == '-' || c == '.';
    name += is_letter || (may_follow && !name.empty()) ? c : '_';
  }
  return name.empty() ? "_" : name;
}

DataModuleText::DataModuleText(const std::string& name, std::vector<std::string> types,
                               const std::vector<std::string>& names, const std::vector<std::string>& joint_names)
    : name_(tag_name(name)),
      types_(std::move(types)),
      names_(joined_names(names)),
      joint_names_(joined_names(joint_names)),
      parts_(names.size()) {
  for (std::string& type : types_) {
    type = tag_name(type);
  }
}

std::string DataModuleText::header() const {
  std::string text = "    <" + name_ + " parts=\"" + std::to_string(parts_) + "\" types=\"" +
                     std::to_string(types_.size() + 3) + "\" names=\"" + names_ + "\"";
  if (!joint_names_.empty()) {
    text += " jointnames=\"" + joint_names_ + "\"";
  }
  text += ">\n      <typenames>";
  for (const std::string& type : types_) {
    text += type + " ";
  }
  return text + "realtime simtime stepcount</typenames>\n    </" + name_ + ">\n";
}

void DataModuleText::begin_frame(std::uint32_t index, double realtime_ms, double simtime_ms) {
  constexpr int microseconds = 3;  // number of decimals
  frames_ += "      <frame index=\"" + std::to_string(index) + "\" realtime=\"" +
             plain_number(realtime_ms, microseconds) + "\" simtime=\"" + plain_number(simtime_ms, microseconds) +
             "\">\n";
  next_type_ = 0;
}

void DataModuleText::add(std::span<const double> numbers) {
  const std::string& type = types_[next_type_++];
  frames_ += "        <" + type + ">";
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    frames_ += i == 0 ? "" : " ";
    append_number(frames_, numbers[i]);
  }
  frames_ += "</" + type + ">\n";
}

std::string DataModuleText::finish_round() {
  return "    <" + name_ + ">\n" + std::exchange(frames_, {}) + "    </" + name_ + ">\n";
}

}  // namespace proleg::sim
