#include "tools/proleg/search/watched_child.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

constexpr std::size_t most_output = 1'000'000;
constexpr std::chrono::milliseconds period{20};

/// The lines of a text that comes in parts.
class Messages {
 public:
  explicit Messages(const std::function<void(const std::string& line)>& pass_on) : pass_on_(pass_on) {}

  void add(const std::string& part) {
    rest_ += part;
    for (std::size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n')) {
      take(rest_.substr(0, end));
      rest_.erase(0, end + 1);
    }
  }

  [[nodiscard]] std::string last() {
    take(std::exchange(rest_, {}));
    return std::exchange(last_, {});
  }

 private:
  void take(const std::string& line) {
    if (trimmed(line).empty()) {
      return;
    }
    if (!last_.empty()) {
      pass_on_(last_);
    }
    last_ = one_line(trimmed(line));
  }

  const std::function<void(const std::string& line)>& pass_on_;
  std::string rest_;
  std::string last_;
};

}  // namespace

ChildEnd wait_for_end(ChildProgram& child, std::chrono::duration<double> longest, const std::function<bool()>& stop,
                      const std::function<void(const std::string& line)>& pass_on) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point until = Clock::now() + std::chrono::duration_cast<Clock::duration>(longest);
  ChildEnd end{ChildEnd::Reason::itself, 0, {}, {}};
  Messages messages(pass_on);
  while (true) {
    const std::optional<int> status = child.status();  // before the output: what it wrote until its end is read
    const std::string output = child.read();
    end.output += output.substr(0, most_output - std::min(most_output, end.output.size()));
    messages.add(child.read_errors());
    if (status) {
      end.status = *status;
      end.last_message = messages.last();
      return end;
    }
    if (end.reason == ChildEnd::Reason::itself && (stop() || Clock::now() >= until)) {
      end.reason = stop() ? ChildEnd::Reason::stopped : ChildEnd::Reason::late;
      child.end();
    }
    std::this_thread::sleep_for(period);
  }
}

}  // namespace proleg::tools
