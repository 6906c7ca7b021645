#include "shared/image/image_header.hpp"

#include <algorithm>

#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::image {
namespace {

using namespace layout;
using Bytes = std::span<const std::uint8_t>;

std::uint16_t half_word(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(read_little_endian(bytes, at, 2));
}

template <std::size_t Size>
void read_bytes(Bytes bytes, std::size_t at, std::array<std::uint8_t, Size>& value) {
  for (std::size_t i = 0; i < Size; ++i) {
    value[i] = bytes[at + i];
  }
}

bool is_zero(Bytes bytes) {
  std::uint8_t any = 0;
  for (const std::uint8_t byte : bytes) {
    any |= byte;
  }
  return any == 0;
}

bool has_possible_values(const Summary& header, Bytes bytes) {
  constexpr std::size_t reserved_at = flags_at + 1;
  return header.lowest_revision <= header.highest_revision && header.length != 0 && header.length % 4 == 0 &&
         header.address % header_size == 0 && bytes[flags_at] <= flag_changed_sources &&
         is_zero(bytes.subspan(reserved_at, address_at - reserved_at)) &&
         is_zero(bytes.subspan(minimum_version_end, next_key_at - minimum_version_end)) &&
         is_zero(bytes.subspan(next_key_end, header_crc_at - next_key_end));
}

Error check_body(const Summary& header, Bytes hash, Bytes body) {
  if (body.size() != header.length) {
    return Error::wrong_length;
  }
  return crc32(body) == header.crc && std::ranges::equal(sha256(body), hash) ? Error::none : Error::damaged_body;
}

}  // namespace

std::string_view describe(Error error) {
  switch (error) {
    case Error::none:
      return "no error";
    case Error::too_short:
      return "it is shorter than the header of an image";
    case Error::not_an_image:
      return "it is no image of a module";
    case Error::unknown_format:
      return "its format is that of a later version";
    case Error::damaged_header:
      return "its header is damaged";
    case Error::impossible_value:
      return "its header has an impossible value";
    case Error::other_board:
      return "it is for another board";
    case Error::other_revision:
      return "it is for other hardware revisions of the board";
    case Error::other_address:
      return "it is linked for another address";
    case Error::too_large:
      return "it is too large for the board";
    case Error::wrong_length:
      return "it has not the length that its header gives";
    case Error::damaged_body:
      return "its program is damaged: the checksum is wrong";
    case Error::not_signed:
      return "it is not signed, and the module takes only signed images";
    case Error::other_key:
      return "it is signed with another key than the module expects";
    case Error::wrong_signature:
      return "its signature is not valid: it was changed after it was signed, or its maker does not have the key";
    case Error::version_too_old:
      return "its version is below the lowest that the module takes";
    case Error::unusable_key:
      return "its key for later images is no key of Ed25519";
    case Error::has_key:
      return "it has a key already; an image that is signed with that key can bring another one";
    case Error::key_too_late:
      return "it takes its first key only within ten minutes after its start: switch it off and on";
    case Error::no_room_for_key:
      return "it changes the key or the lowest version, for which the module has no room any more";
  }
  return "unknown error";
}

HeaderBytes encode(const Header& header) {
  HeaderBytes bytes = encode_fields(header);
  write_little_endian(bytes, header_crc_at, 4, crc32(Bytes(bytes).first(header_crc_at)));
  return bytes;
}

Error decode(Bytes bytes, Summary& summary) {
  if (bytes.size() < header_size) {
    return Error::too_short;
  }
  if (read_little_endian(bytes, magic_at, 4) != magic) {
    return Error::not_an_image;
  }
  if (half_word(bytes, format_at) != format || half_word(bytes, size_at) != header_size) {
    return Error::unknown_format;
  }
  if (read_little_endian(bytes, header_crc_at, 4) != crc32(bytes.first(header_crc_at))) {
    return Error::damaged_header;
  }
  summary.board_id = half_word(bytes, board_at);
  summary.lowest_revision = bytes[lowest_revision_at];
  summary.highest_revision = bytes[highest_revision_at];
  summary.address = read_little_endian(bytes, address_at, 4);
  summary.length = read_little_endian(bytes, length_at, 4);
  summary.crc = read_little_endian(bytes, body_crc_at, 4);
  return has_possible_values(summary, bytes) ? Error::none : Error::impossible_value;
}

HeaderResult decode(Bytes bytes) {
  HeaderResult result;
  Header& header = result.header;
  result.error = decode(bytes, header);
  if (result.error == Error::none) {
    header.version = read_version(bytes, version_at);
    header.protocol = half_word(bytes, protocol_at);
    header.core_fingerprint = read_little_endian(bytes, fingerprint_at, 4);
    header.settings_schema = bytes[schema_at];
    header.has_changed_sources = (bytes[flags_at] & flag_changed_sources) != 0;
    read_bytes(bytes, commit_at, header.commit);
    header.key_id = read_little_endian(bytes, key_at, 4);
    read_bytes(bytes, hash_at, header.hash);
    read_bytes(bytes, signature_at, header.signature);
    header.minimum_version = read_version(bytes, minimum_version_at);
    read_bytes(bytes, next_key_at, header.next_key);
  }
  return result;
}

Error check_place(const Summary& header, const Place& place) {
  if (header.board_id != place.board_id) {
    return Error::other_board;
  }
  if (place.revision < header.lowest_revision || place.revision > header.highest_revision) {
    return Error::other_revision;
  }
  if (header.address != place.address) {
    return Error::other_address;
  }
  return header.length > place.room ? Error::too_large : Error::none;
}

Error check_body(const Header& header, Bytes body) { return check_body(header, header.hash, body); }

Error check_image(Bytes image, const Place& place) {
  Summary summary;
  Error error = decode(image, summary);
  if (error == Error::none) {
    error = check_place(summary, place);
  }
  return error == Error::none
             ? check_body(summary, image.subspan(hash_at, std::tuple_size_v<Sha256::Hash>), image.subspan(header_size))
             : error;
}

void describe_body(Header& header, Bytes body) {
  header.length = static_cast<std::uint32_t>(body.size());
  header.crc = crc32(body);
  header.hash = sha256(body);
}

}  // namespace proleg::image
