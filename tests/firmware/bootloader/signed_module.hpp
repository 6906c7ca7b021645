#pragma once

#include "signed_image.hpp"
#include "updated_module.hpp"

namespace proleg::bootloader::test {

/// Who makes the images of the module, and somebody else.
inline const image::test::ImageSigner& maker() {
  static const image::test::ImageSigner signer(1);
  return signer;
}
inline const image::test::ImageSigner& stranger() {
  static const image::test::ImageSigner signer(2);
  return signer;
}

inline Image signed_by(const image::test::ImageSigner& signer, Image image) {
  image.header = signer.sign(image.header);
  return image;
}

}  // namespace proleg::bootloader::test
