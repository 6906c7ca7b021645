// Gives a module arbitrary flash contents and arbitrary LSS frames, SDO writes to its settings, resets and power cuts.
// After every event: a module without a node id sends answers of LSS only, the flash is written only where it is erased
// and only when it may be, and a restart finds settings that are in their ranges.

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <span>

#include "firmware/module/module.hpp"
#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using firmware::BoardRecord;
using test::FuzzInput;
using test::require;

struct PowerCut {};

class Flash final : public firmware::FlashPort {
 public:
  static constexpr std::size_t sector_size = 4 * BoardRecord::size;

  Flash() {
    for (auto& sector : sectors) {
      sector.fill(0xFF);
    }
  }
  bool erase(unsigned sector) override {
    require(may_be_written, "the flash is written only when it may be");
    if (cut_in == 0) {
      throw PowerCut();  // the old contents: the shortest erase
    }
    --cut_in;
    sectors.at(sector).fill(0xFF);
    return true;
  }
  bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) override {
    require(may_be_written, "the flash is written only when it may be");
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (i % 4 == 0 && cut_in-- == 0) {
        throw PowerCut();
      }
      std::uint8_t& byte = sectors.at(sector).at(offset + i);
      require(byte == 0xFF, "flash is erased where it is programmed");
      byte = bytes[i];
    }
    return true;
  }
  [[nodiscard]] std::span<const std::uint8_t> contents(unsigned sector) const override { return sectors.at(sector); }
  [[nodiscard]] std::optional<BoardRecord> newest() const { return firmware::newest(sectors[0], sectors[1]); }

  std::array<std::array<std::uint8_t, sector_size>, 2> sectors{};
  bool may_be_written = true;
  unsigned cut_in = ~0U;  ///< operations until the power fails
};

class World final : CanPort, firmware::ServoPort, firmware::ContactPort, firmware::SensorPort {
 public:
  explicit World(FuzzInput& input) : module_({0, 1, {7, 8, 9}}, {*this, *this, *this, *this, flash_}) {
    for (auto& sector : flash_.sectors) {
      for (std::size_t place = 0; place < sector.size(); place += BoardRecord::size) {
        write_record(std::span(sector).subspan(place, BoardRecord::size), input);
      }
    }
    power_on();
  }

  void handle(std::uint8_t event, FuzzInput& input) {
    try {
      take_event(event, input);
    } catch (const PowerCut&) {
      const std::optional<BoardRecord> found = flash_.newest();
      require(!before_ || found, "a power cut loses no record");
      flash_.cut_in = ~0U;
      power_on();
    }
    before_ = flash_.newest();
    check();
  }

 private:
  /// Erased, any bytes, or any bytes with the right checksum.
  static void write_record(std::span<std::uint8_t> place, FuzzInput& input) {
    const std::uint8_t kind = input.byte() % 4U;
    if (kind == 0) {
      return;
    }
    const auto bytes = input.take<BoardRecord::size>();
    std::copy(bytes.begin(), bytes.end(), place.begin());
    if (kind != 1) {
      place[3] = 0;  // sequence numbers that do not wrap in this life
      place[4] = static_cast<std::uint8_t>(kind == 2 ? place[4] % 4U : place[4]);
      Crc32 crc;
      for (std::size_t i = 0; i < BoardRecord::size - 4; ++i) {
        crc.add(place[i]);
      }
      write_little_endian(place, BoardRecord::size - 4, 4, crc.value());
    }
  }

  void power_on() {
    mailboxes_.clear();
    module_.power_on(now_);
    const std::optional<BoardRecord> record = flash_.newest();
    require(!record || record->valid(), "settings are in their ranges");
    require(module_.node() == (record ? record->node : 0U), "the node id is that of the newest record");
    before_ = record;
  }

  void take_event(std::uint8_t event, FuzzInput& input) {
    switch (event % 10U) {
      case 0:
        receive({0x7E5, static_cast<std::uint8_t>(input.byte() % 9U), input.take<8>()});
        break;
      case 1:
        receive({0x7E5, 8, input.take<8>()});
        break;
      case 2: {  // services that lead somewhere
        constexpr std::array<std::uint8_t, 9> services{0x04, 0x11, 0x13, 0x15, 0x17, 0x4C, 0x51, 0x5D, 0x5E};
        const std::uint8_t service = services.at(input.byte() % services.size());
        const std::uint8_t argument = input.byte();
        receive({0x7E5, 8, {service, static_cast<std::uint8_t>(service == services[0] ? argument % 2U : argument)}});
        break;
      }
      case 3: {  // numbers of its own address
        CanFrame frame{0x7E5, 8, {static_cast<std::uint8_t>(0x40 + input.byte() % 18U)}};
        const std::array<std::uint32_t, 4> address{canopen::placeholder_vendor, 1, 0x10000,
                                                   firmware::serial_number({0, 1, {7, 8, 9}})};
        write_little_endian(frame.data, 1, 4, address.at(input.byte() % 4U));
        frame.data[6] = input.byte() % 5U;
        frame.data[7] = input.byte() % 5U;
        receive(frame);
        break;
      }
      case 4: {
        constexpr std::array<canopen::Address, 8> entries{
            {{0x200A, 1}, {0x200A, 2}, {0x2020, 1}, {0x2020, 2}, {0x2020, 3}, {0x2020, 4}, {0x607D, 1}, {0x607D, 2}}};
        write(entries.at(input.byte() % entries.size()), input.word());
        break;
      }
      case 5:
        flash_.cut_in = input.byte() % 32U == 0 ? input.byte() % 12U : ~0U;
        write({static_cast<std::uint16_t>(0x1010 + input.byte() % 2U), 1},
              input.byte() % 2U != 0 ? canopen::signature_save : canopen::signature_load);
        break;
      case 6:
        receive(encode(
            canopen::NmtRequest{std::array{canopen::NmtCommand::start, canopen::NmtCommand::stop,
                                           canopen::NmtCommand::enter_pre_operational, canopen::NmtCommand::reset_node,
                                           canopen::NmtCommand::reset_communication}
                                    .at(input.byte() % 5U),
                                0}));
        break;
      case 7:
        now_ += Microseconds{input.byte()} * 1'000;
        module_.poll(now_);
        break;
      case 8:
        flash_.cut_in = input.byte() % 12U;
        break;
      default:
        flash_.cut_in = ~0U;
        power_on();
        break;
    }
    transmit();
  }

  void write(canopen::Address address, std::uint32_t value) {
    CanFrame frame{static_cast<std::uint16_t>(0x600 + module_.node()), 8, {0x22}};  // of any size
    write_little_endian(frame.data, 1, 2, address.index);
    frame.data[3] = address.sub;
    write_little_endian(frame.data, 4, 4, value);
    receive(frame);
  }
  void receive(CanFrame frame) {
    std::fill(frame.data.begin() + frame.length, frame.data.end(), std::uint8_t{0});
    flash_.may_be_written = module_.state() != canopen::NmtState::operational &&
                            module_.power() != canopen::PowerState::operation_enabled &&
                            module_.power() != canopen::PowerState::quick_stop_active;
    module_.receive(now_, frame);
  }
  void transmit() {
    while (!mailboxes_.empty()) {
      const CanFrame frame = mailboxes_.front();
      mailboxes_.pop_front();
      module_.transmitted(now_, frame);
    }
  }
  void check() {
    require(module_.node() <= canopen::max_node_id, "a node id is in its range");
    if (module_.next_deadline() <= now_) {
      module_.poll(now_);
    }
    require(module_.next_deadline() > now_, "the next deadline is later than now");
    transmit();
  }

  bool send(const CanFrame& frame) override {
    const bool is_lss = frame.identifier == canopen::identifier::lss_answer;
    require(is_lss || module_.node() != 0, "a module without a node id sends answers of LSS only");
    require(is_lss || canopen::identifier::node_of(frame.identifier) == module_.node(),
            "a module sends on its own identifiers");
    require(!is_lss || frame.length == 8, "answers of LSS have 8 bytes");
    mailboxes_.push_back(frame);
    return true;
  }
  void pulse(std::int32_t /*width*/, std::uint32_t /*period_us*/) override {
    require(false, "a module that is not configured sends no pulses");
  }
  void off() override {}
  std::uint8_t read_contacts() override { return 0; }
  ServoReadings take_readings() override { return {}; }
  void calibrate(const BoardRecord& board) override { require(board.valid(), "settings are in their ranges"); }

  Microseconds now_ = 0;
  Flash flash_;
  std::deque<CanFrame> mailboxes_;
  std::optional<BoardRecord> before_;
  firmware::Module module_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input({data, size});
  World world(input);
  while (!input.empty()) {
    const std::uint8_t event = input.byte();
    world.handle(event, input);
  }
  return 0;
}
