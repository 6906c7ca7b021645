#include "sim/optimize/evaluation/message.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <bit>
#include <cmath>
#include <limits>
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

constexpr std::uint64_t special_numbers[] = {
    0x0000000000000000U, 0x8000000000000000U, 0x0000000000000001U, 0x7FF0000000000000U, 0xFFF0000000000000U,
    0x7FF8000000000000U, 0xFFF8000000000000U, 0x7FFC00000000BEEFU, 0x3FB999999999999AU, 0x7FEFFFFFFFFFFFFFU};

TrialResult special_result() {
  TrialResult result;
  std::size_t i = 0;
  for (double& value : result.measures.all()) {
    value = std::bit_cast<double>(special_numbers[i++ % std::size(special_numbers)]);
  }
  result.simulated_s = 0.1;
  result.wall_s = 1e-300;
  result.given_up = true;
  result.failure = std::string("a\0b\xFF", 4);
  result.limited_joints = 0xFFFFFFFFU;
  return result;
}

const std::vector<Task> special_tasks{Task{}, Task{0xFFFFFFFFU, 0xFFFFFFFFFFFFFFFFU, 7, {0, 0xFFFFFFFFU, 5}, -0.1},
                                      Task{1, 2, 3, {4}, 0.0}};

std::vector<TrialResult> special_results() { return {special_result(), TrialResult{}, special_result()}; }

TEST(Message, KeepsEveryBitOfTasks) {
  for (std::size_t count = 0; count <= special_tasks.size(); ++count) {
    const std::vector<Task> tasks(special_tasks.begin(), special_tasks.begin() + static_cast<std::ptrdiff_t>(count));
    EXPECT_EQ(tasks_from(to_bytes(tasks)), tasks);
  }
}

TEST(Message, KeepsEveryBitOfResults) {
  const std::vector<TrialResult> results = special_results();
  const std::optional<std::vector<TrialResult>> read = results_from(to_bytes(results));
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(exact((*read)[i]), exact(results[i]));
    EXPECT_EQ((*read)[i].wall_s, results[i].wall_s);
    EXPECT_EQ((*read)[i].limited_joints, results[i].limited_joints);
  }
}

TEST(Message, ThatIsCutOrTooLongIsRejected) {
  const Bytes tasks = to_bytes(special_tasks);
  const Bytes results = to_bytes(special_results());
  for (std::size_t size = 0; size < tasks.size(); ++size) {
    EXPECT_FALSE(tasks_from(std::span(tasks).first(size))) << size;
  }
  for (std::size_t size = 0; size < results.size(); ++size) {
    EXPECT_FALSE(results_from(std::span(results).first(size))) << size;
  }
  Bytes longer = tasks;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(tasks_from(longer));
}

/// Any bytes are read without a crash, and a message that is read is equal when it is written again. The sanitizers
/// check this, too.
TEST(Message, MadeOfAnyBytesIsReadSafely) {
  constexpr std::uint32_t seed = 20;
  RecordProperty("seed", static_cast<int>(seed));
  std::mt19937 random(seed);
  const Bytes originals[] = {to_bytes(special_tasks), to_bytes(special_results())};
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = originals[random() % 2];
    for (std::uint32_t changes = 1 + random() % 4; changes > 0; --changes) {
      // The numbers at the beginning decide most: of items, and of the first one.
      const std::size_t range = random() % 2 == 0 ? 40 : bytes.size();
      bytes[random() % range] = static_cast<std::byte>(random() % 4 == 0 ? 255U : random() % 256);
    }
    bytes.resize(bytes.size() - (random() % 3 == 0 ? random() % bytes.size() : 0));
    if (const std::optional<std::vector<Task>> tasks = tasks_from(bytes)) {
      EXPECT_EQ(to_bytes(*tasks).size(), bytes.size());
    }
    if (const std::optional<std::vector<TrialResult>> results = results_from(bytes)) {
      EXPECT_EQ(to_bytes(*results), bytes);
    }
  }
}

}  // namespace
}  // namespace proleg::optimize
