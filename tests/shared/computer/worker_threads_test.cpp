#include "shared/computer/threads/worker_threads.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <numeric>
#include <thread>
#include <vector>

namespace proleg {
namespace {

TEST(WorkerThreads, DoEachPartOnce) {
  constexpr unsigned count = 20;
  for (const unsigned thread_count : {1U, 2U, 3U, 7U}) {
    WorkerThreads threads(thread_count, count);
    std::array<unsigned, count> calls{};
    std::array<unsigned, count> expected{};
    std::vector<unsigned> parts;
    for (unsigned piece = 0; piece < 2'000; ++piece) {
      parts.clear();
      for (unsigned part = 0; part < count; ++part) {
        if ((piece * 7 + part * part) % 3 != 0) {
          parts.push_back(part);
          ++expected.at(part);
        }
      }
      threads.run(parts, [&](unsigned part) { ++calls.at(part); });
    }
    EXPECT_EQ(calls, expected) << thread_count << " threads";
  }
}

TEST(WorkerThreads, SeeWhatTheCallerWroteAndTheCallerSeesWhatTheyWrote) {
  constexpr unsigned count = 4;
  constexpr std::array<unsigned, count> parts{0, 1, 2, 3};
  const auto add = [](std::array<std::uint64_t, count>& numbers, unsigned part, std::uint64_t sum) {
    numbers.at(part) += sum % 1'000'003 + part;
  };
  WorkerThreads threads(3, count);
  std::array<std::uint64_t, count> numbers{1, 1, 1, 1};
  std::array<std::uint64_t, count> expected = numbers;
  for (unsigned piece = 0; piece < 10'000; ++piece) {
    const std::uint64_t sum = std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0});
    threads.run(parts, [&](unsigned part) { add(numbers, part, sum); });
    const std::uint64_t expected_sum = std::accumulate(expected.begin(), expected.end(), std::uint64_t{0});
    for (const unsigned part : parts) {
      add(expected, part, expected_sum);
    }
  }
  EXPECT_EQ(numbers, expected);
}

TEST(WorkerThreads, DoTwoPartsAtTheSameTime) {
  WorkerThreads threads(2, 2);
  std::atomic<unsigned> begun{0};
  // Each part waits for the other to begin: on one thread it would not end.
  threads.run(std::array{0U, 1U}, [&](unsigned /*part*/) {
    ++begun;
    while (begun < 2) {
      std::this_thread::yield();
    }
  });
  EXPECT_EQ(begun, 2U);
}

TEST(WorkerThreads, MayEndWithoutAnyWork) { const WorkerThreads threads(3, 1); }

}  // namespace
}  // namespace proleg
