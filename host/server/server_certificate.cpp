#include "host/server/server_certificate.hpp"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ssl/context.hpp>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/errors/secret_file.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

namespace asio = boost::asio;

constexpr const char* expected_certificate = "a certificate in PEM format";
constexpr const char* expected_key = "the key of the certificate in PEM format, without a password";

struct Free {
  void operator()(BIO* bio) const { BIO_free(bio); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Bio = std::unique_ptr<BIO, Free>;
using Certificate = std::unique_ptr<X509, Free>;
using Key = std::unique_ptr<EVP_PKEY, Free>;

/// The text of a file that has this mark. OpenSSL says only "no start line" of others.
std::string read_pem(const std::filesystem::path& file, std::string_view mark, const std::string& expected) {
  const auto refuse = [&](const std::string& found) { throw InputError(file.string(), 0, found, expected); };
  if (const std::optional<std::string> found = found_instead_of_file(file)) {
    refuse(*found);
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream.good()) {
    refuse(std::strerror(errno));
  }
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) {
    text.erase(0, byte_order_mark.size());
  }
  if (text.empty()) {
    refuse("an empty file");
  }
  if (text.find(mark) == std::string::npos) {
    constexpr char sequence = 0x30;  // of DER (ITU-T X.690), in which PKCS#12 is written, too
    refuse(text.front() == sequence && text.find('\0') != std::string::npos
               ? "a binary file, perhaps PKCS#12 ('openssl pkcs12 -nodes -in FILE -out NEW' makes PEM of it)"
               : "no text with '" + std::string(mark) + "'");
  }
  return text;
}

Bio bio_of(const std::string& text) { return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))); }

/// The reason of the last error of OpenSSL.
std::string take_reason() {
  const char* const reason = ERR_reason_error_string(ERR_peek_last_error());
  ERR_clear_error();
  return reason == nullptr ? "an error without a reason" : reason;
}

/// OpenSSL asks this function for a password; otherwise it asks the terminal.
int no_password(char* /*text*/, int /*size*/, int /*writes*/, void* was_asked) {
  *static_cast<bool*>(was_asked) = true;
  return -1;
}

/// The private key of the first certificate, among those of a text.
Key key_of(const std::vector<Certificate>& chain, const std::filesystem::path& file, const std::string& text) {
  std::string other = "the key of another certificate";
  const Bio bio = bio_of(text);
  bool was_asked = false;
  bool has_key = false;
  while (bio != nullptr) {
    Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, &was_asked));
    if (key == nullptr) {
      break;
    }
    has_key = true;
    const auto its = std::ranges::find_if(
        chain, [&](const Certificate& one) { return X509_check_private_key(one.get(), key.get()) == 1; });
    if (its == chain.begin()) {
      ERR_clear_error();
      return key;
    }
    if (its != chain.end()) {
      other =
          "the key of certificate " + std::to_string(its - chain.begin() + 1) + " of the other file, not of its first";
    }
  }
  const std::string reason = take_reason();
  throw InputError(file.string(), 0,
                   was_asked ? "a key that a password protects ('openssl pkey -in FILE -out NEW' removes it)"
                   : has_key ? other
                             : "no key that can be read: " + reason,
                   expected_key);
}

/// The certificate of this computer, and behind it those that lead to an authority.
std::vector<Certificate> read_chain(const std::filesystem::path& file, const std::string& text) {
  std::vector<Certificate> chain;
  const Bio bio = bio_of(text);
  while (bio != nullptr) {
    Certificate next(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr));
    if (next == nullptr) {
      break;
    }
    chain.push_back(std::move(next));
  }
  const unsigned long error = ERR_peek_last_error();
  const std::string reason = take_reason();
  if (chain.empty() || ERR_GET_LIB(error) != ERR_LIB_PEM || ERR_GET_REASON(error) != PEM_R_NO_START_LINE) {
    throw InputError(file.string(), 0, "certificate " + std::to_string(chain.size() + 1) + " damaged: " + reason,
                     expected_certificate);
  }
  return chain;
}

std::string_view bytes_of(const ASN1_STRING* text) {
  return text == nullptr ? std::string_view()
                         : std::string_view(reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
                                            static_cast<std::size_t>(ASN1_STRING_length(text)));
}

/// The name as a browser writes it into Host; nothing if it cannot be there. A wildcard stands for one label, before
/// two others at least (RFC 6125, section 6.4.3).
std::optional<std::string> host_name(std::string_view name) {
  constexpr std::string_view wildcard = "*.";
  std::string small = lower_case(std::string(name));
  const std::string_view rest = std::string_view(small).substr(small.starts_with(wildcard) ? wildcard.size() : 0);
  constexpr const char* allowed = "abcdefghijklmnopqrstuvwxyz0123456789-._";
  const bool is_wide = rest.size() != small.size() && rest.find('.') == std::string_view::npos;
  return rest.empty() || is_wide || rest.find_first_not_of(allowed) != std::string_view::npos
             ? std::nullopt
             : std::optional(std::move(small));
}

/// The name of this computer below a wildcard; empty: it has none that can be there.
std::string own_name_below(const std::string& wildcard) {
  std::array<char, 256> text{};
  if (gethostname(text.data(), text.size() - 1) != 0) {
    return {};
  }
  const std::string name = text.data();
  const std::optional<std::string> label = host_name(name.substr(0, name.find('.')));
  return label ? *label + wildcard.substr(1) : std::string();
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
    if (value == nullptr) {
      continue;
    }
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
  const int position = subject == nullptr ? -1 : X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  const X509_NAME_ENTRY* const entry = position < 0 ? nullptr : X509_NAME_get_entry(subject, position);
  return entry == nullptr ? std::nullopt : host_name(bytes_of(X509_NAME_ENTRY_get_data(entry)));
}

}  // namespace

ServerCertificate::ServerCertificate(const std::filesystem::path& certificate, const std::filesystem::path& key)
    : tls_(std::make_unique<asio::ssl::context>(asio::ssl::context::tls_server)) {
  const std::string certificate_text = read_pem(certificate, "-----BEGIN CERTIFICATE-----", expected_certificate);
  const std::string key_text = read_pem(key, "PRIVATE KEY-----", expected_key);
  tls_->set_options(asio::ssl::context::no_tlsv1 | asio::ssl::context::no_tlsv1_1 | asio::ssl::context::no_compression |
                    static_cast<long>(SSL_OP_NO_RENEGOTIATION));
  const std::vector<Certificate> chain = read_chain(certificate, certificate_text);
  X509* const own = chain.front().get();
  read_names(own);
  if (names_.empty()) {
    throw InputError(certificate.string(), 0, "a certificate without a name",
                     "a name of this computer among its alternative names");
  }
  SSL_CTX* const context = tls_->native_handle();
  // SSL_CTX_use_PrivateKey() removes a certificate with a key of another kind instead of failing, so the two are
  // compared before.
  const Key private_key = key_of(chain, key, key_text);
  const int kind = EVP_PKEY_get_base_id(private_key.get());
  if (kind == EVP_PKEY_DSA) {
    throw InputError(certificate.string(), 0, "a key of DSA, which TLS 1.2 and newer do not use", "one of EC or RSA");
  }
  if (kind == EVP_PKEY_ED25519 || kind == EVP_PKEY_ED448) {
    warnings_.push_back(certificate.string() + ": browsers take no keys of ED25519 or ED448, only of EC or RSA");
  }
  if (SSL_CTX_use_certificate(context, own) != 1) {
    throw InputError(certificate.string(), 0, take_reason(), expected_certificate);
  }
  for (std::size_t i = 1; i < chain.size(); ++i) {
    if (SSL_CTX_add1_chain_cert(context, chain[i].get()) != 1) {
      throw InputError(certificate.string(), 0, take_reason(), expected_certificate);
    }
  }
  if (SSL_CTX_use_PrivateKey(context, private_key.get()) != 1 || SSL_CTX_check_private_key(context) != 1) {
    throw InputError(key.string(), 0, take_reason(), expected_key);
  }
  if (const ASN1_TIME* const end = X509_get0_notAfter(own); end != nullptr && X509_cmp_current_time(end) < 0) {
    warnings_.push_back(certificate.string() + ": the certificate has expired");
  }
  if (const ASN1_TIME* const begin = X509_get0_notBefore(own); begin != nullptr && X509_cmp_current_time(begin) > 0) {
    warnings_.push_back(certificate.string() +
                        ": the certificate is not valid yet; is the clock of this computer right?");
  }
  if (const std::optional<std::string> warning = warning_on_secret(key)) {
    warnings_.push_back(*warning);
  }
}

void ServerCertificate::read_names(const X509* certificate) {
  std::vector<std::string> all = alternative_names(certificate);
  if (all.empty()) {
    if (const std::optional<std::string> name = common_name(certificate)) {
      all.push_back(*name);
    }
  }
  for (std::string& name : all) {
    (name.front() == '*' ? wildcards_ : names_).push_back(std::move(name));
  }
  if (names_.empty() && !wildcards_.empty()) {
    if (std::string own = own_name_below(wildcards_.front()); !own.empty()) {
      names_.push_back(std::move(own));
    }
  }
}

ServerCertificate::~ServerCertificate() = default;

}  // namespace proleg::host
