#include "sim/optimize/evaluation/message_socket.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <system_error>

#include "sim/optimize/evaluation/worker_process.hpp"
#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

/// No system gives a socket so much room without the rights of an administrator.
constexpr std::size_t too_many_bytes = 64U << 20U;

TEST(MessageSocket, KeepsMessagesSeparate) {
  const auto [one, other] = make_message_sockets();
  ASSERT_TRUE(send_message(one, Bytes(3, std::byte{1})));
  ASSERT_TRUE(send_message(one, Bytes(100'000, std::byte{2})));
  EXPECT_EQ(receive_message(other), Bytes(3, std::byte{1}));
  EXPECT_EQ(receive_message(other), Bytes(100'000, std::byte{2}));
  close(one);
  EXPECT_TRUE(receive_message(other).empty());
  EXPECT_FALSE(send_message(other, Bytes(3, std::byte{1})));
  close(other);
}

TEST(MessageSocket, AMessageThatIsTooLongIsAnError) {
  const auto [one, other] = make_message_sockets();
  EXPECT_THROW(static_cast<void>(send_message(one, Bytes(too_many_bytes))), std::system_error);
  close(one);
  close(other);
}

TEST(WorkerProcess, TellsThatItsResultsAreTooLongForAMessage) {
  const Experiment experiment = small_experiment();
  WorkerProcess worker(experiment, [](const Experiment& /*experiment*/, std::span<const Task> /*tasks*/) {
    TrialResult result;
    result.failure = std::string(too_many_bytes, 'x');
    return std::vector<TrialResult>{result};
  });
  worker.send(std::vector<Task>(1));
  const WorkerProcess::Reply reply = worker.receive();
  const auto* const failed = std::get_if<WorkerProcess::Failed>(&reply);
  ASSERT_NE(failed, nullptr);
  EXPECT_NE(failed->what.find("Message too long"), std::string::npos) << failed->what;
}

}  // namespace
}  // namespace proleg::optimize
