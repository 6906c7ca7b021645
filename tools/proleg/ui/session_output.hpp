#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "tools/proleg/ui/telemetry_row.hpp"

namespace proleg::tools {

enum class NoticeLevel : std::uint8_t { info, warning, error };

/// What a session tells its viewers (docs/page-interface.md). Every function may be called from any thread and does not
/// wait.
class SessionOutput {
 public:
  virtual ~SessionOutput() = default;

  /// A document has a new value.
  virtual void publish(const std::string& document, const nlohmann::json& value) = 0;
  virtual void set_signals(const std::vector<Signal>& signals, std::uint32_t tick_us) = 0;
  /// The values of all signals at a tick. Ticks of a run ascend.
  virtual void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) = 0;
  /// A request was carried out.
  virtual void done(std::uint64_t request, const nlohmann::json& value) = 0;
  /// A request had no effect.
  virtual void refused(std::uint64_t request, const std::string& why) = 0;
  /// Joints that have confirmed a stop, of all joints, and the time since the request.
  virtual void stopped(std::uint64_t request, unsigned confirmed, unsigned joints, double milliseconds) = 0;
  virtual void notice(NoticeLevel level, const std::string& text) = 0;
};

}  // namespace proleg::tools
