#include "tools/proleg/ui/hand_out.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

fs::path shipped_wave() { return source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"); }

TEST(HandOutTest, EachGetsAllFilesAsTheyAre) {
  const TemporaryFolder folder;
  const HandOut wave(shipped_wave());
  EXPECT_EQ(wave.title(), "uniform");
  const fs::path copy = wave.copy_to(folder.path());
  sim::DiskFiles disk;
  const sim::Scenario given = sim::read_scenario(shipped_wave(), disk);
  const sim::Scenario got = sim::read_scenario(folder / copy, disk);
  ASSERT_EQ(got.sources.size(), given.sources.size());
  for (std::size_t i = 0; i < got.sources.size(); ++i) {
    EXPECT_EQ(got.sources[i].text.str(), given.sources[i].text.str());
  }
}

TEST(HandOutTest, NothingIsOverwritten) {
  const TemporaryFolder folder;
  const HandOut wave(shipped_wave());
  const fs::path first = wave.copy_to(folder.path());
  const fs::path second = wave.copy_to(folder.path());
  EXPECT_NE(first, second);
  EXPECT_TRUE(fs::is_regular_file(folder / first));
  EXPECT_EQ(*second.begin(), "uniform 2");
}

TEST(HandOutTest, WhatAllBeginWithIsCopiedOnce) {
  const TemporaryFolder folder;
  const HandOut wave(shipped_wave());
  EXPECT_EQ(wave.copy_once_to(folder.path()), wave.copy_once_to(folder.path()));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(HandOutTest, AnotherFileIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(HandOut(folder.path()), InputError);
  EXPECT_THROW(HandOut(folder / "none.simulation.xml"), InputError);
}

}  // namespace
}  // namespace proleg::tools
