#include "host/server/page_files.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::host {
namespace {

class PageFilesOfAFolder : public testing::Test {
 protected:
  PageFilesOfAFolder() {
    write("index.html", "<p>");
    std::filesystem::create_directories(folder / "icons");
    write("icons/a.svg", std::string("<svg/>\0", 7));
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  std::string error() const {
    return message_of<InputError>([this] { PageFiles{folder.path()}; });
  }

  const TemporaryFolder folder;
};

TEST_F(PageFilesOfAFolder, AreFoundByTheirPath) {
  const PageFiles files(folder.path());
  ASSERT_NE(files.find("/"), nullptr);
  EXPECT_EQ(files.find("/")->bytes, "<p>");
  EXPECT_EQ(files.find("/"), files.find("/index.html"));
  ASSERT_NE(files.find("/icons/a.svg"), nullptr);
  EXPECT_EQ(files.find("/icons/a.svg")->bytes, std::string("<svg/>\0", 7));
  for (const char* path :
       {"", "index.html", "/icons", "/icons/", "/icons/../index.html", "//index.html", "/index.htm"}) {
    EXPECT_EQ(files.find(path), nullptr) << path;
  }
}

TEST_F(PageFilesOfAFolder, HaveTheirContentType) {
  for (const char* name : {"a.js", "a.css", "a.png", "a.json", "a.js.map", "a.woff2", "a.txt"}) {
    write(name, "x");
  }
  const PageFiles files(folder.path());
  EXPECT_EQ(files.find("/")->content_type, "text/html; charset=utf-8");
  EXPECT_EQ(files.find("/a.js")->content_type, "text/javascript; charset=utf-8");
  EXPECT_EQ(files.find("/a.css")->content_type, "text/css; charset=utf-8");
  EXPECT_EQ(files.find("/a.png")->content_type, "image/png");
  EXPECT_EQ(files.find("/a.json")->content_type, "application/json");
  EXPECT_EQ(files.find("/a.js.map")->content_type, "application/json");
  EXPECT_EQ(files.find("/a.woff2")->content_type, "font/woff2");
  EXPECT_EQ(files.find("/icons/a.svg")->content_type, "image/svg+xml");
}

TEST_F(PageFilesOfAFolder, AreReadOnce) {
  const PageFiles files(folder.path());
  write("index.html", "changed");
  EXPECT_EQ(files.find("/")->bytes, "<p>");
}

TEST_F(PageFilesOfAFolder, DoNotFollowLinks) {
  const TemporaryFolder other;
  std::ofstream(other / "secret.txt") << "secret";
  std::filesystem::create_symlink(other / "secret.txt", folder / "a.txt");
  EXPECT_EQ(error(), (folder / "a.txt").string() + ": found neither a file nor a folder, expected one of these");
  std::filesystem::remove(folder / "a.txt");
  std::filesystem::create_directory_symlink(other.path(), folder / "a");
  EXPECT_EQ(error(), (folder / "a").string() + ": found neither a file nor a folder, expected one of these");
}

TEST_F(PageFilesOfAFolder, AreOfKnownTypes) {
  write("a.exe", "x");
  EXPECT_EQ(error(), (folder / "a.exe").string() +
                         ": found a file of another type, expected one of html, js, css, txt, json, map, svg, png, "
                         "webp, xml, ico, woff2");
}

TEST_F(PageFilesOfAFolder, NeedAnIndex) {
  std::filesystem::remove(folder / "index.html");
  EXPECT_EQ(error(), folder.path().string() + ": found no file index.html, expected the folder of the page");
}

TEST_F(PageFilesOfAFolder, HaveABoundedSize) {
  write("large.txt", "");
  std::filesystem::resize_file(folder / "large.txt", (64U << 20U) + 1);
  EXPECT_EQ(error(), folder.path().string() + ": found more than 64 MiB, expected the folder of the page");
}

TEST_F(PageFilesOfAFolder, AsDocumentsAreBelowTheirPath) {
  const DocumentFiles documents(folder.path(), "/docs/");
  ASSERT_TRUE(documents.read("/docs/"));
  EXPECT_EQ(documents.read("/docs/")->bytes, "<p>");
  EXPECT_EQ(documents.read("/docs/index.html")->content_type, "text/html; charset=utf-8");
  ASSERT_TRUE(documents.read("/docs/icons/a.svg"));
  EXPECT_EQ(documents.read("/docs/icons/a.svg")->bytes, std::string("<svg/>\0", 7));
  for (const char* path :
       {"", "/", "/docs", "/index.html", "/docs/icons", "/docs/icons/../index.html", "/docs//index.html"}) {
    EXPECT_FALSE(documents.read(path)) << path;
  }
  EXPECT_FALSE(DocumentFiles().read("/docs/"));
}

TEST_F(PageFilesOfAFolder, AsDocumentsMayHaveAnyType) {
  write("robot.eds", "x");
  const DocumentFiles documents(folder.path(), "/docs/");
  ASSERT_TRUE(documents.read("/docs/robot.eds"));
  EXPECT_EQ(documents.read("/docs/robot.eds")->content_type, "application/octet-stream");
}

TEST_F(PageFilesOfAFolder, AsDocumentsAreReadWhenTheyAreAskedFor) {
  const DocumentFiles documents(folder.path(), "/docs/");
  write("index.html", "changed");
  write("later.html", "is not known");
  std::filesystem::remove(folder / "icons/a.svg");
  ASSERT_TRUE(documents.read("/docs/index.html"));
  EXPECT_EQ(documents.read("/docs/index.html")->bytes, "changed");
  EXPECT_FALSE(documents.read("/docs/later.html"));
  EXPECT_FALSE(documents.read("/docs/icons/a.svg"));
}

TEST_F(PageFilesOfAFolder, AsDocumentsAreNoLinks) {
  const TemporaryFolder other;
  std::ofstream(other / "secret.txt") << "secret";
  std::filesystem::create_symlink(other / "secret.txt", folder / "a.txt");
  EXPECT_FALSE(DocumentFiles(folder.path(), "/docs/").read("/docs/a.txt"));
}

}  // namespace
}  // namespace proleg::host
