#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "host/server/notice_level.hpp"
#include "host/server/robot_session.hpp"
#include "host/server/signal_layout.hpp"

namespace proleg::host {

/// What a session tells its viewers (docs/page-interface.md). Any thread may call these functions; none of them waits.
class SessionOutput {
 public:
  /// A new revision of a document. `control` and `telemetry` are the server's own.
  virtual void publish(const std::string& document, const nlohmann::json& value) = 0;
  /// From now on rows have this layout; the rows before are forgotten. tick_us: duration of a tick in microseconds.
  /// The thread that calls add_row() calls this.
  virtual void set_signals(const SignalLayout& layout, std::uint32_t tick_us) = 0;
  /// The values of all signals of a tick. Ticks of a run follow one another; a run has another number than the one
  /// before it. Throws std::invalid_argument if the row does not have the layout's size.
  virtual void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) = 0;
  /// The operation had its effect. `value`: what the viewer gets. Bytes (json::binary) are sent as a binary message.
  virtual void answer(RequestId request, const nlohmann::json& value) = 0;
  /// The operation was refused, with one line.
  virtual void refuse(RequestId request, const std::string& error) = 0;
  /// STOP has had its effect in `confirmed` of `of` modules, `ms` after the request.
  virtual void stopped(RequestId request, unsigned confirmed, unsigned of, double ms) = 0;
  /// One line for all viewers.
  virtual void notice(NoticeLevel level, const std::string& text) = 0;

 protected:
  ~SessionOutput() = default;
};

}  // namespace proleg::host
