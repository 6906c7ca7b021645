// A user's algorithm that is guarded: it gives the same values, and each error is reported in one line.

#include "shared/computer/algorithm_library/guarded_algorithm.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <thread>

#include "shared/kernel/kernel.hpp"
#include "user_algorithm.hpp"

namespace proleg {
namespace {

using test::TestedCounter;

constexpr unsigned joints = 3;

std::unique_ptr<GuardedAlgorithm> guarded(const ActuationModule& algorithm) {
  CapturedDeclaration captured;
  captured.capture(algorithm.declaration());
  return std::make_unique<GuardedAlgorithm>("counter.so", algorithm, captured, Senses{});
}

KernelConfiguration configuration_of(const ActuationModule& algorithm) {
  KernelConfiguration configuration;
  configuration.joint_count = joints;
  configuration.slots[0] = {&algorithm, JointMask::first(joints)};
  return configuration;
}

/// Runs ticks until the failure. Returns its text.
std::string failure_of(const ActuationModule& algorithm) {
  KernelOf<joints> kernel;
  EXPECT_EQ(kernel.configure(configuration_of(algorithm), 0), Status::ok);
  for (int tick = 0; tick < 10; ++tick) {
    try {
      kernel.advance();
    } catch (const AlgorithmFailure& failure) {
      EXPECT_EQ(kernel.tick(), 3U) << "the ticks before it are computed";
      return failure.what();
    }
  }
  return "no failure";
}

std::string failure_with(decltype(TestedCounter::mistake) mistake) {
  TestedCounter counter;
  counter.mistake = std::move(mistake);
  return failure_of(*guarded(counter));
}

const std::string where = ", in advance() at tick 3, joint 1 (0 is at the head)";

TEST(GuardedAlgorithm, ComputesWhatTheAlgorithmComputes) {
  const TestedCounter counter;
  const auto behind_guard = guarded(counter);
  KernelOf<joints> plain;
  KernelOf<joints> checked;
  ASSERT_EQ(plain.configure(configuration_of(counter), 0), Status::ok);
  ASSERT_EQ(checked.configure(configuration_of(*behind_guard), 0), Status::ok);
  for (KernelOf<joints>* kernel : {&plain, &checked}) {
    for (unsigned joint = 0; joint < joints; ++joint) {
      ASSERT_EQ(kernel->set_parameter(0, joint, 0, static_cast<std::int32_t>(7 + joint)), Status::ok);
    }
    kernel->reset();
  }
  for (int tick = 0; tick < 20; ++tick) {
    for (unsigned joint = 0; joint < joints; ++joint) {
      EXPECT_EQ(checked.setpoint(joint), plain.setpoint(joint));
      EXPECT_EQ(checked.setpoint(joint),
                static_cast<std::int32_t>(100 * joint + static_cast<unsigned>(tick) * (7 + joint)));
      EXPECT_EQ(checked.frame(joint, 0), plain.frame(joint, 0));
    }
    plain.advance();
    checked.advance();
  }
}

TEST(GuardedAlgorithm, PassesOnAFrameThatItExtrapolates) {
  const TestedCounter counter;
  const std::array<std::int32_t, max_parameters> parameters{};
  const std::array<std::int32_t, max_derived> derived{};
  const std::array<std::int32_t, max_internal_values> state{0x55};
  StateFrame frame;
  frame.bytes = {1, 2, 3, 4, 5, 6, 7, 8};
  guarded(counter)->extrapolate({parameters.data(), derived.data()}, state.data(), frame);
  EXPECT_EQ(frame.bytes, (std::array<std::uint8_t, 8>{0x55, 2, 3, 4, 5, 6, 7, 0x77}));
}

TEST(GuardedAlgorithm, AnExceptionIsOneLine) {
  const auto mistake = [](const Tuning&, const std::int32_t*, std::int32_t*) { throw std::runtime_error("no\nidea"); };
  EXPECT_EQ(failure_with(mistake), "counter.so: the algorithm 'counter' throws an exception: no idea" + where);
}

TEST(GuardedAlgorithm, AnAccessBehindAnArrayNamesTheArray) {
  EXPECT_EQ(
      failure_with([](const Tuning&, const std::int32_t*, std::int32_t* next) {
        volatile std::int32_t* behind = next + 1;
        *behind = 1;
      }),
      "counter.so: the algorithm 'counter' uses elements of its array 'next' that do not exist (it has 1)" + where);
  EXPECT_EQ(failure_with([](const Tuning& tuning, const std::int32_t*, std::int32_t* next) {
              const volatile std::int32_t* behind = tuning.parameters + 2;
              next[0] = *behind;
            }),
            "counter.so: the algorithm 'counter' uses elements of its array 'parameters' that do not exist (it has 2)" +
                where);
  EXPECT_EQ(failure_with([](const Tuning& tuning, const std::int32_t*, std::int32_t* next) {
              const volatile std::int32_t* behind = tuning.derived + max_derived;
              next[0] = *behind;
            }),
            "counter.so: the algorithm 'counter' uses elements of its array 'derived' that do not exist (it has " +
                std::to_string(max_derived) + ")" + where);
}

TEST(GuardedAlgorithm, AWriteThatDoesNotCrashIsFoundWhenTheCallReturns) {
  EXPECT_EQ(failure_with([](const Tuning&, const std::int32_t*, std::int32_t* next) {
              volatile std::int32_t* front = next - 5;
              *front = 1;
            }),
            "counter.so: the algorithm 'counter' writes in front of its array 'next'" + where);
  EXPECT_EQ(failure_with([](const Tuning& tuning, const std::int32_t*, std::int32_t*) {
              *const_cast<std::int32_t*>(tuning.parameters) += 1;
            }),
            "counter.so: the algorithm 'counter' writes to its array 'parameters', which it may only read" + where);
}

TEST(GuardedAlgorithm, ACallOfAbortAndAnEndlessLoopEnd) {
  EXPECT_EQ(failure_with([](const Tuning&, const std::int32_t*, std::int32_t*) { std::abort(); }),
            "counter.so: the algorithm 'counter' calls abort()" + where);
  EXPECT_EQ(failure_with([](const Tuning&, const std::int32_t*, std::int32_t*) {
              volatile int turns = 0;
              while (turns >= 0) {
                turns = turns == 1000 ? 0 : turns + 1;
              }
            }),
            "counter.so: the algorithm 'counter' does not return within a second of processor time: an endless loop?" +
                where);
}

TEST(GuardedAlgorithm, AfterAFailureItIsNotCalledAgain) {
  TestedCounter counter;
  int calls = 0;
  counter.mistake = [&](const Tuning&, const std::int32_t*, std::int32_t*) {
    ++calls;
    throw 7;
  };
  const auto behind_guard = guarded(counter);
  const std::string first = failure_of(*behind_guard);
  KernelOf<joints> other;
  try {
    static_cast<void>(other.configure(configuration_of(*behind_guard), 0));
    ADD_FAILURE() << "it was called";
  } catch (const AlgorithmFailure& failure) {
    EXPECT_EQ(failure.what(), first);
  }
  EXPECT_EQ(calls, 1);
}

TEST(GuardedAlgorithm, ThreadsUseItAtTheSameTimeAndFailForThemselves) {
  std::array<std::string, 4> texts;
  std::array<std::thread, 4> threads;
  for (std::size_t i = 0; i < threads.size(); ++i) {
    threads[i] = std::thread([&text = texts[i]] {
      text = failure_with([](const Tuning&, const std::int32_t*, std::int32_t* next) {
        volatile std::int32_t* behind = next + 1;
        *behind = 1;
      });
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const std::string& text : texts) {
    EXPECT_EQ(text, texts[0]);
    EXPECT_NE(text.find("'next'"), std::string::npos);
  }
}

}  // namespace
}  // namespace proleg
