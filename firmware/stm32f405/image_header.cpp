// The header of the image, in front of the vector table. complete_image.py writes the fields that are known only after
// linking: length, checksums and hash.

#include "shared/image/image_header.hpp"
#include "firmware/module/board_record.hpp"
#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "image_commit.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/kernel/fingerprint.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr image::HeaderBytes make_header() {
  image::Header header;
  header.board_id = board::id;
  header.lowest_revision = board::revision;
  header.highest_revision = board::revision;
  header.version = {PROLEG_IMAGE_VERSION};
  header.protocol = canopen::protocol_version;
  header.core_fingerprint = core_fingerprint;
  header.settings_schema = firmware::BoardRecord::schema;
  header.has_changed_sources = PROLEG_IMAGE_HAS_CHANGES;
  header.commit = PROLEG_IMAGE_COMMIT;
  header.address = flash_layout::slot_a + image::header_size;
  return image::layout::encode_fields(header);
}

[[gnu::section(".image_header"), gnu::used]] constinit const image::HeaderBytes header = make_header();

}  // namespace
}  // namespace proleg::stm32f405
