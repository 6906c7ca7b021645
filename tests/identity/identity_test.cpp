// The same parameters, seeds and contacts give the same set-points, bit for bit: with one kernel for the robot or one
// in each module, and with any compiler. golden.tsv holds the hashes, so that a change of behaviour shows too.

#include <gtest/gtest.h>

#include <memory>

#include "shared/gait/algorithms.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "tests/identity/expect_golden.hpp"
#include "tests/identity/sensing_probe.hpp"

namespace proleg::identity {
namespace {

constexpr std::uint32_t native_cases = PROLEG_IDENTITY_CASES;

class Identity : public EachAlgorithm {};

TEST_P(Identity, OneKernelOfAllJointsGivesTheGoldenSetpoints) {
  expect_golden([] { return make_native_player(Driver::whole); }, algorithm(), native_cases);
}

TEST_P(Identity, FiveModulesThatExchangeFramesGiveTheGoldenSetpoints) {
  expect_golden([] { return make_native_player(Driver::modules); }, algorithm(), native_cases);
}

TEST(CoreFingerprint, IsTheCheckSumOfTheGoldenResults) {
  EXPECT_EQ(core_fingerprint, fingerprint_of(read_golden(golden_file()))) << "identity --write-golden writes it";
}

INSTANTIATE_TEST_SUITE_P(Algorithms, Identity, testing::ValuesIn(algorithm_ids()), algorithm_name);

// A proof of identity must be able to fail. The frame of joint 1 reaches joint 2 with a fault, once, in tick 20.

struct Effect {
  int changed;  ///< cases of which a set-point differs from the run without a fault
  int cases;
  std::uint32_t missed_frames;
};

Effect effect_of(Fault fault, const ActuationModule& algorithm) {
  const auto modules = std::make_unique<Modules>();
  const auto undisturbed = std::make_unique<Trace>();
  const auto disturbed = std::make_unique<Trace>();
  Effect effect{0, 50, 0};
  for (int number = 0; number < effect.cases; ++number) {
    const auto seed = static_cast<std::uint32_t>(number);
    EXPECT_EQ(run(modules->kernels(), algorithm, seed, {}, *undisturbed), Status::ok);
    EXPECT_EQ(run(modules->kernels(), algorithm, seed, {fault, 20, 1, 2}, *disturbed), Status::ok);
    effect.changed += disturbed->setpoints != undisturbed->setpoints ? 1 : 0;
    effect.missed_frames += disturbed->missed_frames;
  }
  return effect;
}

// In most cases both joints belong to the group, are coupled and have not yet locked; in the others nothing can change.

TEST(IdentityFault, ADroppedFrameChangesTheCoupledGait) {
  const Effect effect = effect_of(Fault::dropped_frame, pattern_generator_coupled_oscillator());
  EXPECT_GT(effect.changed, effect.cases / 2);
  EXPECT_GT(effect.missed_frames, 0U);
}

TEST(IdentityFault, AFrameThatComesATickLateChangesTheCoupledGait) {
  const Effect effect = effect_of(Fault::late_frame, pattern_generator_coupled_oscillator());
  EXPECT_GT(effect.changed, effect.cases / 2);
  EXPECT_GT(effect.missed_frames, 0U);
}

TEST(IdentityFault, ContactsATickOlderThanTheOwnChangeASensingGait) {
  const Effect effect = effect_of(Fault::stale_contacts, sensing_probe());
  EXPECT_GT(effect.changed, effect.cases / 2);
  EXPECT_EQ(effect.missed_frames, 0U);
}

TEST(IdentityFault, ADroppedFrameLeavesAGaitWithoutCouplingAsItIs) {
  const auto modules = std::make_unique<Modules>();
  const auto undisturbed = std::make_unique<Trace>();
  const auto disturbed = std::make_unique<Trace>();
  // Case 0 of the sinusoidal generator has no second slot that listens to its neighbours.
  const ActuationModule& algorithm = pattern_generator_sinusoidal();
  ASSERT_EQ(run(modules->kernels(), algorithm, 0, {}, *undisturbed), Status::ok);
  ASSERT_EQ(run(modules->kernels(), algorithm, 0, {Fault::dropped_frame, 20, 1, 2}, *disturbed), Status::ok);
  EXPECT_EQ(disturbed->setpoints, undisturbed->setpoints);
}

}  // namespace
}  // namespace proleg::identity
