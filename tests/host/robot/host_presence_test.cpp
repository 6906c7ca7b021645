// A host that is late on a busy computer drives the robot all the same; a host that has just ended does not.

#include "host/robot/host_presence.hpp"

#include <gtest/gtest.h>

#include <initializer_list>

namespace proleg::test {
namespace {

constexpr Microseconds begin = 5'000'000;

/// Heartbeats at these times after the begin.
host::HostPresence heard(std::initializer_list<Microseconds> milliseconds, std::uint8_t node = canopen::host_node) {
  host::HostPresence presence(begin);
  for (const Microseconds time : milliseconds) {
    const Microseconds now = begin + 1000 * time;
    if (!presence.is_there() && now < presence.silent_at()) {
      presence.receive(now, canopen::encode(canopen::Heartbeat{node, canopen::NmtState::operational}));
    }
  }
  return presence;
}

TEST(HostPresence, IsKnownFromHeartbeatsInTime) { EXPECT_TRUE(heard({10, 110, 210, 310}).is_there()); }

TEST(HostPresence, IsKnownFromHeartbeatsThatAreLate) {
  EXPECT_TRUE(heard({450, 900}).is_there());
  EXPECT_TRUE(heard({0, 5, 10, 480}).is_there()) << "several that have waited, then a late one";
}

TEST(HostPresence, IsNotThatOfAHostThatHasJustEnded) {
  const host::HostPresence presence = heard({20, 25, 120});
  EXPECT_FALSE(presence.is_there());
  EXPECT_EQ(presence.silent_at(), begin + 620'000);
}

TEST(HostPresence, IsNotThatOfAModule) { EXPECT_FALSE(heard({10, 110, 210, 310, 410}, 3).is_there()); }

TEST(HostPresence, IsDecidedInHalfASecondOnASilentBus) { EXPECT_EQ(heard({}).silent_at(), begin + 500'000); }

}  // namespace
}  // namespace proleg::test
