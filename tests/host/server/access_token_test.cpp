#include "host/server/request_policy.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <set>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::host {
namespace {

TEST(AccessToken, HasTwoHundredFiftySixBitsInBase64Url) {
  const AccessToken token = AccessToken::make();
  EXPECT_EQ(token.text().size(), 43U);
  EXPECT_EQ(token.text().find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
            std::string::npos);
}

TEST(AccessToken, IsAnotherOneEachTime) {
  std::set<std::string> texts;
  for (int i = 0; i < 1000; ++i) {
    texts.insert(AccessToken::make().text());
  }
  EXPECT_EQ(texts.size(), 1000U);
}

TEST(AccessToken, MatchesOnlyItself) {
  const AccessToken token = AccessToken::make();
  EXPECT_TRUE(token.matches(token.text()));
  EXPECT_FALSE(token.matches(""));
  EXPECT_FALSE(token.matches(token.text() + "A"));
  EXPECT_FALSE(token.matches(token.text().substr(1)));
  for (std::size_t i = 0; i < token.text().size(); ++i) {
    std::string other = token.text();
    other[i] = other[i] == 'x' ? 'y' : 'x';
    EXPECT_FALSE(token.matches(other)) << i;
  }
}

TEST(PrivateFile, IsForItsOwnerOnlyWhateverTheMask) {
  const TemporaryFolder folder;
  const mode_t mask = umask(0);
  write_private_file(folder / "token", "first\n");
  umask(mask);
  struct stat status {};
  ASSERT_EQ(stat((folder / "token").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  EXPECT_EQ(file_contents(folder / "token"), "first\n");
}

TEST(PrivateFile, ReplacesAFileThatOthersMayRead) {
  const TemporaryFolder folder;
  write_private_file(folder / "token", "first, which is longer\n");
  ASSERT_EQ(chmod((folder / "token").c_str(), 0644), 0);
  write_private_file(folder / "token", "second\n");
  struct stat status {};
  ASSERT_EQ(stat((folder / "token").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  EXPECT_EQ(file_contents(folder / "token"), "second\n");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"token"}) << "no temporary file is left";
}

TEST(PrivateFile, ReplacesALinkAndNotWhatItPointsTo) {
  const TemporaryFolder folder;
  write_private_file(folder / "other", "other\n");
  std::filesystem::create_symlink(folder / "other", folder / "token");
  write_private_file(folder / "token", "secret\n");
  EXPECT_EQ(file_contents(folder / "other"), "other\n");
  EXPECT_EQ(file_contents(folder / "token"), "secret\n");
}

TEST(PrivateFile, ThatCannotBeWrittenIsAnError) {
  const TemporaryFolder folder;
  const auto path = folder / "missing/token";
  EXPECT_EQ(message_of<FileError>([&] { write_private_file(path, "x"); }),
            path.string() + ": No such file or directory");
}

}  // namespace
}  // namespace proleg::host
