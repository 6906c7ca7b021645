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

TEST_F(ServerCertificateTest, AWildcardIsForOneLabelBeforeTwo) {
  const fs::path both = make("a.pem", "-nodes -subj /CN=x -addext 'subjectAltName=DNS:*.Lab.example,DNS:lab.example'");
  EXPECT_EQ(ServerCertificate(both, both).names(), std::vector<std::string>{"lab.example"});
  EXPECT_EQ(ServerCertificate(both, both).wildcards(), std::vector<std::string>{"*.lab.example"});
  const fs::path alone = make("b.pem", "-nodes -subj '/CN=*.lab.example'");
  const std::vector<std::string> names = ServerCertificate(alone, alone).names();
  ASSERT_EQ(names.size(), 1U) << "a page needs an address";
  EXPECT_TRUE(names.front().ends_with(".lab.example") && names.front().front() != '*') << names.front();
  const fs::path odd =
      make("c.pem", "-nodes -subj /CN=x -addext 'subjectAltName=DNS:a*.lab.example,DNS:x.*.example,DNS:b'");
  EXPECT_EQ(ServerCertificate(odd, odd).names(), std::vector<std::string>{"b"});
  EXPECT_TRUE(ServerCertificate(odd, odd).wildcards().empty());
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

TEST_F(ServerCertificateTest, AKeyOfAnotherCertificateIsRefused) {
  const auto key = [this](const std::string& name, const std::string& options) {
    run("openssl genpkey " + options + " -out '" + (folder / name).string() + "'");
    return folder / name;
  };
  const fs::path rsa = key("rsa.key", "-algorithm RSA -pkeyopt rsa_keygen_bits:2048");
  const fs::path ec = key("ec.key", "-algorithm EC -pkeyopt ec_paramgen_curve:prime256v1");
  const fs::path edwards = key("ed.key", "-algorithm ED25519");
  const fs::path pss = key("pss.key", "-algorithm RSA-PSS -pkeyopt rsa_keygen_bits:2048");
  const fs::path exchange = key("x.key", "-algorithm X25519");
  run("openssl dsaparam -out '" + (folder / "dsa.key").string() + "' -genkey 1024");
  const fs::path dsa = folder / "dsa.key";
  for (const fs::path& own : {rsa, ec, edwards, pss, dsa}) {
    const fs::path certificate = folder / "own.pem";
    run("openssl req -x509 -subj /CN=robot -key '" + own.string() + "' -out '" + certificate.string() + "'");
    EXPECT_EQ(error(certificate, own), own == dsa ? certificate.string() +
                                                        ": found a key of DSA, which TLS 1.2 and newer "
                                                        "do not use, expected one of EC or RSA"
                                                  : "");
    for (const fs::path& other : {rsa, ec, edwards, pss, exchange, dsa}) {
      if (own != other) {
        EXPECT_EQ(error(certificate, other), other.string() +
                                                 ": found the key of another certificate, expected the key "
                                                 "of the certificate in PEM format, without a password")
            << own;
      }
    }
  }
}

TEST_F(ServerCertificateTest, OneOfSeveralKeysIsThatOfTheCertificate) {
  const fs::path file = make("a.pem", "-nodes -subj /CN=robot");
  const fs::path other = make("b.pem", "-nodes -subj /CN=other");
  const auto join = [this](const std::string& name, const fs::path& first, const fs::path& second) {
    run("cat '" + first.string() + "' '" + second.string() + "' > '" + (folder / name).string() + "'");
    return folder / name;
  };
  EXPECT_EQ(error(file, join("keys.pem", other, file)), "");
  const fs::path turned = join("turned.pem", other, file);
  EXPECT_NE(error(turned, file).find("found the key of certificate 2 of the other file, not of its first"),
            std::string::npos);
}

TEST_F(ServerCertificateTest, AByteOrderMarkIsIgnored) {
  const fs::path file = make("a.pem", "-nodes -subj /CN=robot");
  const fs::path marked = folder / "marked.pem";
  run("(printf '\\357\\273\\277'; cat '" + file.string() + "') > '" + marked.string() + "'");
  EXPECT_EQ(error(marked, marked), "");
}

TEST_F(ServerCertificateTest, OtherFormsAreNamed) {
  const fs::path file = make("a.pem", "-nodes -subj /CN=robot");
  const fs::path pkcs12 = folder / "a.p12";
  run("openssl pkcs12 -export -passout pass: -in '" + file.string() + "' -out '" + pkcs12.string() + "'");
  const fs::path damaged = folder / "damaged.pem";
  std::ofstream(damaged) << "-----BEGIN CERTIFICATE-----\nMIIB\n-----END CERTIFICATE-----\n"
                            "-----BEGIN PRIVATE KEY-----\nMIIB\n-----END PRIVATE KEY-----\n";
  const fs::path text = folder / "text.pem";
  std::ofstream(text) << "Bag Attributes\n";
  const fs::path locked = make("c.pem", "-passout pass:secret -subj /CN=robot");
  EXPECT_NE(error(pkcs12, file).find("perhaps PKCS#12"), std::string::npos) << error(pkcs12, file);
  EXPECT_NE(error(file, pkcs12).find("perhaps PKCS#12"), std::string::npos);
  EXPECT_NE(error(text, file).find("no text with '-----BEGIN CERTIFICATE-----'"), std::string::npos);
  EXPECT_NE(error(damaged, file).find("certificate 1 damaged"), std::string::npos) << error(damaged, file);
  EXPECT_NE(error(file, damaged).find("no key that can be read"), std::string::npos) << error(file, damaged);
  EXPECT_NE(error(file, locked).find("a key that a password protects"), std::string::npos);
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
