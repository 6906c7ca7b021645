// Functions to which the compiler translates copies and comparisons. The versions in the C library are faster, but four
// times as long.

#include <cstddef>
#include <cstdint>

extern "C" {

void* memcpy(void* target, const void* source, std::size_t size) {
  auto* to = static_cast<std::uint8_t*>(target);
  for (const auto* from = static_cast<const std::uint8_t*>(source); size != 0; --size) {
    *to++ = *from++;
  }
  return target;
}

void* memmove(void* target, const void* source, std::size_t size) {
  auto* to = static_cast<std::uint8_t*>(target);
  const auto* from = static_cast<const std::uint8_t*>(source);
  if (to <= from) {
    return memcpy(target, source, size);
  }
  while (size-- != 0) {
    to[size] = from[size];
  }
  return target;
}

void* memset(void* target, int value, std::size_t size) {
  for (auto* to = static_cast<std::uint8_t*>(target); size != 0; --size) {
    *to++ = static_cast<std::uint8_t>(value);
  }
  return target;
}

int memcmp(const void* one, const void* other, std::size_t size) {
  const auto* left = static_cast<const std::uint8_t*>(one);
  for (const auto* right = static_cast<const std::uint8_t*>(other); size != 0; --size, ++left, ++right) {
    if (*left != *right) {
      return *left < *right ? -1 : 1;
    }
  }
  return 0;
}

}  // extern "C"
