#include "host/server/server_certificate.hpp"

#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ssl/context.hpp>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::host {
namespace {

namespace asio = boost::asio;

void require_readable(const std::filesystem::path& file, const std::string& expected) {
  if (!std::ifstream(file).good()) {
    throw InputError(file.string(), 0, std::strerror(errno), expected);
  }
}

std::string_view bytes_of(const ASN1_STRING* text) {
  return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
          static_cast<std::size_t>(ASN1_STRING_length(text))};
}

/// The name as a browser writes it into Host; nothing if it cannot be there.
std::optional<std::string> host_name(std::string_view name) {
  std::string small;
  for (const char letter : name) {
    small += letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  }
  constexpr const char* allowed = "abcdefghijklmnopqrstuvwxyz0123456789-._";
  return small.empty() || small.find_first_not_of(allowed) != std::string::npos ? std::nullopt : std::optional(small);
}

std::optional<std::string> host_address(std::string_view bytes) {
  if (bytes.size() == asio::ip::address_v4::bytes_type().size()) {
    asio::ip::address_v4::bytes_type address{};
    std::copy(bytes.begin(), bytes.end(), address.begin());
    return asio::ip::address_v4(address).to_string();
  }
  if (bytes.size() == asio::ip::address_v6::bytes_type().size()) {
    asio::ip::address_v6::bytes_type address{};
    std::copy(bytes.begin(), bytes.end(), address.begin());
    return '[' + asio::ip::address_v6(address).to_string() + ']';
  }
  return std::nullopt;
}

std::vector<std::string> alternative_names(const X509* certificate) {
  std::vector<std::string> names;
  const std::unique_ptr<GENERAL_NAMES, decltype(&GENERAL_NAMES_free)> found(
      static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)),
      &GENERAL_NAMES_free);
  for (int i = 0; found != nullptr && i < sk_GENERAL_NAME_num(found.get()); ++i) {
    int kind = 0;
    const auto* const value =
        static_cast<const ASN1_STRING*>(GENERAL_NAME_get0_value(sk_GENERAL_NAME_value(found.get(), i), &kind));
    std::optional<std::string> name;
    if (kind == GEN_DNS) {
      name = host_name(bytes_of(value));
    } else if (kind == GEN_IPADD) {
      name = host_address(bytes_of(value));
    }
    if (name) {
      names.push_back(*name);
    }
  }
  return names;
}

std::optional<std::string> common_name(const X509* certificate) {
  const X509_NAME* const subject = X509_get_subject_name(certificate);
  const int position = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  if (position < 0) {
    return std::nullopt;
  }
  return host_name(bytes_of(X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, position))));
}

}  // namespace

ServerCertificate::ServerCertificate(const std::filesystem::path& certificate, const std::filesystem::path& key)
    : tls_(std::make_unique<asio::ssl::context>(asio::ssl::context::tls_server)) {
  const std::string expected_certificate = "a certificate in PEM format";
  const std::string expected_key = "the key of the certificate in PEM format, without a password";
  require_readable(certificate, expected_certificate);
  require_readable(key, expected_key);
  tls_->set_options(asio::ssl::context::no_tlsv1 | asio::ssl::context::no_tlsv1_1 | asio::ssl::context::no_compression |
                    static_cast<long>(SSL_OP_NO_RENEGOTIATION));
  boost::system::error_code error;
  tls_->use_certificate_chain_file(certificate.string(), error);
  if (error) {
    throw InputError(certificate.string(), 0, error.message(), expected_certificate);
  }
  // Without this function OpenSSL asks for the password on the terminal.
  tls_->set_password_callback([](std::size_t, asio::ssl::context::password_purpose) { return std::string(); }, error);
  tls_->use_private_key_file(key.string(), asio::ssl::context::pem, error);
  if (error) {
    throw InputError(key.string(), 0, error.message(), expected_key);
  }
  const X509* const own = SSL_CTX_get0_certificate(tls_->native_handle());
  names_ = alternative_names(own);
  if (names_.empty()) {
    if (const std::optional<std::string> name = common_name(own)) {
      names_.push_back(*name);
    }
  }
  if (names_.empty()) {
    throw InputError(certificate.string(), 0, "a certificate without a name",
                     "a name of this computer among its alternative names");
  }
  if (X509_cmp_current_time(X509_get0_notAfter(own)) < 0) {
    warnings_.push_back(certificate.string() + ": the certificate has expired");
  }
  struct stat status {};
  if (::stat(key.c_str(), &status) == 0 && (status.st_mode & (S_IRGRP | S_IROTH)) != 0) {
    warnings_.push_back(key.string() + ": others can read the key: 'chmod 600' prevents it");
  }
}

ServerCertificate::~ServerCertificate() = default;

}  // namespace proleg::host
