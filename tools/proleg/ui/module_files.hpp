#pragma once

// The files of a project that jobs on modules use: images and settings.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace proleg::tools {

class ModuleFiles {
 public:
  static constexpr const char* image_extension = ".pimg";
  static constexpr const char* settings_extension = ".params";

  /// project: its folder.
  explicit ModuleFiles(std::filesystem::path project) : project_(std::move(project)) {}

  /// Looks for them again: images in the project and in the folders in it, the image that was built beside this
  /// program, and settings in the project itself.
  void look();

  /// As in the document `modules`.
  [[nodiscard]] const nlohmann::json& images() const { return images_json_; }
  [[nodiscard]] const std::vector<std::string>& settings() const { return settings_; }

  /// The path of an image of the list. Throws InputError for another name, or if it is no intact image.
  [[nodiscard]] std::filesystem::path image(const std::string& name) const;
  /// The path of settings of the list. Throws InputError for another name.
  [[nodiscard]] std::filesystem::path settings(const std::string& name) const;
  /// The path of a new file with settings. Throws InputError for a name that is none, or of a file that exists.
  [[nodiscard]] std::filesystem::path new_settings(const std::string& name) const;

 private:
  struct Image {
    std::string name;  ///< below the project, or the whole path of one that is not in it
    std::filesystem::path path;
  };

  std::filesystem::path project_;
  std::vector<Image> images_;
  nlohmann::json images_json_ = nlohmann::json::array();
  std::vector<std::string> settings_;
};

}  // namespace proleg::tools
