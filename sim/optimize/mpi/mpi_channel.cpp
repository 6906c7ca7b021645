#include "sim/optimize/mpi/mpi_channel.hpp"

#include <boost/mpi/collectives.hpp>
#include <boost/serialization/string.hpp>
#include <cstdlib>

namespace proleg::optimize {
namespace {

/// Pointer to the bytes, never null, even without bytes: Boost makes a reference to the first one.
unsigned char* characters(Bytes& bytes) {
  static unsigned char nothing = 0;
  return bytes.empty() ? &nothing : reinterpret_cast<unsigned char*>(bytes.data());
}

}  // namespace

std::string MpiMessage::text() const {
  std::string text;
  for (const std::byte byte : content) {
    text.push_back(std::to_integer<char>(byte));
  }
  return text;
}

void MpiChannel::send(int rank, MpiTag tag, const Bytes& content) const {
  Bytes copy = content;
  world_.send(rank, static_cast<int>(tag), characters(copy), static_cast<int>(copy.size()));
}

void MpiChannel::send(int rank, MpiTag tag, const std::string& text) const {
  Bytes content;
  for (const char character : text) {
    content.push_back(static_cast<std::byte>(character));
  }
  send(rank, tag, content);
}

std::optional<MpiMessage> MpiChannel::receive() const {
  const auto status = world_.iprobe(boost::mpi::any_source, boost::mpi::any_tag);
  if (!status) {
    return std::nullopt;
  }
  const int size = status->count<unsigned char>().value_or(0);
  MpiMessage message{status->source(), static_cast<MpiTag>(status->tag()), Bytes(static_cast<std::size_t>(size))};
  world_.recv(status->source(), status->tag(), characters(message.content), size);
  return message;
}

std::vector<std::string> MpiChannel::exchange(const std::string& identity) const {
  std::vector<std::string> all;
  boost::mpi::all_gather(world_, identity, all);
  return all;
}

void MpiChannel::abort() const {
  boost::mpi::environment::abort(EXIT_FAILURE);
  std::abort();
}

std::string mpi_identity(const Experiment& experiment, const std::string& build_id) {
  return "experiment " + experiment.fingerprint().substr(0, 12) + " and build " + build_id;
}

}  // namespace proleg::optimize
