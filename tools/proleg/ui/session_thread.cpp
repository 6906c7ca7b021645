#include "tools/proleg/ui/session_thread.hpp"

#include <chrono>
#include <deque>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {

void SessionThread::begin_thread() {
  thread_ = std::thread([this] { run(); });
}

void SessionThread::end_thread() {
  requests_.end();
  thread_.join();
}

/// An error that left the thread would end the program, and leave a robot with power behind.
void SessionThread::run() {
  constexpr std::chrono::milliseconds pause_after_error{20};
  while (!requests_.ends()) {
    try {
      serve();
      last_error_.clear();
    } catch (const std::exception& error) {
      const std::string why = one_line(error.what());
      report(why);
      try {
        fail(why);
      } catch (const std::exception& second) {
        report(one_line(second.what()));
      }
      std::this_thread::sleep_for(pause_after_error);  // an error that stays does not take the processor
    }
  }
  try {
    close();
  } catch (const std::exception& error) {
    report(one_line(error.what()));
  }
}

/// An error that stays is reported once.
void SessionThread::report(const std::string& error) {
  if (error != last_error_) {
    output_.notice(host::NoticeLevel::error, error);
    last_error_ = error;
  }
}

SessionThread::Stops SessionThread::take_stops() {
  std::deque<host::OperationRequest> outdated;
  Stops stops = requests_.take_stops(outdated);
  for (const host::OperationRequest& operation : outdated) {
    output_.refuse(operation.request, "STOP came first");
  }
  return stops;
}

bool SessionThread::take_operations() {
  bool is_any = false;
  while (const std::optional<host::OperationRequest> operation = requests_.take_operation()) {
    is_any = true;
    try {
      output_.answer(operation->request, carry_out(*operation));
    } catch (const std::exception& error) {
      output_.refuse(operation->request, one_line(error.what()));
    }
  }
  return is_any;
}

}  // namespace proleg::tools
