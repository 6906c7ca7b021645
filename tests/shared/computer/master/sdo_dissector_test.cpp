// Oracle: tshark dissects a recorded session of every SDO service as CANopen.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sdo_link.hpp"
#include "sim/bus/candump_log.hpp"
#include "tests/support/lines_of.hpp"

namespace proleg::canopen {
namespace {

using test::Bytes;
using test::random_bytes;

TEST(SdoSession, OfEveryServiceIsDissectedByTsharkWithoutAMalformedPacket) {
  const std::string path = testing::TempDir() + "sdo_dissector_test." + std::to_string(getpid()) + ".log";
  std::size_t frames = 0;
  {
    test::SdoLink link;
    sim::CandumpLog log{std::filesystem::path(path)};
    link.bus.set_frame_listener([&](const sim::Transmission& transmission) {
      log.write(transmission.end, transmission.frame);
      ++frames;
    });
    for (const std::size_t size : {4U, 20U, 900U}) {  // expedited, segments, block with two sub-blocks
      const Bytes bytes = random_bytes(size);
      link.download(bytes);
      EXPECT_EQ(link.upload(size), bytes);
    }
    link.loses = [](const CanFrame& /*sent*/, std::size_t position) { return position == 3; };
    link.download(random_bytes(100));  // a sub-block is sent again
    link.loses = {};
    link.device.refusal = AbortCode::refused_by_state;
    link.download(random_bytes(100));  // an abort by the server
    link.device.refusal = AbortCode::none;
    link.upload(50);  // an abort by the client: 100 bytes do not fit
    log.finish();
  }
  const std::string tshark = std::string(PROLEG_TSHARK) + " -r " + path + " -d can.subdissector,canopen 2>/dev/null";
  const std::vector<std::string> read = test::lines_of(tshark);
  EXPECT_EQ(read.size(), frames);
  for (const std::string& line : read) {
    EXPECT_NE(line.find(" CANopen "), std::string::npos) << line;
    EXPECT_EQ(line.find("Malformed"), std::string::npos) << line;
    EXPECT_EQ(line.find("Unknown"), std::string::npos) << line;
  }
  for (const char* service :
       {"Initiate download request", "Initiate download response", "Download segment request",
        "Download segment response", "Initiate upload request", "Initiate upload response", "Upload segment request",
        "Upload segment response", "Block download", "Block upload", "Abort transfer"}) {
    EXPECT_TRUE(std::any_of(read.begin(), read.end(), [&](const std::string& line) {
      return line.find(service) != std::string::npos;
    })) << service;
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace proleg::canopen
