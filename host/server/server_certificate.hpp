#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace boost::asio::ssl {
class context;
}

struct x509_st;  // a certificate of OpenSSL

namespace proleg::host {

/// The certificate that proves the names of a server, and its key.
class ServerCertificate {
 public:
  /// Reads PEM files; both may be the same. Throws InputError.
  ServerCertificate(const std::filesystem::path& certificate, const std::filesystem::path& key);
  ~ServerCertificate();
  ServerCertificate(const ServerCertificate&) = delete;
  ServerCertificate& operator=(const ServerCertificate&) = delete;

  /// The alternative names of the certificate, or else its common name, as URLs have them: in small letters, IPv6 in
  /// brackets. At least one: if all have a wildcard, that of this computer below the first of them.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The names with a wildcard, such as "*.lab.example", which stands for one label.
  [[nodiscard]] const std::vector<std::string>& wildcards() const { return wildcards_; }
  /// Warnings, one line each, about properties that work but are not recommended.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// The server's side of TLS 1.2 and newer. Streams refer to it.
  [[nodiscard]] boost::asio::ssl::context& tls() const { return *tls_; }

 private:
  void read_names(const x509_st* certificate);

  std::unique_ptr<boost::asio::ssl::context> tls_;
  std::vector<std::string> names_;
  std::vector<std::string> wildcards_;
  std::vector<std::string> warnings_;
};

}  // namespace proleg::host
