#pragma once

// The program of a seat of a class: what it gets from the class on its standard input (SeatProgram), and what it does
// with it.

#include <atomic>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <thread>

#include "host/server/request_policy.hpp"
#include "host/server/web_server.hpp"
#include "tools/proleg/ui/seat_limits.hpp"

namespace proleg::tools {

struct SeatSettings {
  host::AccessToken token;
  std::string name;
  bool is_teacher = false;
  bool may_write_code = false;
  bool is_open_to_network = false;
  std::optional<SeatLimits> limits;  ///< nothing: of the teacher
  std::string page_program;          ///< build id of the class, which serves the page
};

/// Lines of standard input. A wait for one ends.
class InputLines {
 public:
  enum class Wait { line, nothing, end };

  /// Waits for at most so long. The line is that of take().
  [[nodiscard]] Wait wait(int milliseconds);
  [[nodiscard]] std::string take();

 private:
  std::string rest_;
  bool has_ended_ = false;
};

/// The first line. Throws BadInput if it does not come within seconds, or is none.
[[nodiscard]] SeatSettings read_seat_settings(InputLines& lines);

/// Does what the class asks for, in a thread of its own, and ends the program when the class has ended.
class SeatInput {
 public:
  /// Publishes the documents `seat` and `handed_out`. lines, page: must outlive this.
  SeatInput(const SeatSettings& settings, InputLines& lines, host::WebServer& page);
  ~SeatInput();
  SeatInput(const SeatInput&) = delete;
  SeatInput& operator=(const SeatInput&) = delete;

 private:
  void run();
  void take_line(const std::string& line, nlohmann::json& handed_out, unsigned& handed_number);

  InputLines& lines_;
  host::WebServer& page_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace proleg::tools
