#include "tools/proleg/flash/update_run.hpp"

#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/flash/flash_modules.hpp"

namespace proleg::tools {
namespace {

using host::RobotUpdate;

/// A bar for each module on standard error, drawn again and again. Nothing if standard error is no terminal.
class Bars {
 public:
  Bars() : line_(std::chrono::milliseconds(0)) {}
  ~Bars() { erase(); }
  Bars(const Bars&) = delete;
  Bars& operator=(const Bars&) = delete;

  struct Bar {
    std::string name;
    double part = 0;  ///< 0 to 1
    std::string state;
  };
  /// True at most ten times a second: time to draw.
  [[nodiscard]] bool is_due() { return line_.is_due(); }
  /// Terminals with fewer lines show the first ones.
  void draw(const std::vector<Bar>& bars);
  void erase();

 private:
  TerminalLine line_;
  std::size_t drawn_ = 0;  ///< lines
};

constexpr std::size_t bar_width = 24;

std::size_t max_lines() {
  winsize size{};
  return (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 2 ? size.ws_row : std::size_t{24}) - 1;
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

void Bars::draw(const std::vector<Bar>& bars) {
  if (!line_.is_visible()) {
    return;
  }
  std::size_t name_width = 0;
  for (const Bar& bar : bars) {
    name_width = std::max(name_width, bar.name.size());
  }
  std::string text;
  const std::size_t lines = std::min(bars.size(), max_lines());
  for (std::size_t i = 0; i < lines; ++i) {
    const Bar& bar = bars[i];
    const auto filled =
        static_cast<std::size_t>(std::lround(std::clamp(bar.part, 0.0, 1.0) * static_cast<double>(bar_width)));
    std::string line = padded(bar.name, name_width) + "  [" + std::string(filled, '#') +
                       std::string(bar_width - filled, '.') + "]  " + bar.state;
    line.resize(std::min(line.size(), TerminalLine::max_width()));
    text += "\r\033[K" + line + '\n';
  }
  erase();
  std::cerr << text << std::flush;
  drawn_ = lines;
}

void Bars::erase() {
  if (drawn_ != 0) {
    // Back to the first of them, and away with all below.
    std::cerr << "\033[" << drawn_ << "A\r\033[J" << std::flush;
    drawn_ = 0;
  }
}

std::string state_of(const RobotUpdate& update, const host::UpdatedModule& module) {
  if (module.outcome != host::UpdateOutcome::pending) {
    return describe(module.outcome, module.detail);
  }
  switch (update.step()) {
    case RobotUpdate::Step::transfer:
      return module.has_image ? "waits for the others" : "receives the image";
    case RobotUpdate::Step::installation:
      return "installs it";
    default:
      return "restarts";
  }
}

/// Shows how far an update is: as bars, or with --json-lines as events.
class UpdateProgress {
 public:
  /// All must outlive this.
  UpdateProgress(const ProgramReport& report, const RobotUpdate& update, std::span<const host::FlashCandidate> modules)
      : report_(report), update_(update), modules_(modules) {}

  /// Cheap; shows it at most ten times a second.
  void show();
  /// To be called when the update is done.
  void show_end();

 private:
  void draw_bars();
  void print_progress() const;
  void print_ended() const;
  /// 0 to 1.
  [[nodiscard]] double part(const host::UpdatedModule& module) const {
    return module.has_image ? 1.0 : update_.progress();
  }

  const ProgramReport& report_;
  const RobotUpdate& update_;
  std::span<const host::FlashCandidate> modules_;
  Bars bars_;
  LogInterval event_interval_{std::chrono::steady_clock::now(), std::chrono::milliseconds(100)};
};

void UpdateProgress::show() {
  if (!report_.has_events()) {
    draw_bars();
  } else if (event_interval_.is_due(std::chrono::steady_clock::now())) {
    print_progress();
  }
}

void UpdateProgress::show_end() {
  bars_.erase();
  print_progress();
  print_ended();
}

void UpdateProgress::draw_bars() {
  if (!bars_.is_due()) {
    return;
  }
  std::vector<Bars::Bar> bars;
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    const host::UpdatedModule& module = update_.modules()[i];
    bars.push_back({name_of(modules_[i]), part(module), state_of(update_, module)});
  }
  bars_.draw(bars);
}

void UpdateProgress::print_progress() const {
  Json list = Json::empty_array();
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    const host::UpdatedModule& module = update_.modules()[i];
    list.append({{"node", modules_[i].node},
                 {"serial", module.serial},
                 {"part", part(module)},
                 {"state", state_of(update_, module)}});
  }
  report_.print_event("progress", {{"modules", list}});
}

void UpdateProgress::print_ended() const {
  Json list = Json::empty_array();
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    const host::UpdatedModule& module = update_.modules()[i];
    list.append({{"node", modules_[i].node},
                 {"serial", module.serial},
                 {"outcome", describe(module.outcome, module.detail)},
                 {"good", module.outcome == host::UpdateOutcome::runs}});
  }
  report_.print_event("ended", {{"modules", list}});
}

void follow(host::BusConnection& bus, const RobotUpdate& update, UpdateProgress& progress, bool through_its_line,
            const std::string& hint) {
  constexpr Microseconds longest = 300'000'000;  // it ends by itself; this bounds one with a fault
  constexpr Microseconds drawing_period = 50'000;
  // A connection may come back: the line of a gateway ends for a while, and a plug may be loose.
  const Microseconds longest_loss = through_its_line ? longest : 8'000'000;
  const Microseconds end = bus.now() + longest;
  Microseconds connected_at = bus.now();
  while (!update.is_done()) {
    bus.run_until(bus.now() + drawing_period, [&update] { return update.is_done() || interrupted(); });
    if (interrupted()) {
      throw std::runtime_error("interrupted; a module that was installing goes on by itself, and starts its program" +
                               hint);
    }
    if (bus.state().is_connected) {
      connected_at = bus.now();
    } else if (bus.now() - connected_at > longest_loss) {
      throw std::runtime_error(bus.diagnosis() +
                               "; modules that have the whole image install it by themselves, and the same command "
                               "again completes what is missing" +
                               hint);
    }
    if (bus.now() > end) {
      throw std::runtime_error("no end after 5 minutes");
    }
    progress.show();
  }
  progress.show_end();
}

}  // namespace

std::uint8_t new_session(BusAccess& bus) {
  constexpr Microseconds sessions = 0xFF;
  return static_cast<std::uint8_t>(1 + bus.connection().now() % sessions);
}

UpdateRun run_update(BusAccess& bus, std::span<const std::uint8_t> image, std::span<const host::FlashCandidate> modules,
                     bool through_its_line, const ProgramReport& report, const std::string& hint) {
  std::vector<std::uint32_t> serials;
  for (const host::FlashCandidate& module : modules) {
    serials.push_back(module.program.serial);
  }
  host::UpdateOptions options;
  options.session = new_session(bus);
  options.through_its_line = through_its_line;
  host::BusConnection& connection = bus.connection();
  RobotUpdate update(connection, image, serials, options);
  const host::BusAttachment attachment(connection, update);
  update.start(connection.now());
  UpdateProgress progress(report, update, modules);
  follow(connection, update, progress, through_its_line, hint);
  const auto seconds = [&update](RobotUpdate::Step step) { return static_cast<double>(update.duration(step)) / 1e6; };
  return {update.modules(),
          {seconds(RobotUpdate::Step::transfer), seconds(RobotUpdate::Step::installation),
           seconds(RobotUpdate::Step::restart)}};
}

}  // namespace proleg::tools
