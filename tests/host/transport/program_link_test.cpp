
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "host/transport/open_transport.hpp"
#include "test_bus.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

using namespace test;

class ProgramLinkTest : public testing::Test {
 protected:
  std::unique_ptr<Transport> open(const std::string& file) {
    return open_slcan_transport(context, "sim:" + file, make_program_link(program, {file}), log);
  }

  const std::string program = program_folder() + "host_stand_in_bus";
  boost::asio::io_context context;
  Log log;
};

TEST_F(ProgramLinkTest, StartsAProgramAndSpeaksSlcanWithIt) {
  const auto transport = open("serve");
  const std::vector<CanFrame> frames = numbered_frames(2'000);
  ASSERT_TRUE(send_all(*transport, frames));
  ASSERT_TRUE(wait_for(context, [&] { return log.frames.size() == frames.size(); }));
  EXPECT_EQ(log.frames, frames);
}

TEST_F(ProgramLinkTest, ReportsAProgramThatEndsAtOnce) {
  EXPECT_EQ(message_of<TransportError>([&] { open("fail"); }), "sim:fail: " + program + " has ended with status 2");
}

TEST_F(ProgramLinkTest, ReportsAProgramThatEndsLater) {
  const auto transport = open("die");
  ASSERT_TRUE(transport->send(numbered_frame(0)));
  ASSERT_TRUE(wait_for(context, [&] { return !transport->state().is_connected; }));
  EXPECT_EQ(transport->state().reason, program + " has ended by signal 9");
  EXPECT_EQ(log.states.back(), transport->state());
}

TEST_F(ProgramLinkTest, EndsTheProgramWithTheTransport) {
  // A child that was not waited for would be a zombie, which waitpid finds.
  open("serve").reset();
  open("stay").reset();
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

TEST_F(ProgramLinkTest, NamesAProgramThatIsMissing) {
  const std::string missing = program_folder() + "no_such_program";
  EXPECT_EQ(message_of<TransportError>([&] {
              static_cast<void>(open_slcan_transport(context, "sim:x", make_program_link(missing, {"x"}), log));
            }),
            "sim:x: " + missing + " cannot be started: No such file or directory");
}

}  // namespace
}  // namespace proleg::host
