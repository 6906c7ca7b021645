#pragma once

// Makes the text of a data file, module by module, while its frames come tick by tick.

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
  /// names: names of the parts. joint_names: names for types with a number for each joint; empty if there is no such
  /// type.
  DataModuleText(const std::string& name, std::vector<std::string> types, const std::vector<std::string>& names,
                 const std::vector<std::string>& joint_names = {});

  /// The module's element in <header>.
  [[nodiscard]] std::string header() const;

  void begin_frame(std::uint32_t index, double realtime_ms, double simtime_ms);
  /// Adds the numbers of the next type, in the order of the types.
  void add(std::span<const double> numbers);
  void end_frame() { frames_ += "      </frame>\n"; }

  /// Returns the module's element in <round> and removes the frames.
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

/// A text as a tag or as a name in a list: characters that these cannot contain become '_'.
[[nodiscard]] std::string tag_name(std::string_view text);
[[nodiscard]] std::string list_name(std::string_view text);

}  // namespace proleg::sim
