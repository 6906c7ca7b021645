// The tool that prepares a new module's flash writes a record that the module can read.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "firmware/module/board_record.hpp"
#include "tests/support/files.hpp"

namespace proleg::firmware {
namespace {

class BoardRecordFileTest : public testing::Test {
 protected:
  BoardRecordFileTest() {
    folder_ = std::filesystem::path(testing::TempDir()) / ("board_record_" + std::to_string(getpid()));
    std::filesystem::create_directory(folder_);
  }
  ~BoardRecordFileTest() override { std::filesystem::remove_all(folder_); }

  /// Exit status of the tool.
  int make(const std::string& options) const {
    return std::system((std::string(PROLEG_PYTHON " ") + source_path("/firmware/stm32f405/make_board_record.py ") +
                        options + " " + file().string() + " 2>" + (folder_ / "errors").string())
                           .c_str());
  }
  [[nodiscard]] std::vector<std::uint8_t> sectors() const {
    std::ifstream in(file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_ / "record.bin"; }

  std::filesystem::path folder_;
};

TEST_F(BoardRecordFileTest, HoldsTheRecordAtTheStartOfTwoErasedSectors) {
  ASSERT_EQ(make("--node 17 --feedback 612 3490"), 0);
  const std::vector<std::uint8_t> bytes = sectors();
  ASSERT_EQ(bytes.size(), 2U * 16 * 1024);
  const auto record = encode({17, true, 612, 3490}, 1);
  EXPECT_TRUE(std::equal(record.begin(), record.end(), bytes.begin()));
  EXPECT_TRUE(std::all_of(bytes.begin() + BoardRecord::size, bytes.end(), [](auto byte) { return byte == 0xFF; }));
}

TEST_F(BoardRecordFileTest, WithoutAPotentiometerSaysSo) {
  ASSERT_EQ(make("--node 126"), 0);
  const std::vector<std::uint8_t> bytes = sectors();
  const std::span<const std::uint8_t> all(bytes);
  EXPECT_EQ(newest(all.first(all.size() / 2), all.subspan(all.size() / 2)), (BoardRecord{126, false, 0, 0}));
}

TEST_F(BoardRecordFileTest, HoldsEverySettingOfTheBoard) {
  ASSERT_EQ(make("--node 3 --gateway --limits -45 60 --current 1500 250"), 0);
  const std::vector<std::uint8_t> bytes = sectors();
  EXPECT_EQ(newest(bytes, {}), (BoardRecord{3, false, 0, 0, true, -(1 << 29), 715827883, 1500, 250}));
}

TEST_F(BoardRecordFileTest, RefusesWhatTheModuleWouldNotTake) {
  for (const char* options : {"--node 0", "--node 127", "--node x", "", "--node 3 --feedback 5 5",
                              "--node 3 --feedback 5 4096", "--node 3 --feedback 5", "--node 3 --limits 1 2",
                              "--node 3 --limits -91 0", "--node 3 --limits - 0", "--node 3 --current 32768 1"}) {
    EXPECT_NE(make(options), 0) << options;
    EXPECT_FALSE(std::filesystem::exists(file())) << options;
  }
}

}  // namespace
}  // namespace proleg::firmware
