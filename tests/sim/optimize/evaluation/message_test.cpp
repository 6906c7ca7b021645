#include "sim/optimize/evaluation/message.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

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

TEST(Message, KeepsEveryBitOfATask) {
  for (const Task& task :
       {Task{}, Task{0xFFFFFFFFU, 0xFFFFFFFFFFFFFFFFU, 7, {0, 0xFFFFFFFFU, 5}, -0.1}, Task{1, 2, 3, {4}, 0.0}}) {
    const std::optional<Task> read = task_from(to_bytes(task));
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, task);
  }
}

TEST(Message, KeepsEveryBitOfAResult) {
  const TrialResult result = special_result();
  const std::optional<TrialResult> read = result_from(to_bytes(result));
  ASSERT_TRUE(read);
  EXPECT_EQ(exact(*read), exact(result));
  EXPECT_EQ(read->wall_s, result.wall_s);
  EXPECT_EQ(read->limited_joints, result.limited_joints);
}

TEST(Message, ThatIsCutOrTooLongIsRejected) {
  const Bytes task = to_bytes(Task{1, 2, 3, {4, 5}, 6.0});
  const Bytes result = to_bytes(special_result());
  for (std::size_t size = 0; size < task.size(); ++size) {
    EXPECT_FALSE(task_from(std::span(task).first(size))) << size;
  }
  for (std::size_t size = 0; size < result.size(); ++size) {
    EXPECT_FALSE(result_from(std::span(result).first(size))) << size;
  }
  Bytes longer = task;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(task_from(longer));
}

/// Any bytes are read without a crash, and a message that is read is equal when it is written again. The sanitizers
/// check this, too.
TEST(Message, MadeOfAnyBytesIsReadSafely) {
  constexpr std::uint32_t seed = 20;
  RecordProperty("seed", static_cast<int>(seed));
  std::mt19937 random(seed);
  const Bytes originals[] = {to_bytes(Task{1, 2, 3, {4, 5}, 6.0}), to_bytes(special_result())};
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = originals[random() % 2];
    for (std::uint32_t changes = 1 + random() % 4; changes > 0; --changes) {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random() % 4 == 0 ? 255U : random() % 256);
    }
    bytes.resize(bytes.size() - (random() % 3 == 0 ? random() % bytes.size() : 0));
    if (const std::optional<Task> task = task_from(bytes)) {
      EXPECT_EQ(to_bytes(*task).size(), bytes.size());
    }
    if (const std::optional<TrialResult> result = result_from(bytes)) {
      EXPECT_EQ(to_bytes(*result), bytes);
    }
  }
}

}  // namespace
}  // namespace proleg::optimize
