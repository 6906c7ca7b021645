#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "host/server/notice_level.hpp"
#include "host/server/robot_session.hpp"
#include "host/server/signal_layout.hpp"

namespace proleg::host {

/// Receives the output of a session for its viewers (docs/page-interface.md). Any thread may call these functions;
/// none of them waits.
class SessionOutput {
 public:
  /// Publishes a new revision of a document. The server makes the documents `control` and `telemetry` itself.
  virtual void publish(const std::string& document, const nlohmann::json& value) = 0;
  /// Sets the layout of later rows, and forgets earlier rows. tick_us: duration of a tick in microseconds. Must be
  /// called by the thread that calls add_row().
  virtual void set_signals(const SignalLayout& layout, std::uint32_t tick_us) = 0;
  /// Adds the values of all signals of a tick. Ticks of a run follow one another; two runs in a row have different
  /// numbers. Throws std::invalid_argument if the row does not have the layout's size.
  virtual void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) = 0;
  /// Reports that the operation had its effect. `value`: the result for the viewer. Bytes (json::binary) are sent as a
  /// binary message.
  virtual void answer(RequestId request, const nlohmann::json& value) = 0;
  /// Reports with one line that the operation was refused.
  virtual void refuse(RequestId request, const std::string& error) = 0;
  /// Reports that STOP has had its effect in `confirmed` of `of` modules, `ms` after the request.
  virtual void stopped(RequestId request, unsigned confirmed, unsigned of, double ms) = 0;
  /// Sends one line to all viewers.
  virtual void notice(NoticeLevel level, const std::string& text) = 0;

 protected:
  ~SessionOutput() = default;
};

}  // namespace proleg::host
