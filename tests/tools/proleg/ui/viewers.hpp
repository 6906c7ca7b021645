#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>

#include "host/server/robot_session.hpp"

namespace proleg::tools {

/// What the session has told its viewers.
class Viewers final : public host::SessionOutput {
 public:
  struct Answer {
    bool is_done;
    std::string text;
  };

 private:
  template <typename Action>
  void change(const Action& action) {
    const std::lock_guard lock(mutex_);
    action();
    changed_.notify_all();
  }
  template <typename Condition, typename Result>
  auto when(const Condition& condition, const Result& result) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, std::chrono::minutes(5), condition)) {
      throw std::runtime_error("it did not come in 2 minutes");
    }
    return result();
  }

 public:
  void publish(const std::string& document, const nlohmann::json& value) override {
    change([&] { documents_[document] = value; });
  }
  void set_signals(const host::SignalLayout& layout, std::uint32_t /*tick_us*/) override {
    row_size_ = layout.row_size();
  }
  void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) override {
    if (tick == fails_at_tick) {
      throw std::invalid_argument("a row without signals");
    }
    change([&] {
      is_gapless_ = is_gapless_ && (tick == 0 || (tick == last_tick_ + 1 && run == run_)) && row.size() == row_size_;
      run_ = run;
      last_tick_ = tick;
      ++rows_;
    });
  }
  void answer(std::uint64_t request, const nlohmann::json& value) override {
    change([&] { answers_[request] = {true, value.dump()}; });
  }
  void refuse(std::uint64_t request, const std::string& why) override {
    change([&] { answers_[request] = {false, why}; });
  }
  void stopped(std::uint64_t request, unsigned confirmed, unsigned joints, double /*milliseconds*/) override {
    change([&] { answers_[request] = {true, std::to_string(confirmed) + " of " + std::to_string(joints)}; });
  }
  void notice(host::NoticeLevel /*level*/, const std::string& text) override {
    change([&] { notices_ += text + '\n'; });
  }

  Answer answer(std::uint64_t request) {
    return when([&] { return answers_.contains(request); }, [&] { return answers_[request]; });
  }
  /// The document `session`, when it is as it is waited for.
  nlohmann::json session(const std::function<bool(const nlohmann::json&)>& is_so) {
    return document_when("session", is_so);
  }
  nlohmann::json state(const std::string& name) {
    return session([&](const nlohmann::json& document) { return document["state"] == name; });
  }
  /// A document, when it is as it is waited for.
  nlohmann::json document_when(const std::string& name, const std::function<bool(const nlohmann::json&)>& is_so) {
    nlohmann::json document;
    return when([&] { return is_so(document = documents_[name]); }, [&] { return document; });
  }
  nlohmann::json document(const std::string& name) {
    return when([] { return true; }, [&] { return documents_[name]; });
  }
  void wait_for_tick(std::uint32_t tick) {
    when([&] { return rows_ > 0 && last_tick_ >= tick; }, [] { return 0; });
  }
  std::string notices() {
    return when([] { return true; }, [&] { return notices_; });
  }
  std::uint64_t rows() {
    return when([] { return true; }, [&] { return rows_; });
  }
  bool is_gapless() {
    return when([] { return true; }, [&] { return is_gapless_; });
  }

  std::atomic<std::uint32_t> fails_at_tick = 0xFFFF'FFFF;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, nlohmann::json> documents_;
  std::map<std::uint64_t, Answer> answers_;
  std::string notices_;
  std::size_t row_size_ = 0;
  std::uint64_t rows_ = 0;
  std::uint32_t last_tick_ = 0;
  std::uint16_t run_ = 0;
  bool is_gapless_ = true;
};

}  // namespace proleg::tools
