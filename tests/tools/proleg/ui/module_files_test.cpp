// The files of a project that viewers may name for jobs on modules.

#include "tools/proleg/ui/module_files.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

class ModuleFilesTest : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text = "text") {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    files_.look();
  }

  /// The images of the project: one that was built beside this program has a whole path.
  [[nodiscard]] nlohmann::json images() const {
    nlohmann::json found = nlohmann::json::array();
    for (const nlohmann::json& image : files_.images()) {
      if (!image["file"].get<std::string>().starts_with("/")) {
        found.push_back(image);
      }
    }
    return found;
  }

  TemporaryFolder folder_;
  ModuleFiles files_{folder_.path()};
};

TEST_F(ModuleFilesTest, AnImageThatIsNoneIsShownWithTheReasonAndRefused) {
  write("a/broken.pimg", "PIMG");
  const nlohmann::json found = images();
  ASSERT_EQ(found.size(), 1U) << found;
  EXPECT_EQ(found[0]["file"], "a/broken.pimg");
  EXPECT_TRUE(found[0]["version"].is_null());
  EXPECT_TRUE(found[0]["problem"].is_string());
  EXPECT_THROW(static_cast<void>(files_.image("a/broken.pimg")), InputError);
}

TEST_F(ModuleFilesTest, OnlyWhatIsListedCanBeNamed) {
  write(".hidden/a.pimg");
  write("b.txt");
  write("below/c.params");
  fs::create_directory(folder_ / "folder.params");
  files_.look();
  EXPECT_TRUE(images().empty());
  EXPECT_TRUE(files_.settings().empty());
  for (const char* name : {"b.txt", "below/c.params", "../b.params", "/etc/passwd", "", "folder.params"}) {
    EXPECT_THROW(static_cast<void>(files_.image(name)), InputError) << name;
    EXPECT_THROW(static_cast<void>(files_.settings(name)), InputError) << name;
  }
  write("d.params");
  EXPECT_EQ(files_.settings(), std::vector<std::string>{"d.params"});
  EXPECT_EQ(files_.settings("d.params"), fs::absolute(folder_ / "d.params"));
}

TEST_F(ModuleFilesTest, NewSettingsHaveAPlainNameThatNoFileHas) {
  write("old.params");
  fs::create_symlink("nowhere", folder_ / "link.params");
  EXPECT_EQ(files_.new_settings("new.params"), fs::absolute(folder_ / "new.params"));
  for (const std::string& name :
       {std::string("old.params"), std::string("link.params"), std::string("../new.params"), std::string("new.txt"),
        std::string(".params"), std::string("a\nb.params"), std::string(70, 'x') + ".params"}) {
    EXPECT_THROW(static_cast<void>(files_.new_settings(name)), InputError) << name;
  }
}

}  // namespace
}  // namespace proleg::tools
