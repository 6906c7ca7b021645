#include "host/server/seats.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace proleg::host {
namespace {

using namespace std::chrono_literals;

constexpr SendingBudget::Time start{};

TEST(SeatPathTest, ASeatHasOnePath) {
  const auto socket = seat_path("/robots/3/socket?look");
  ASSERT_TRUE(socket);
  EXPECT_EQ(socket->seat, std::optional<SeatNumber>(3));
  EXPECT_EQ(socket->target, "/socket?look");
  EXPECT_EQ(seat_path("/robots/0/")->target, "/");
  for (const char* wrong : {"/robots/", "/robots/3", "/robots/03/", "/robots/-3/", "/robots/+3/", "/robots/3x/",
                            "/robots/ 3/", "/robots//", "/robots/99999999999/", "/robots/3?look"}) {
    EXPECT_FALSE(seat_path(wrong)) << wrong;
  }
}

TEST(SeatPathTest, OtherPathsAreThoseOfTheServer) {
  for (const char* own : {"/", "/socket", "/robots", "/app.js", "", "*"}) {
    const auto path = seat_path(own);
    ASSERT_TRUE(path) << own;
    EXPECT_FALSE(path->seat) << own;
    EXPECT_EQ(path->target, own);
  }
}

TEST(SeatPathTest, OneWordSaysThatSomebodyOnlyLooksOn) {
  EXPECT_TRUE(only_looks("/socket?look"));
  EXPECT_FALSE(only_looks("/socket"));
  EXPECT_FALSE(only_looks("/socket?looks"));
}

TEST(SendingBudgetTest, TheLargestMeshPassesAtOnce) {
  SendingBudget budget(start);
  constexpr std::size_t mesh_in_base64 = std::size_t{20} * 1024 * 1024 * 4 / 3;
  EXPECT_EQ(budget.spend(start, mesh_in_base64), 0ms);
}

TEST(SendingBudgetTest, WhoSendsWithoutEndIsSlowedToTheRate) {
  SendingBudget budget(start);
  SendingBudget::Time now = start;
  constexpr std::size_t piece = 16 * 1024;
  double sent = 0;
  while (now < start + 1h) {
    now += budget.spend(now, piece) + 1ms;
    sent += piece;
  }
  EXPECT_LE(sent, SendingBudget::most_bytes + 3600 * SendingBudget::bytes_per_second + 2 * piece);
  EXPECT_GE(sent, 0.9 * 3600 * SendingBudget::bytes_per_second);
}

TEST(SendingBudgetTest, ASliderIsNeverSlowed) {
  SendingBudget budget(start);
  constexpr std::size_t message = 200;
  for (SendingBudget::Time now = start; now < start + 10min; now += 16ms) {
    ASSERT_EQ(budget.spend(now, message), 0ms);
  }
}

TEST(SeatVisitorsTest, AComputerHasOnlySoManyConnectionsToASeat) {
  SeatVisitors visitors;
  std::vector<std::unique_ptr<SeatVisitors::Visit>> visits;
  for (unsigned i = 0; i < SeatVisitors::max_connections; ++i) {
    visits.push_back(visitors.begin(3, "192.0.2.1", start));
    ASSERT_NE(visits.back(), nullptr);
  }
  EXPECT_EQ(visitors.begin(3, "192.0.2.1", start), nullptr);
  EXPECT_NE(visitors.begin(4, "192.0.2.1", start), nullptr);
  EXPECT_NE(visitors.begin(3, "192.0.2.2", start), nullptr);
  visits.pop_back();
  EXPECT_NE(visitors.begin(3, "192.0.2.1", start), nullptr);
}

TEST(SeatVisitorsTest, AComputerThatComesBackDoesNotGetANewBudget) {
  SeatVisitors visitors;
  constexpr auto much = static_cast<std::size_t>(SendingBudget::most_bytes);
  EXPECT_EQ(visitors.begin(3, "192.0.2.1", start)->budget().spend(start, much), 0ms);
  EXPECT_GT(visitors.begin(3, "192.0.2.1", start)->budget().spend(start, 1), 0ms);
  EXPECT_EQ(visitors.begin(3, "192.0.2.1", start + 1h)->budget().spend(start + 1h, 1), 0ms);
}

}  // namespace
}  // namespace proleg::host
