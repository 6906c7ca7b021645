// What a subcommand leaves on the bus when a wait fails: it may go on with that bus.

#include "tools/proleg/robot/bus_access.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "shared/canopen/declared_objects.hpp"
#include "tools/proleg/flash/flash_modules.hpp"

namespace proleg::test {
namespace {

constexpr Microseconds one_second = 1'000'000;

/// A bus without other nodes, on virtual time.
class EmptyBus final : public host::Transport {
 public:
  EmptyBus() { connect(); }

  void connect() { state_.is_connected = true; }
  /// The connection is lost at the next event.
  void lose_connection() { is_lost_ = true; }
  [[nodiscard]] unsigned sent() const { return sent_; }

  [[nodiscard]] Microseconds now() const override { return now_; }
  [[nodiscard]] bool send(const CanFrame& /*frame*/) override {
    ++sent_;
    return true;
  }
  void run_until(Microseconds deadline) override {
    now_ = std::max(deadline, now_ + 1);
    state_.is_connected = state_.is_connected && !is_lost_;
    is_lost_ = false;
  }
  [[nodiscard]] const host::BusState& state() const override { return state_; }
  [[nodiscard]] host::Statistics statistics() const override { return {}; }
  [[nodiscard]] std::string description() const override { return "virtual time"; }

 private:
  host::BusState state_;
  Microseconds now_ = 0;
  unsigned sent_ = 0;
  bool is_lost_ = false;
};

class BusAccessAfterALostConnection : public ::testing::Test {
 protected:
  BusAccessAfterALostConnection() { transport->lose_connection(); }

  /// Frames that the bus takes after the connection is back, from the users that are still attached.
  unsigned frames_after_reconnection() {
    transport->connect();
    const unsigned before = transport->sent();
    bus.connection().run_for(10 * one_second);
    return transport->sent() - before;
  }

  EmptyBus* transport = nullptr;
  tools::BusAccess bus{[this](host::TransportListener& /*listener*/) {
    auto opened = std::make_unique<EmptyBus>();
    transport = opened.get();
    return opened;
  }};
};

TEST_F(BusAccessAfterALostConnection, AScanSendsNothingMore) {
  host::BusScan scan(bus.connection());
  EXPECT_THROW(tools::scan(bus, scan), std::runtime_error);
  EXPECT_EQ(frames_after_reconnection(), 0U);
}

TEST_F(BusAccessAfterALostConnection, ATransferSendsNothingMore) {
  host::SdoQueue queue(bus.connection(), tools::patient_transfers());
  queue.read(1, canopen::object::controlword.address, [](const host::SdoResult& /*result*/) {});
  EXPECT_THROW(tools::finish(bus, queue), std::runtime_error);
  EXPECT_EQ(frames_after_reconnection(), 0U);
}

TEST_F(BusAccessAfterALostConnection, AQueryOfModulesSendsNothingMore) {
  std::vector<host::FlashCandidate> modules{{.program = {0x1234'5678, false, {}, {}}, .node = 1}};
  EXPECT_THROW(tools::ask_programs(bus, modules), std::runtime_error);
  EXPECT_EQ(frames_after_reconnection(), 0U);
}

TEST_F(BusAccessAfterALostConnection, ASearchForSilentModulesSendsNothingMore) {
  EXPECT_THROW(static_cast<void>(tools::find_silent_modules(bus, {})), std::runtime_error);
  EXPECT_EQ(frames_after_reconnection(), 0U);
}

}  // namespace
}  // namespace proleg::test
