// An adapter that answers arbitrary characters at arbitrary times. The client writes whole lines only, gives each frame
// exactly one fate, ends its start in time with an open channel or an error of one line, and never waits without a
// deadline. The same input as a word for a bus is an address or an error of one line.

#include <algorithm>
#include <cstdint>
#include <string>

#include "host/transport/bus_address.hpp"
#include "host/transport/slcan_client.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using namespace proleg::host;
using test::FuzzInput;
using test::require;

class Listener final : public SlcanClientListener {
 public:
  void received(Microseconds /*time*/, const CanFrame& frame) override {
    require(frame.identifier <= CanFrame::max_identifier && frame.length <= CanFrame::max_length, "frames are valid");
  }
  void transmitted(Microseconds /*time*/, const CanFrame& /*frame*/) override { ++transmissions; }
  void status_received(const CanStatus& /*status*/) override {}
  void errors_received(CanErrors /*errors*/) override {}

  std::uint64_t transmissions = 0;
};

void check_word(std::string_view word) {
  try {
    const BusAddress address = parse_bus_address(word);
    require(parse_bus_address(bus_address_text(address)) == address, "an address is read as it is written");
  } catch (const InputError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "an error is one line");
  }
}

class Run {
 public:
  explicit Run(FuzzInput& input) : input_(input) { client_.start(now_); }

  void step() {
    const std::uint8_t event = input_.byte();
    if (event < 0x80) {
      const char character = static_cast<char>(event);
      client_.input(now_, {&character, 1});
    } else if (event < 0xC0) {
      now_ += (event - 0x7FU) * 20'000U;
    } else if (event < 0xE0) {
      ++sends_;
      static_cast<void>(client_.send({0x601, 1, {event}}));
    } else if (event < 0xF0) {
      take(event - 0xDFU);
    } else if (event == 0xFE) {
      client_.stop();
    } else if (event == 0xFF) {
      client_.start(now_);
      start_ = now_;
      line_.clear();  // it is another connection
    } else {
      const char character = static_cast<char>(input_.byte());
      client_.input(now_, {&character, 1});
    }
    poll();
    check();
  }
  void finish() {
    for (unsigned steps = 0; client_.next_deadline() != never; ++steps) {
      require(steps < 200, "nothing is waited for without an end");
      now_ = std::max(now_, client_.next_deadline());
      poll();
      take(10'000);
    }
    require(client_.state() != SlcanClient::State::starting, "the start ends");
    client_.stop();
    const Statistics& statistics = client_.statistics();
    require(statistics.transmitted == listener_.transmissions, "transmissions are reported");
    require(sends_ == statistics.transmitted + statistics.refused + statistics.unconfirmed + statistics.dropped_out,
            "each frame has one fate");
  }

 private:
  void poll() {
    while (client_.next_deadline() <= now_) {
      client_.poll(now_);
    }
  }
  void take(std::size_t count) {
    for (const char character : client_.take(now_, count)) {
      if (character == '\r') {
        const bool is_command =
            line_ == "C" || line_ == "V" || line_ == "N" || line_ == "S8" || line_ == "Z0" || line_ == "O";
        require(is_command || parse_slcan_frame(line_), "the output has whole lines");
        line_.clear();
      } else {
        line_ += character;
      }
    }
  }
  void check() const {
    if (client_.state() == SlcanClient::State::failed) {
      require(!client_.error().empty() && client_.error().find('\n') == std::string::npos, "an error is one line");
      require(client_.error().size() < 300, "an error is short");
    }
    if (client_.state() == SlcanClient::State::starting) {
      require(client_.next_deadline() != never && now_ < start_ + 20'000'000U, "the start ends in time");
    }
  }

  FuzzInput& input_;
  Listener listener_;
  SlcanClient client_{listener_, SlcanClient::Settings{}};
  Microseconds now_ = 1'000'000;
  Microseconds start_ = now_;
  std::uint64_t sends_ = 0;
  std::string line_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_word({reinterpret_cast<const char*>(data), size});
  FuzzInput input({data, size});
  Run run(input);
  while (!input.empty()) {
    run.step();
  }
  run.finish();
  return 0;
}
