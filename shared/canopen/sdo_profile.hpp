#pragma once

namespace proleg::canopen {

/// Whether a client can read values of more than four bytes, by segments or as a block. A bootloader has neither such
/// values nor room for the services: it is built with PROLEG_SDO_WITHOUT_LONG_UPLOADS, and refuses these commands.
#ifdef PROLEG_SDO_WITHOUT_LONG_UPLOADS
inline constexpr bool sdo_has_long_uploads = false;
#else
inline constexpr bool sdo_has_long_uploads = true;
#endif

}  // namespace proleg::canopen
