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
constexpr std::size_t longest_message = 1'000;
constexpr std::size_t most_messages = 1'000;
constexpr std::chrono::milliseconds period{20};

/// The lines of a text that comes in parts. Of a text without an end it keeps little, and passes on little.
class Messages {
 public:
  explicit Messages(const std::function<void(const std::string& line)>& pass_on) : pass_on_(pass_on) {}

  void add(std::string_view part) {
    for (std::size_t end = part.find('\n'); end != std::string_view::npos; end = part.find('\n')) {
      add_to_rest(part.substr(0, end));
      take_rest();
      part.remove_prefix(end + 1);
    }
    add_to_rest(part);
  }

  [[nodiscard]] std::string last() {
    take_rest();
    return std::exchange(last_, {});
  }

 private:
  void add_to_rest(std::string_view text) { rest_ += text.substr(0, longest_message - rest_.size()); }

  void take_rest() {
    const std::string line = std::exchange(rest_, {});
    if (trimmed(line).empty()) {
      return;
    }
    if (!last_.empty() && passed_on_ <= most_messages) {
      pass_on_(passed_on_ < most_messages ? last_ : "its further messages are not shown");
      ++passed_on_;
    }
    last_ = one_line(trimmed(line));
  }

  const std::function<void(const std::string& line)>& pass_on_;
  std::string rest_;  ///< at most longest_message
  std::string last_;
  std::size_t passed_on_ = 0;
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
