#include "shared/gait/sensing_module.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <deque>
#include <random>
#include <utility>

#include "module_chain.hpp"
#include "robot.hpp"

namespace proleg {
namespace {

using test::robot_joints;
using test::robot_links;

constexpr InternalValue internal_values[] = {{"seen", Unit::count, 0, "two bits a link, head first"}};
constexpr Declaration about{120, "ContactProbe", "test", {}, internal_values, {}};

/// Keeps the contacts that it was given.
class ContactProbe final : public SensingModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }
  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* /*state*/) const override {
    return 0;
  }

 private:
  void advance_sensing(const Contacts& contacts, const Surroundings& /*surroundings*/, const Tuning& /*tuning*/,
                       const std::int32_t* /*state*/, std::int32_t* next) const override {
    EXPECT_EQ(contacts.link_count(), robot_links);
    next[0] = 0;
    for (unsigned link = 0; link < robot_links; ++link) {
      const bool rear = contacts.pressed(link, TouchSensor::rear);
      const bool front = contacts.pressed(link, TouchSensor::front);
      EXPECT_EQ(contacts.pressed(link), rear || front);
      next[0] |= (rear ? 1 : 0) << (2 * link) | (front ? 2 : 0) << (2 * link);
    }
    EXPECT_FALSE(contacts.pressed(robot_links, TouchSensor::rear));
  }
};

constexpr ContactProbe probe;

/// The bits that a joint reports of the bitmap of all links: its rear link, and in the head's joint the head link, too.
std::uint8_t reported(std::uint32_t bitmap, unsigned joint) {
  const std::uint32_t rear_link = (bitmap >> (2 * (joint + 1))) & 3U;
  const std::uint32_t far_link = joint == 0 ? bitmap & 3U : 0U;
  return static_cast<std::uint8_t>(rear_link | far_link << 2U);
}

// protocol.md: state k + 1 comes from contacts c[k - 1], for everyone, the own contacts included.
TEST(SensingModule, SeesTheContactsOfAllLinksOneTickOldItsOwnIncluded) {
  const KernelConfiguration configuration = test::one_slot(probe, robot_joints);
  KernelOf<robot_joints> whole;
  ASSERT_EQ(whole.configure(configuration, 0), Status::ok);
  test::ModuleChain chain(configuration);
  std::mt19937 random(12);
  std::uint32_t previous = 0;
  for (int tick = 0; tick < 200; ++tick) {
    const std::uint32_t contacts = random() % (1U << (2 * robot_links));
    chain.exchange();
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      whole.set_contacts(joint, reported(contacts, joint));
      chain[joint].set_contacts(joint, reported(contacts, joint));
    }
    whole.advance();
    chain.advance();
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      ASSERT_EQ(static_cast<std::uint32_t>(whole.internal_value(0, joint, 0)), previous) << "tick " << tick;
      ASSERT_EQ(static_cast<std::uint32_t>(chain[joint].internal_value(0, joint, 0)), previous) << "tick " << tick;
    }
    previous = contacts;
  }
}

TEST(SensingModule, KeepsTheLastContactsOfAJointWhoseFrameIsLost) {
  test::ModuleChain chain(test::one_slot(probe, robot_joints));
  chain[3].set_contacts(3, StateFrame::contact_rear_link_front);
  chain.tick();
  chain[3].set_contacts(3, 0);
  chain.tick();
  EXPECT_EQ(chain[0].internal_value(0, 0, 0), 2 << 8);
  chain.exchange([](unsigned sender, unsigned receiver) { return sender == 3 && receiver == 0; });
  chain.advance();
  EXPECT_EQ(chain[0].internal_value(0, 0, 0), 2 << 8) << "held";
  EXPECT_EQ(chain[1].internal_value(0, 1, 0), 0) << "heard";
}

TEST(SensingModule, SeesNoContactOfAJointItNeverHeard) {
  test::ModuleChain chain(test::one_slot(probe, robot_joints));
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    chain[joint].set_contacts(joint, 3);
  }
  for (int tick = 0; tick < 3; ++tick) {
    chain.exchange([](unsigned, unsigned) { return true; });
    chain.advance();
  }
  EXPECT_EQ(chain[2].internal_value(0, 2, 0), 3 << 6) << "its own";
}

TEST(SensingModule, SeesNoContactFromBeforeAReset) {
  KernelOf<robot_joints> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(probe, robot_joints), 0), Status::ok);
  kernel.set_contacts(1, 3);
  test::run(kernel, 2);
  EXPECT_EQ(kernel.internal_value(0, 0, 0), 3 << 4);
  kernel.reset();
  test::run(kernel, 2);
  EXPECT_EQ(kernel.internal_value(0, 0, 0), 0);
}

TEST(SensingModule, IgnoresBitsThatAreNoContacts) {
  KernelOf<robot_joints> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(probe, robot_joints), 0), Status::ok);
  kernel.set_contacts(1, 0xF1);
  kernel.advance();
  EXPECT_EQ(kernel.frame(1, 0).flags(), StateFrame::valid | StateFrame::contact_rear_link_rear);
}

constexpr InternalValue reading_values[] = {{"present", Unit::count, 0, "bits"},
                                            {"current", Unit::count, 0, "mA"},
                                            {"pitch", Unit::phase_degree, 0, "of the link"},
                                            {"up", Unit::count, 0, "mm/s^2"}};
constexpr Declaration about_readings{119, "ReadingProbe", "test", {}, reading_values, {}};

/// Keeps the readings that it was given.
class ReadingProbe final : public ActuationModule {
 public:
  explicit constexpr ReadingProbe(std::uint8_t sensors) : sensors_(sensors) {}
  [[nodiscard]] const Declaration& declaration() const override { return about_readings; }
  [[nodiscard]] std::uint8_t senses_readings() const override { return sensors_; }
  void advance(const Surroundings& surroundings, const Tuning& /*tuning*/, const std::int32_t* /*state*/,
               std::int32_t* next) const override {
    next[0] = surroundings.readings.present;
    next[1] = surroundings.readings.current_ma;
    next[2] = surroundings.readings.pitch;
    next[3] = surroundings.readings.acceleration_mm_s2[2];
  }
  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* /*state*/) const override {
    return 0;
  }

 private:
  std::uint8_t sensors_;
};

constexpr std::uint8_t current_and_inclination = JointReadings::servo_current | JointReadings::inclination;
constexpr ReadingProbe current_probe(JointReadings::servo_current);
constexpr ReadingProbe reading_probe(current_and_inclination);
constexpr ReadingProbe no_probe(0);

JointReadings all_readings() { return {7, 321, 45, -6, {1, 2, 9810}}; }

std::array<std::int32_t, 4> given_to(const Kernel& kernel, unsigned slot, unsigned joint) {
  std::array<std::int32_t, 4> values{};
  for (unsigned i = 0; i < values.size(); ++i) {
    values[i] = kernel.internal_value(slot, joint, i);
  }
  return values;
}

TEST(Readings, AreThoseOfTheJointsOwnModule) {
  KernelOf<robot_joints> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(reading_probe, robot_joints), 0), Status::ok);
  EXPECT_EQ(kernel.needed_readings(2), current_and_inclination);
  kernel.set_readings(2, all_readings());
  kernel.set_readings(robot_joints, all_readings());  // no local joint has this number: the call is ignored
  kernel.advance();
  EXPECT_EQ(given_to(kernel, 0, 2), (std::array<std::int32_t, 4>{current_and_inclination, 321, 45, 0}));
  EXPECT_EQ(given_to(kernel, 0, 1), (std::array<std::int32_t, 4>{})) << "another module's";
}

TEST(Readings, ThatNoSlotOfTheJointNamesAreAbsent) {
  KernelOf<1> kernel;
  for (const auto& [probe_in_slot, expected] :
       {std::pair{&current_probe, std::array<std::int32_t, 4>{JointReadings::servo_current, 321, 0, 0}},
        std::pair{&no_probe, std::array<std::int32_t, 4>{}}}) {
    ASSERT_EQ(kernel.configure(test::one_slot(*probe_in_slot, 1), 0), Status::ok);
    kernel.set_readings(0, all_readings());
    kernel.advance();
    EXPECT_EQ(given_to(kernel, 0, 0), expected);
  }
}

TEST(Readings, ThatAModuleDoesNotHaveAreAbsent) {
  KernelOf<1> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(reading_probe, 1), 0), Status::ok);
  JointReadings readings = all_readings();
  readings.present = JointReadings::servo_current;
  kernel.set_readings(0, readings);
  kernel.advance();
  EXPECT_EQ(given_to(kernel, 0, 0), (std::array<std::int32_t, 4>{JointReadings::servo_current, 321, 0, 0}));
}

TEST(Readings, FromBeforeAResetAreForgotten) {
  KernelOf<1> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(reading_probe, 1), 0), Status::ok);
  kernel.set_readings(0, all_readings());
  kernel.reset();
  kernel.advance();
  EXPECT_EQ(given_to(kernel, 0, 0), (std::array<std::int32_t, 4>{}));
  kernel.set_readings(0, all_readings());
  kernel.join(100);
  kernel.advance();
  EXPECT_EQ(given_to(kernel, 0, 0), (std::array<std::int32_t, 4>{}));
}

}  // namespace
}  // namespace proleg
