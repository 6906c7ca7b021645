// Oracles: log2asc of can-utils reads the log; tshark dissects it as CANopen.

#include "sim/bus/candump_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "frames.hpp"
#include "sim/bus/bus.hpp"
#include "tests/support/lines_of.hpp"

namespace proleg::sim {
namespace {

class CandumpFile : public testing::Test {
 protected:
  CandumpFile() : path(testing::TempDir() + "candump_log_test." + std::to_string(getpid()) + ".log") {}
  ~CandumpFile() override { std::filesystem::remove(path); }

  std::string path;
};

TEST(CandumpLog, IsOneLineAFrameWithTheTimeOfItsEndInSeconds) {
  std::ostringstream text;
  CandumpLog log(text, "text");
  log.write(1'234'567'890'999, frame_of(0x123, {0xDE, 0xAD, 0xBE, 0xEF}));
  log.write(1'234'567'892'000, frame_of(0x7FF));
  log.write(0, frame_of(0x000, {0x01, 0x03}));
  log.finish();
  EXPECT_EQ(text.str(),
            "(0000001234.567890) can0 123#DEADBEEF\n"
            "(0000001234.567892) can0 7FF#\n"
            "(0000000000.000000) can0 000#0103\n");
}

TEST_F(CandumpFile, IsReadByCanUtilsByteForByte) {
  constexpr unsigned seed = 3;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::vector<std::string> expected;
  {
    CandumpLog log(path, "vcan7");
    for (std::uint64_t i = 0; i < 5000; ++i) {
      const CanFrame frame =
          random_frame(static_cast<std::uint16_t>(random() & 0x7FFU), static_cast<std::uint8_t>(random() % 9), random);
      log.write(1'000'000'000 + i * 1'000'001'000, frame);  // log2asc counts from the first frame
      std::array<char, 100> line{};
      std::snprintf(line.data(), line.size(), "%4llu.%06llu 1  %-16XRx   d %u", static_cast<unsigned long long>(i),
                    static_cast<unsigned long long>(i), unsigned{frame.identifier}, unsigned{frame.length});
      std::string text = line.data();
      for (const std::uint8_t byte : frame.bytes()) {
        std::snprintf(line.data(), line.size(), " %02X", unsigned{byte});
        text += line.data();
      }
      expected.push_back(text);
    }
    log.finish();
  }
  std::vector<std::string> read = test::lines_of(std::string(PROLEG_LOG2ASC) + " -I " + path + " vcan7");
  std::erase_if(read, [](const std::string& line) { return line.find(" Rx ") == std::string::npos; });
  ASSERT_EQ(read.size(), expected.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_EQ(read[i], expected[i] + "\n") << "line " << i;
  }
}

struct Dissected {
  CanFrame frame;
  std::string meaning;
};

TEST_F(CandumpFile, IsDissectedByTsharkAsCanopen) {
  const std::vector<Dissected> examples{
      {frame_of(0x080, {0x2D}), "SYNC [45]"},
      {frame_of(0x000, {0x01, 0x03}), "NMT: Start remote node [0x3]"},
      {frame_of(0x703, {0x00}), "NMT Error Control: Boot-up [0x3]"},
      {frame_of(0x703, {0x05}), "NMT Error Control: Operational [0x3]"},
      {frame_of(0x77F, {0x05}), "NMT Error Control: Operational [0x7f]"},
      {frame_of(0x083, {0x10, 0x23, 0x02, 0, 0, 0, 0, 0}), "EMCY"},
      {frame_of(0x603, {0x23, 0x80, 0x40, 0x01, 0x8E, 0xE3, 0x38, 0x0E}),
       "Default-SDO (rx): Initiate download request"},
      {frame_of(0x583, {0x60, 0x80, 0x40, 0x01, 0, 0, 0, 0}), "Default-SDO (tx): Initiate download response"},
      {frame_of(0x583, {0x80, 0x80, 0x40, 0x01, 0, 0, 0x02, 0x06}), "Default-SDO (tx): Abort transfer"},
      {frame_of(0x183, {0x8E, 0xE3, 0x38, 0x4E, 0x72, 0x1C, 0x83, 0x2C}), "PDO1 (tx)"},
      {frame_of(0x203, {0x0F, 0, 0, 0, 0, 0x20}), "PDO1 (rx)"},
      {frame_of(0x383, {0xEE, 0x1F, 0x5E, 0x01, 0x1F, 0}), "PDO3 (tx)"},
  };
  class Silent final : public BusListener {
   public:
    void received(BusTime /*time*/, const CanFrame& /*frame*/) override {}
    void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override {}
  };
  Bus bus;
  Silent node;
  Silent other;  // to acknowledge
  Controller& controller = bus.attach(node);
  bus.attach(other);
  CandumpLog log(path);
  bus.set_frame_listener([&](const Transmission& transmission) { log.write(transmission.end, transmission.frame); });
  for (std::size_t i = 0; i < examples.size(); ++i) {
    bus.advance_to(i * 1'000'000);
    ASSERT_TRUE(controller.send(examples[i].frame));
  }
  bus.advance_to(1'000'000'000);
  log.finish();

  const std::vector<std::string> read =
      test::lines_of(std::string(PROLEG_TSHARK) + " -r " + path + " -d can.subdissector,canopen 2>/dev/null");
  ASSERT_EQ(read.size(), examples.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NE(read[i].find(" CANopen "), std::string::npos) << read[i];
    EXPECT_TRUE(read[i].ends_with(examples[i].meaning + "\n")) << read[i] << examples[i].meaning;
  }
}

std::string message_of(const std::string& path) {
  try {
    CandumpLog log{std::filesystem::path(path)};
    log.write(0, frame_of(1));
    log.finish();
  } catch (const CandumpLogError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CandumpLog, NamesTheReasonWhenItCannotBeWritten) {
  EXPECT_EQ(message_of("/no/such/folder/x.log"), "/no/such/folder/x.log: cannot be written: No such file or directory");
  EXPECT_EQ(message_of("/dev/full"), "/dev/full: cannot be written: No space left on device");
  std::ostringstream broken;
  broken.setstate(std::ios::badbit);
  CandumpLog log(broken, "pipe");
  log.write(0, frame_of(1));
  EXPECT_THROW(log.finish(), CandumpLogError);
}

}  // namespace
}  // namespace proleg::sim
