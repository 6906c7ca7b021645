#pragma once

// What `proleg verify` builds from the folder of a user's algorithm.

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace proleg::verify {

/// A build failed: one line with the first error and the file that has all of them.
class BuildError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The builds of one algorithm, in build/verify/ of its folder, or if that cannot be written, in a folder of the user's
/// cache (XDG_CACHE_HOME). They are kept, so the next time only changes are built.
class UserBuilds {
 public:
  /// tree: the sources of Proleg. folder: the algorithm's, absolute. Throws BuildError if there is no place for builds.
  UserBuilds(std::filesystem::path tree, std::filesystem::path folder);

  /// The folder of all builds.
  [[nodiscard]] const std::filesystem::path& place() const { return place_; }
  /// Whether that is not in the folder of the algorithm.
  [[nodiscard]] bool are_aside() const { return place_ != folder_ / "build/verify"; }

  /// The algorithm's name, which is that of its source. Throws BuildError if the folder has no such source.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool has_test() const;

  // All of the following throw BuildError.

  /// NAME.so and NAME_test, as the folder's own CMakeLists.txt builds them.
  [[nodiscard]] std::filesystem::path library() const;
  /// Runs NAME_test of that build.
  void run_test() const;
  /// The folder with the programs variant_O0 and variant_O2 of a compiler.
  [[nodiscard]] std::filesystem::path variants(const std::string& compiler) const;
  /// preset: stm32f405 or cortex-m0. The object file of the algorithm's source.
  [[nodiscard]] std::filesystem::path cortex_m_object(const std::string& preset) const;
  /// The test image with the algorithm. Its bounds of the stack are beside it, in core_image.stack.tsv.
  [[nodiscard]] std::filesystem::path cortex_m_image(const std::string& preset) const;

 private:
  void run(const std::string& what, const std::vector<std::string>& command) const;
  [[nodiscard]] std::filesystem::path choose_place() const;
  [[nodiscard]] std::filesystem::path build_folder(const std::string& what) const;
  void configure(const std::string& what, const std::filesystem::path& source,
                 const std::vector<std::string>& options) const;
  void configure_cortex_m(const std::string& preset) const;

  std::filesystem::path tree_;
  std::filesystem::path folder_;
  std::string name_;
  std::filesystem::path place_;
};

}  // namespace proleg::verify
