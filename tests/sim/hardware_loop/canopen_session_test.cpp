// A session of every service of the protocol with modules on the simulated bus. Oracle: tshark dissects its log as
// CANopen. The protocol has no TIME message and no node guarding.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "shared/canopen/lss_frame.hpp"
#include "shared/canopen/sdo_frame.hpp"
#include "shared/computer/master/lss_master.hpp"
#include "shared/computer/master/sdo_transfer.hpp"
#include "shared/gait/registry.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "shipped.hpp"
#include "sim/bus/candump_log.hpp"
#include "sim/hardware_loop/host_node.hpp"
#include "sim/hardware_loop/native_module.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/lines_of.hpp"

namespace proleg::sim {
namespace {

namespace lss = canopen::lss;
namespace sdo = canopen::sdo;
using canopen::Address;
using canopen::NmtCommand;

/// A service tool, the host with its master, and modules that come from the factory.
class CanopenSession : public testing::Test, BusListener {
 protected:
  static constexpr BusTime us = 1'000;
  static constexpr BusTime ms = 1'000 * us;

  CanopenSession() : tool_(bus_.attach(*this)), scenario_(shipped("travelling_wave/coupled")) {
    // The joint at the head has a second broadcasting slot, and so a second state frame.
    scenario_.kernel.slots[1] = {find_algorithm(std::string_view("PatternGenerator_sinusoidal")), JointMask::first(1)};
    apply_setting(scenario_, "2.amplitude=30@60");  // COMMIT
    for (unsigned joint = 0; joint < scenario_.kernel.joint_count; ++joint) {
      firmware::ModuleIdentity identity;
      identity.unique_id = {joint + 1, 0x12345678, 0x9ABCDEF0};
      identity.core_fingerprint = core_fingerprint;
      modules_.push_back(std::make_unique<NativeModule>(
          bus_, identity, Crystal(), [] { return std::uint8_t{0}; }, [] { return ServoReadings{}; }));
    }
    bus_.set_frame_listener([this](const Transmission& sent) { log_.push_back(sent); });
  }

  void run_for(BusTime time) {
    const BusTime end = bus_.now() + time;
    while (bus_.now() < end) {
      step(end);
    }
  }
  /// A frame of the tool, and the time for what follows from it.
  void send(const CanFrame& frame, BusTime time = 2 * ms) {
    ASSERT_TRUE(tool_.send(frame));
    run_for(time);
  }
  void command(NmtCommand command, std::uint8_t node) { send(encode(canopen::NmtRequest{command, node}), 30 * ms); }
  void ask(lss::Service service, std::uint8_t first = 0, std::uint8_t second = 0) {
    send(lss::make(canopen::identifier::lss_request, service, first, second));
  }
  void ask_word(unsigned service, std::uint32_t word) {
    send(lss::make_word(canopen::identifier::lss_request, static_cast<lss::Service>(service), word));
  }

  /// Runs the transfer that was begun.
  canopen::AbortCode transfer() {
    std::size_t seen = log_.size();
    do {
      while (const std::optional<CanFrame> frame = transfer_.next_frame(bus_.now() / us)) {
        EXPECT_TRUE(tool_.send(*frame));
        run_for(ms);
      }
      run_for(ms);
      for (; seen < log_.size(); ++seen) {
        transfer_.receive(log_[seen].end / us, log_[seen].frame);
      }
      transfer_.poll(bus_.now() / us);
    } while (transfer_.state() == canopen::SdoTransfer::State::running);
    if (const std::optional<CanFrame> last = transfer_.next_frame(bus_.now() / us)) {
      send(*last);
    }
    return transfer_.abort_code();
  }
  canopen::AbortCode upload(Address address, const canopen::SdoTransferOptions& options = {}) {
    transfer_.upload(node_, address, buffer_, options);
    return transfer();
  }
  canopen::AbortCode download(Address address, std::span<const std::uint8_t> bytes,
                              const canopen::SdoTransferOptions& options = {}) {
    transfer_.download(node_, address, bytes, options);
    return transfer();
  }

  // The parts of the session, in their order.

  void assign_node_ids() {
    for (const auto& module : modules_) {
      module->power_on(bus_.now());
    }
    run_for(50 * ms);
    EXPECT_TRUE(log_.empty()) << "without node ids they are silent";
    std::vector<canopen::LssModule> entries;
    for (const ModulePlace& place : scenario_.modules) {
      entries.push_back({place.node});
    }
    lss_master_ = std::make_unique<canopen::LssMaster>(tool_, entries);
    lss_master_->start(bus_.now() / us);
    while (lss_master_->state() == canopen::LssMaster::State::working) {
      step(std::max(bus_.now(), std::min(lss_master_->next_deadline() * us, bus_.now() + ms)));
      lss_master_->poll(bus_.now() / us);
    }
    EXPECT_EQ(lss_master_->assigned(), modules_.size());
    address_ = entries.back().address;
    node_ = entries.back().node;
    lss_master_.reset();
  }

  /// The services that the master does not use, with the module that was found last.
  void use_other_lss_services() {
    const auto base = [](lss::Service service) { return static_cast<unsigned>(service); };
    for (unsigned i = 0; i < address_.size(); ++i) {
      ask_word(base(lss::Service::select_vendor) + i, address_[i]);
    }
    for (unsigned i = 0; i < address_.size(); ++i) {
      ask(static_cast<lss::Service>(base(lss::Service::inquire_vendor) + i));
    }
    ask(lss::Service::inquire_node_id);
    ask(lss::Service::configure_bit_timing, lss::standard_table, lss::timing_1_mbit);
    ask_word(base(lss::Service::activate_bit_timing), 10);
    ask(lss::Service::configure_node_id, lss::no_node_id);
    ask(lss::Service::switch_state_global, static_cast<std::uint8_t>(lss::State::waiting));
    const std::array<std::uint32_t, 6> range{address_[0], address_[1],     address_[2],
                                             address_[2], address_[3] - 1, address_[3]};
    for (unsigned i = 0; i < range.size(); ++i) {
      ask_word(base(lss::Service::identify_vendor) + i, range[i]);
    }
    command(NmtCommand::reset_communication, node_);  // from here on it has no node id
    ask(lss::Service::identify_non_configured);
    ask(lss::Service::switch_state_global, static_cast<std::uint8_t>(lss::State::configuration));
    ask(lss::Service::configure_node_id, 0);  // refused
    for (const auto& module : modules_) {
      if (module->node() == 0) {
        return finish_lss();
      }
    }
    ADD_FAILURE() << "the module kept its node id";
  }
  void finish_lss() {
    ask(lss::Service::switch_state_global, static_cast<std::uint8_t>(lss::State::waiting));
    for (unsigned i = 0; i < address_.size(); ++i) {
      ask_word(static_cast<unsigned>(lss::Service::select_vendor) + i, address_[i]);
    }
    ask(lss::Service::configure_node_id, node_);
    ask(lss::Service::store_configuration);
    ask(lss::Service::switch_state_global, static_cast<std::uint8_t>(lss::State::waiting));
    run_for(30 * ms);
  }

  void use_sdo() {
    const Address heartbeat_period = canopen::object::heartbeat_period.address;
    const Address name = canopen::object::device_name.address;
    const Address host_heartbeat = canopen::object::host_heartbeat.address;
    const std::array<std::uint8_t, 2> period{100, 0};
    EXPECT_EQ(download(heartbeat_period, period), canopen::AbortCode::none);
    EXPECT_EQ(upload(heartbeat_period), canopen::AbortCode::none);
    EXPECT_EQ(upload(name), canopen::AbortCode::none);
    EXPECT_EQ(upload(name, {.largest_segmented = 0}), canopen::AbortCode::none);
    EXPECT_EQ(transfer_.size(), canopen::object::device_name.text.size());
    EXPECT_EQ(upload({0x2222, 0}), canopen::AbortCode::no_such_object);
    const std::array<std::uint8_t, 5> wrong_size{};
    EXPECT_EQ(download(host_heartbeat, wrong_size), canopen::AbortCode::wrong_length);
    EXPECT_EQ(download(host_heartbeat, wrong_size, {.largest_segmented = 0}), canopen::AbortCode::wrong_length);
    transfer_.upload(node_, name, buffer_);
    send(*transfer_.next_frame(bus_.now() / us));
    transfer_.abort(canopen::AbortCode::general_error);
    send(*transfer_.next_frame(bus_.now() / us));

    // A number of four bytes, in a segment and in a block: the client of the project sends it expedited.
    const auto request = static_cast<std::uint16_t>(canopen::identifier::sdo_request + node_);
    const auto write = [&](std::uint8_t command, std::span<const std::uint8_t> bytes) {
      CanFrame frame{request, 8, {command}};
      std::ranges::copy(bytes, frame.data.begin() + 1);
      send(frame);
    };
    constexpr std::array<std::uint8_t, 4> value{0xF4, 0x01, 127, 0};  // 500 ms, node 127
    constexpr auto unused = static_cast<std::uint8_t>(canopen::segment_bytes - value.size());
    send(sdo::make(request, sdo::request_download | sdo::size_indicated, host_heartbeat, 4, value.size()));
    write(sdo::request_download_segment | unused << 1U | sdo::no_more_segments, value);
    send(sdo::make(request, sdo::block_download | sdo::block_size, host_heartbeat, 4, value.size()));
    constexpr std::uint8_t first_and_last = 0x81;
    write(first_and_last, value);
    write(sdo::block_download | unused << 2U | sdo::block_end, {});
    EXPECT_EQ(upload(host_heartbeat), canopen::AbortCode::none);
    EXPECT_TRUE(std::ranges::equal(std::span(buffer_).first(value.size()), value));
  }

  void drive_the_robot() {
    host_ = std::make_unique<HostNode>(bus_, scenario_, 0);
    host_->start(bus_.now());
    command(NmtCommand::reset_node, 0);
    run_for(2'000 * ms);
    EXPECT_EQ(host_->state(), canopen::MasterState::running) << host_->take_problem().value_or("");
    send(encode(canopen::Command{node_, 0x000F, 1 << 29}));
    send({static_cast<std::uint16_t>(canopen::identifier::command + node_), 2, {0x0F}});  // too short: EMCY
    command(NmtCommand::stop, node_);
    run_for(200 * ms);  // heartbeats of a stopped module
    command(NmtCommand::enter_pre_operational, node_);
    run_for(200 * ms);
    command(NmtCommand::start, node_);
    command(NmtCommand::reset_communication, node_);
    run_for(500 * ms);
  }

  [[nodiscard]] const std::vector<Transmission>& log() const { return log_; }

 private:
  void step(BusTime end) {
    BusTime next = std::min(end, bus_.next_event());
    for (const auto& module : modules_) {
      next = std::min(next, module->next_event());
    }
    next = std::max(host_ ? std::min(next, host_->next_event()) : next, bus_.now());
    bus_.advance_to(next);
    for (const auto& module : modules_) {
      if (module->next_event() <= next) {
        module->advance_to(next, next);
      }
    }
    if (host_ && host_->next_event() <= next) {
      host_->advance_to(next);
    }
  }
  void received(BusTime time, const CanFrame& frame) override {
    if (lss_master_) {
      lss_master_->receive(time / us, frame);
    }
  }
  void transmitted(BusTime time, const CanFrame& frame) override {
    if (lss_master_) {
      lss_master_->transmitted(time / us, frame);
    }
  }

  Bus bus_;
  std::vector<Transmission> log_;
  Controller& tool_;
  Scenario scenario_;
  std::vector<std::unique_ptr<NativeModule>> modules_;
  std::unique_ptr<canopen::LssMaster> lss_master_;
  std::unique_ptr<HostNode> host_;
  canopen::LssAddress address_{};
  std::uint8_t node_ = 0;
  canopen::SdoTransfer transfer_;
  std::array<std::uint8_t, 64> buffer_{};
};

/// What tshark prints of a log, a line each.
std::vector<std::string> dissect(const std::string& path, const std::string& options) {
  return test::lines_of(std::string(PROLEG_TSHARK) + " -r " + path + " -d can.subdissector,canopen " + options +
                        " 2>/dev/null");
}

/// What the dissector calls the frames of an identifier (CiA 301, 7.3.5; CiA 305); COMMIT and TICK are not CANopen's.
std::string kind_of(std::uint16_t identifier) {
  namespace id = canopen::identifier;
  const std::map<std::uint16_t, std::string> single{{id::nmt, "NMT: "},
                                                    {id::sync, "SYNC ["},
                                                    {id::lss_request, "LSS (Master): "},
                                                    {id::lss_answer, "LSS (Slave): "},
                                                    {id::commit, "Unknown (13)\n"},
                                                    {id::tick, "Unknown (13)\n"}};
  const std::map<std::uint16_t, std::string> by_node{{id::emergency, "EMCY\n"},
                                                     {id::state_frame, "PDO1 (tx)\n"},
                                                     {id::command, "PDO1 (rx)\n"},
                                                     {id::second_state, "PDO2 (tx)\n"},
                                                     {id::monitoring, "PDO3 (tx)\n"},
                                                     {id::sdo_answer, "Default-SDO (tx): "},
                                                     {id::sdo_request, "Default-SDO (rx): "},
                                                     {id::heartbeat, "NMT Error Control: "}};
  const auto found = single.find(identifier);
  return found != single.end() ? found->second : by_node.at(id::base_of(identifier));
}

/// A service as the dissector calls it.
const std::vector<std::string> services{
    "NMT: Start remote node [All]",
    "NMT: Start remote node [0x5]",
    "NMT: Stop remote node [0x5]",
    "NMT: Enter pre-operational state [0x5]",
    "NMT: Reset node [All]",
    "NMT: Reset communication [0x5]",
    "NMT Error Control: Boot-up [0x5]",
    "NMT Error Control: Pre-operational [0x5]",
    "NMT Error Control: Operational [0x5]",
    "NMT Error Control: Stopped [0x5]",
    "NMT Error Control: Operational [0x7f]",
    "SYNC [1]",
    "SYNC [128]",
    "EMCY",
    "PDO1 (rx)",
    "PDO1 (tx)",
    "PDO2 (tx)",
    "PDO3 (tx)",
    "Default-SDO (rx): Initiate download request",
    "Default-SDO (tx): Initiate download response",
    "Default-SDO (rx): Initiate upload request",
    "Default-SDO (tx): Initiate upload response",
    "Default-SDO (rx): Download segment request",
    "Default-SDO (tx): Download segment response",
    "Default-SDO (rx): Upload segment request",
    "Default-SDO (tx): Upload segment response",
    "Default-SDO (rx): Block download",
    "Default-SDO (tx): Block download",
    "Default-SDO (rx): Block upload",
    "Default-SDO (tx): Block upload",
    "Default-SDO (rx): Abort transfer",
    "Default-SDO (tx): Abort transfer",
    "LSS (Master): Switch state global protocol: Configuration state",
    "LSS (Master): Switch state global protocol: Waiting state",
    "LSS (Master): Switch state selective protocol",
    "LSS (Slave): Switch state selective protocol",
    "LSS (Master): Configure node-ID protocol: 0x05",
    "LSS (Slave): Configure node-ID protocol",
    "LSS (Master): Configure bit timing protocol: 1000 kbit/s",
    "LSS (Slave): Configure bit timing protocol",
    "LSS (Master): Activate bit timing parameters protocol: 10 ms",
    "LSS (Master): Store configuration protocol",
    "LSS (Slave): Store configuration protocol",
    "LSS (Master): Inquire identity vendor-ID protocol",
    "LSS (Slave): Inquire identity vendor-ID protocol, Vendor-ID 0x50524f4c",
    "LSS (Master): Inquire identity product code protocol",
    "LSS (Slave): Inquire identity product code protocol, Product-code 0x00000001",
    "LSS (Master): Inquire identity revision number protocol",
    "LSS (Slave): Inquire identity revision number protocol, Revision-number 0x00010000",
    "LSS (Master): Inquire identity serial number protocol",
    "LSS (Slave): Inquire identity serial number protocol, Serial-number 0x",
    "LSS (Master): Inquire node-ID protocol",
    "LSS (Slave): Inquire node-ID protocol, Node-ID 0x00000005",
    "LSS (Master): Identify remote slave protocol, Vendor-ID 0x50524f4c",
    "LSS (Master): Identify remote slave protocol, Product-code 0x00000001",
    "LSS (Master): Identify remote slave protocol, Revision-number (low) 0x00010000",
    "LSS (Master): Identify remote slave protocol, Revision-number (high) 0x00010000",
    "LSS (Master): Identify remote slave protocol, Serial-number (low) 0x",
    "LSS (Master): Identify remote slave protocol, Serial-number (high) 0x",
    "LSS (Slave): Identify slave protocol",
    "LSS (Master): Identify non-configured remote slave protocol",
    "LSS (Slave): Identify non-configured slave protocol",
    "LSS (Master): LSS Fastscan protocol",
};

TEST_F(CanopenSession, OfEveryServiceIsDissectedByTsharkWithoutAMalformedPacket) {
  assign_node_ids();
  use_other_lss_services();
  use_sdo();
  drive_the_robot();
  const std::string path = testing::TempDir() + "canopen_session_test." + std::to_string(getpid()) + ".log";
  {
    CandumpLog file{std::filesystem::path(path)};
    for (const Transmission& sent : log()) {
      file.write(sent.end, sent.frame);
    }
    file.finish();
  }
  // The protocol, and what the frame is. Segments of SDO blocks have no command byte; the dissector, which keeps no
  // state, takes their number for one.
  const std::vector<std::string> lines = dissect(path, "-T fields -e _ws.col.Protocol -e _ws.col.Info");
  ASSERT_EQ(lines.size(), log().size());
  const std::string protocol = "CANopen\t";
  std::set<std::string> kinds;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string kind = kind_of(log()[i].frame.identifier);
    EXPECT_TRUE(lines[i].starts_with(protocol + kind)) << lines[i] << "expected " << kind;
    kinds.insert(lines[i].substr(protocol.size()));
  }
  for (const std::string& service : services) {
    const auto found = kinds.lower_bound(service);
    EXPECT_TRUE(found != kinds.end() && found->starts_with(service)) << service;
  }
  for (const std::uint16_t identifier : {canopen::identifier::commit, canopen::identifier::tick}) {
    EXPECT_TRUE(
        std::ranges::any_of(log(), [&](const Transmission& sent) { return sent.frame.identifier == identifier; }));
  }
  // The dissector's own words for the contents of some.
  const auto contents = [&](const std::string& filter, const char* field) {
    const std::vector<std::string> found = dissect(path, "-Y '" + filter + "' -T fields -e " + field);
    return std::set<std::string>(found.begin(), found.end());
  };
  EXPECT_TRUE(contents("canopen.em.err_code", "canopen.em.err_code").contains("0x8210\n")) << "PDO of wrong length";
  const std::set<std::string> aborts = contents("canopen.sdo.abort_code && can.id < 0x600", "canopen.sdo.abort_code");
  EXPECT_TRUE(aborts.contains("0x06020000\n")) << "no such object";
  EXPECT_TRUE(aborts.contains("0x06070010\n")) << "wrong length";
  EXPECT_EQ(contents("canopen.sync.counter", "canopen.sync.counter").size(), canopen::sync_counters);
  EXPECT_EQ(dissect(path, "-Y '_ws.malformed || _ws.expert'"), std::vector<std::string>{});
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace proleg::sim
