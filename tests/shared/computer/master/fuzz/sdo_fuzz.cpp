// A client and a server of SDO on a bus that loses frames, stalls and carries frames of others. An input is a sequence
// of events. After every event the rules of both interfaces hold; after the last one, on a bus without losses, the
// transfer ends. Without foreign frames the device has only values that were written as a whole.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/canopen/messages.hpp"
#include "shared/canopen/sdo_server.hpp"
#include "shared/computer/master/sdo_transfer.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using test::FuzzInput;
using test::require;
using namespace proleg::canopen;
using Bytes = std::vector<std::uint8_t>;

constexpr Address domain{0x1F50, 1};
constexpr Address text{0x2F00, 0};
constexpr std::uint32_t longest = 2'000;

/// The declared dictionary, and two entries of long types. A part can fail.
class Device final : public ObjectAccess {
 public:
  AbortCode find(Address address, Entry& entry) override {
    if (address == domain) {
      entry = {address, DataType::domain, Access::read_write, false, 0, 0, longest, {}};
      return AbortCode::none;
    }
    if (address == text) {
      entry = {address, DataType::visible_string, Access::read_write, false, 0, 2, 30, {}};
      return AbortCode::none;
    }
    return find_entry(address, entry);
  }
  AbortCode read(const Entry& entry, std::uint32_t& value) override {
    require(!is_long(entry.type) && !fixed_value(entry, 1), "read() is for numbers that the server does not know");
    value = 0x12345678;
    return result();
  }
  AbortCode write(const Entry& entry, std::uint32_t value) override {
    require(entry.access == Access::read_write, "only entries that can be written are");
    require(check_range(entry, value) == AbortCode::none && extend(entry.type, value) == value, "values are in range");
    return result();
  }
  AbortCode open_read(const Entry& entry, std::uint32_t& size) override {
    require(is_long(entry.type), "open_read() is for long types");
    size = static_cast<std::uint32_t>(value_of(entry).size());
    return result();
  }
  AbortCode read_part(const Entry& entry, std::uint32_t offset, std::span<std::uint8_t> part) override {
    const Bytes& value = value_of(entry);
    require(!part.empty() && offset + part.size() <= value.size(), "parts are within the value");
    std::copy_n(value.begin() + offset, part.size(), part.begin());
    return result();
  }
  AbortCode open_write(const Entry& entry, std::optional<std::uint32_t> size) override {
    require(!is_open, "a write ends before the next begins");
    require(!size || (*size >= entry.minimum && *size <= entry.maximum), "sizes are within the limits");
    written.clear();
    const AbortCode code = result();
    is_open = code == AbortCode::none;
    return code;
  }
  AbortCode write_part(const Entry& entry, std::uint32_t offset, std::span<const std::uint8_t> part) override {
    require(is_open && offset == written.size() && !part.empty(), "parts follow each other");
    written.insert(written.end(), part.begin(), part.end());
    require(written.size() <= entry.maximum, "sizes are within the limits");
    return result();
  }
  AbortCode close_write(const Entry& entry, std::uint32_t size) override {
    require(is_open && size == written.size() && size >= entry.minimum, "the whole value has come");
    const AbortCode code = result();
    if (code == AbortCode::none) {
      is_open = false;
      value_of(entry) = written;
    }
    return code;
  }
  void cancel_write(const Entry& /*entry*/) override {
    require(is_open, "what is cancelled is open");
    is_open = false;
  }

  Bytes& value_of(const Entry& entry) { return entry.address == domain ? domain_value : text_value; }

  Bytes domain_value = Bytes(100, 0x55);
  Bytes text_value{'a', 'b', 'c', 'd', 'e'};
  Bytes written;
  bool is_open = false;
  unsigned calls_to_failure = 0;  ///< 0: none fails

 private:
  AbortCode result() {
    return calls_to_failure > 0 && --calls_to_failure == 0 ? AbortCode::hardware_error : AbortCode::none;
  }
};

class Link {
 public:
  explicit Link(FuzzInput& input) { start(input); }

  void handle(std::uint8_t event, FuzzInput& input) {
    switch (event % 16U) {
      case 10:
        static_cast<void>(from_client());
        break;
      case 11:
        static_cast<void>(from_server());
        break;
      case 12:
        pass(Microseconds{input.byte()} * 10'000);
        break;
      case 13:
        is_clean_ = false;
        to_server(random_frame(identifier::sdo_request + node, input));
        break;
      case 14:
        is_clean_ = false;
        client_.receive(now_, random_frame(identifier::sdo_answer + node, input));
        break;
      case 15:
        if (client_.state() == SdoTransfer::State::running) {
          client_.abort(AbortCode::general_error);
          static_cast<void>(client_.next_frame(now_));  // this frame may be lost, too
        }
        start(input);
        break;
      default:
        exchange((event & 0xF0U) == 0 ? 1U : event >> 4U);
        break;
    }
    check();
  }

  void finish() {
    device_.calls_to_failure = 0;
    for (unsigned steps = 0; client_.state() == SdoTransfer::State::running; ++steps) {
      require(steps < 200, "a transfer ends");
      exchange(1'000);
      if (client_.state() == SdoTransfer::State::running) {
        pass(std::min(client_.next_deadline(), server_.next_deadline()) - now_);
      }
    }
    check();
  }

 private:
  static constexpr std::uint8_t node = 5;

  void start(FuzzInput& input) {
    const std::uint8_t kind = input.byte();
    SdoTransferOptions options;
    options.attempts = 1U + kind % 4U;
    options.block_size = static_cast<std::uint8_t>(1U + input.byte() % 127U);
    options.largest_segmented = (kind & 4U) != 0 ? 21 : 0;
    device_.calls_to_failure = (kind & 8U) != 0 ? input.byte() : 0;
    constexpr std::array<Address, 4> addresses{domain, text, Address{0x1006, 0}, Address{0x1008, 0}};
    const Address address = addresses[kind >> 4U & 3U];
    if ((kind & 0x80U) != 0) {
      values_.emplace_back((unsigned{input.byte()} * 8U + input.byte()) % (longest + 10U));
      std::uint8_t byte = input.byte();
      for (std::uint8_t& each : values_.back()) {
        each = byte = static_cast<std::uint8_t>(byte * 5U + 3U);
      }
      data_ = values_.back();
      client_.download(node, address, data_, options);
    } else {
      data_.assign(unsigned{input.byte()} * 8U, 0);
      client_.upload(node, address, data_, options);
    }
    answers_.clear();
  }
  static CanFrame random_frame(unsigned identifier, FuzzInput& input) {
    CanFrame frame{static_cast<std::uint16_t>(identifier), 8, {}};
    for (std::uint8_t& byte : frame.data) {
      byte = input.byte();
    }
    if (input.byte() < 128) {
      frame.data[1] = static_cast<std::uint8_t>(domain.index);
      frame.data[2] = static_cast<std::uint8_t>(domain.index >> 8U);
      frame.data[3] = domain.sub;
    }
    return frame;
  }
  std::optional<CanFrame> from_client() {
    const std::optional<CanFrame> frame = client_.next_frame(now_);
    require(!frame || (frame->identifier == identifier::sdo_request + node && frame->length == 8),
            "frames are requests");
    return frame;
  }
  std::optional<CanFrame> from_server() {
    std::optional<CanFrame> frame;
    if (!answers_.empty()) {
      frame = answers_.front();
      answers_.erase(answers_.begin());
    } else if (server_.has_segment()) {
      frame = server_.next_segment(now_);
    }
    require(!frame || (frame->identifier == identifier::sdo_answer + node && frame->length == 8), "frames are answers");
    return frame;
  }
  void to_server(const CanFrame& frame) {
    if (const std::optional<CanFrame> answer = server_.receive(now_, frame)) {
      answers_.push_back(*answer);
    }
  }
  /// Some frames in each direction.
  void exchange(unsigned count) {
    for (bool is_idle = false; count > 0 && !is_idle; --count) {
      const std::optional<CanFrame> request = from_client();
      if (request) {
        to_server(*request);
      }
      const std::optional<CanFrame> answer = from_server();
      if (answer) {
        client_.receive(now_, *answer);
      }
      is_idle = !request && !answer;
    }
  }
  void pass(Microseconds time) {
    const Microseconds end = now_ + time;
    for (unsigned polls = 0;; ++polls) {
      require(polls < 1'000, "deadlines are not that close");
      const Microseconds next = std::min(client_.next_deadline(), server_.next_deadline());
      if (next > end) {
        break;
      }
      now_ = std::max(now_, next);
      client_.poll(now_);
      if (const std::optional<CanFrame> frame = server_.poll(now_)) {
        answers_.push_back(*frame);
      }
      require(std::min(client_.next_deadline(), server_.next_deadline()) > now_, "the next deadline is later than now");
    }
    now_ = end;
  }
  void check() const {
    require(client_.progress() <= data_.size(), "no more is transferred than there is");
    if (is_clean_) {
      const Bytes& value = device_.domain_value;
      require(value == Bytes(100, 0x55) || std::find(values_.begin(), values_.end(), value) != values_.end(),
              "a value was written as a whole");
    }
  }

  Microseconds now_ = 0;
  Device device_;
  SdoServer server_{node, device_};
  SdoTransfer client_;
  Bytes data_;
  std::vector<Bytes> values_;
  std::vector<CanFrame> answers_;
  bool is_clean_ = true;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input({data, size});
  Link link(input);
  while (!input.empty()) {
    const std::uint8_t event = input.byte();
    link.handle(event, input);
  }
  link.finish();
  return 0;
}
