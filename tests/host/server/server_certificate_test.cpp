#include "host/server/server_certificate.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::host {
namespace {

namespace fs = std::filesystem;

/// Files that the openssl program makes.
class ServerCertificateTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "proleg_certificate_XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  void TearDown() override { fs::remove_all(folder); }

  fs::path make(const std::string& name, const std::string& options) const {
    const fs::path file = folder / name;
    run("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -keyout '" + file.string() + "' -out '" +
        file.string() + "' " + options);
    return file;
  }
  static void run(const std::string& command) {
    EXPECT_EQ(std::system((command + " 2>/dev/null").c_str()), 0) << command;
  }
  /// What is wrong with the files; empty: nothing.
  static std::string error(const fs::path& certificate, const fs::path& key) {
    try {
      const ServerCertificate read(certificate, key);
      return "";
    } catch (const InputError& found) {
      return found.what();
    }
  }

  fs::path folder;
};

TEST_F(ServerCertificateTest, NamesAreTheAlternativeNames) {
  const fs::path file = make("a.pem",
                             "-nodes -subj /CN=ignored -addext 'subjectAltName=DNS:Robot.local,DNS:*.example,"
                             "email:a@example,IP:192.168.1.5,IP:2001:DB8:0:0::7'");
  const ServerCertificate certificate(file, file);
  EXPECT_EQ(certificate.names(), (std::vector<std::string>{"robot.local", "192.168.1.5", "[2001:db8::7]"}));
  EXPECT_TRUE(certificate.warnings().empty());
}

TEST_F(ServerCertificateTest, WithoutThemItIsTheCommonName) {
  const fs::path file = make("a.pem", "-nodes -subj /O=lab/CN=Robot");
  EXPECT_EQ(ServerCertificate(file, file).names(), std::vector<std::string>{"robot"});
}

TEST_F(ServerCertificateTest, ANameIsNeeded) {
  for (const std::string subject : {"/O=lab", "'/CN=my robot'", "'/CN=*.example'"}) {
    const fs::path file = make("a.pem", "-nodes -subj " + subject);
    EXPECT_EQ(error(file, file), file.string() +
                                     ": found a certificate without a name, expected a name of this computer among its "
                                     "alternative names");
  }
}

TEST_F(ServerCertificateTest, AKeyThatOthersCanReadIsAWarning) {
  const fs::path file = make("a.pem", "-nodes -subj /CN=robot");
  fs::permissions(file, fs::perms::group_read, fs::perm_options::add);
  EXPECT_EQ(ServerCertificate(file, file).warnings(),
            std::vector<std::string>{file.string() + ": others can read the key: 'chmod 600' prevents it"});
}

TEST_F(ServerCertificateTest, AnOldCertificateIsAWarning) {
  const fs::path file = make("a.pem", "-nodes -subj /CN=robot");
  const fs::path old = folder / "old.pem";
  run("openssl x509 -in '" + file.string() + "' -signkey '" + file.string() + "' -days -1 -out '" + old.string() + "'");
  EXPECT_EQ(ServerCertificate(old, file).warnings(),
            std::vector<std::string>{old.string() + ": the certificate has expired"});
}

TEST_F(ServerCertificateTest, FilesThatDoNotFitAreRefused) {
  const fs::path file = make("a.pem", "-nodes -subj /CN=robot");
  const fs::path other = make("b.pem", "-nodes -subj /CN=robot");
  const fs::path locked = make("c.pem", "-passout pass:secret -subj /CN=robot");
  const fs::path empty = folder / "empty.pem";
  std::ofstream{empty};
  EXPECT_EQ(error(file, file), "");
  for (const auto& [certificate, key, wrong] :
       {std::tuple(file, other, other), std::tuple(locked, locked, locked), std::tuple(empty, file, empty),
        std::tuple(file, empty, empty), std::tuple(folder / "none", file, folder / "none"),
        std::tuple(file, folder, folder)}) {
    const std::string text = error(certificate, key);
    EXPECT_EQ(text.find(wrong.string() + ": found "), 0U) << text;
    EXPECT_NE(text.find("in PEM format"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace proleg::host
