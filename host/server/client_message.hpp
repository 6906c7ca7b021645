#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace proleg::host {

// The text messages of a viewer (docs/page-interface.md, "Messages").

inline constexpr std::size_t max_message_bytes = 64U << 10U;

struct Hello {
  std::uint64_t protocol = 0;
  std::string token;
  std::string name;            ///< 1 to 60 characters, none of them a control character
  bool is_only_stop = false;   ///< the viewer receives only the welcome and the answers to its own messages
  bool wants_control = false;  ///< the viewer takes control if it is alone and the server allows that
};

struct Operation {
  std::uint64_t id = 0;  ///< at most 2^53 - 1, like all numbers of messages
  std::uint64_t epoch = 0;
  std::string name;
  nlohmann::json arguments;  ///< an object
};

struct Stop {};

struct Beat {
  double age_ms = 0;  ///< at least 0
};

struct Subscribe {
  std::vector<std::string> signals;   ///< at most 64, all different
  std::optional<std::uint64_t> hash;  ///< hash of the document `telemetry` that the viewer has
  bool newest = false;                ///< the newest present row is sent, too
};

using ClientMessage = std::variant<Hello, Operation, Stop, Beat, Subscribe>;

/// Reads a message. Throws InputError for text that is not JSON, that is nested deeper than 16 levels, or that is not
/// such a message. Unknown fields are ignored.
[[nodiscard]] ClientMessage parse_client_message(std::string_view text);

}  // namespace proleg::host
