#pragma once

// The text of a data file, module by module, while its frames come tick by tick.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::sim {

/// A module of the header, and its frames since the last round.
class DataModuleText {
 public:
  /// names: of the parts. joint_names: for types with a number for each joint; empty if no type has such.
  DataModuleText(const std::string& name, std::vector<std::string> types, const std::vector<std::string>& names,
                 const std::vector<std::string>& joint_names = {});

  /// Its element in <header>.
  [[nodiscard]] std::string header() const;

  void begin_frame(std::uint32_t index, double realtime_ms, double simtime_ms);
  /// The numbers of the next type, in the order of the types.
  void add(std::span<const double> numbers);
  void end_frame() { frames_ += "      </frame>\n"; }

  /// Its element in <round>; then the frames are empty.
  [[nodiscard]] std::string finish_round();

 private:
  std::string name_;
  std::vector<std::string> types_;
  std::string names_;
  std::string joint_names_;
  std::size_t parts_;
  std::size_t next_type_ = 0;
  std::string frames_;
};

/// A text as a tag or as a name in a list: what neither can hold becomes '_'.
[[nodiscard]] std::string tag_name(std::string_view text);
[[nodiscard]] std::string list_name(std::string_view text);

}  // namespace proleg::sim
