#include "sim/loop/module_readings.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace proleg::sim {
namespace {

/// Contacts by link of a robot of three joints.
using Links = std::array<std::uint8_t, 4>;

TEST(JointContacts, AreThoseOfTheLinkBehindAndForTheHeadOfLinkZeroToo) {
  const Links links{1, 2, 3, 1};
  EXPECT_EQ(joint_contacts(links, 0), 0b0110);
  EXPECT_EQ(joint_contacts(links, 1), 0b0011);
  EXPECT_EQ(joint_contacts(links, 2), 0b0001);
}

TEST(JointContacts, WrittenToTheirLinksGiveTheSameLinks) {
  for (unsigned pattern = 0; pattern < 256; ++pattern) {
    Links links{};
    for (std::size_t link = 0; link < links.size(); ++link) {
      links[link] = static_cast<std::uint8_t>((pattern >> (2 * link)) & 3U);
    }
    Links written{0xFF, 0xFF, 0xFF, 0xFF};
    for (std::size_t joint = 0; joint < links.size() - 1; ++joint) {
      constexpr unsigned other_flags = 0xF0;
      write_link_contacts(written, joint, joint_contacts(links, joint) | other_flags);
    }
    EXPECT_EQ(written, links);
  }
}

TEST(TouchInputs, AcceptAContactAtItsSecondSampleAndDropItAtAReset) {
  TouchInputs inputs(3);
  const Links links{2, 1, 0, 0};
  Links written{};
  EXPECT_EQ(inputs.sample(links, 0), 0);
  EXPECT_EQ(inputs.sample(links, 0), 0b1001);
  inputs.write_links(written);
  EXPECT_EQ(written, links);
  inputs.reset(0);
  EXPECT_EQ(inputs.contacts()[0], 0);
  EXPECT_EQ(inputs.sample(links, 0), 0);
}

}  // namespace
}  // namespace proleg::sim
