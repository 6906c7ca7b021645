#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace proleg::sim {

/// A start tag without its end tag, or a comment without its end.
struct UnpairedTag {
  int line = 0;
  std::string found;     ///< for a message: "<Joint> without an end tag before </KinBody> in line 50"
  std::string expected;  ///< "</Joint>"
};

/// The first one of a text; nothing if every start tag has its end tag.
[[nodiscard]] std::optional<UnpairedTag> find_unpaired_tag(std::string_view text);

/// The first comment of a text that does not end, or that has another "<!--" before its end. XML allows neither, and a
/// parser would take what follows for comment, up to the end of the next one.
[[nodiscard]] std::optional<UnpairedTag> find_unclosed_comment(std::string_view text);

}  // namespace proleg::sim
