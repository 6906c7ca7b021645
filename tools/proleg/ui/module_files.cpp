#include "tools/proleg/ui/module_files.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "host/flash/image_file.hpp"
#include "host/flash/module_program.hpp"
#include "host/transport/open_transport.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/ui/folder_walk.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t most_files = 200;

fs::path built_image() { return image_folder() / "proleg_stm32f405.pimg"; }

json image_json(const std::string& name, const fs::path& path) {
  json object{{"file", name},     {"version", nullptr}, {"commit", nullptr},
              {"board", nullptr}, {"sha256", nullptr},  {"problem", nullptr}};
  try {
    const host::ImageFile image = host::read_image(path.string());
    object["version"] = host::version_number_text(image.header.version);
    object["commit"] = host::commit_text(image.header);
    object["board"] = image.header.board_id;
    object["sha256"] = hexadecimal_digits(image.header.hash);
  } catch (const InputError& error) {
    object["problem"] = one_line(error.what());
  }
  return object;
}

/// A file of a project, also by a link within it. A viewer must not read what is elsewhere.
bool is_file_of(const fs::path& project, const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && is_inside(fs::canonical(project, error), fs::canonical(path, error));
}

}  // namespace

void ModuleFiles::look() {
  images_.clear();
  settings_.clear();
  const auto enters = [](const fs::path& folder) { return !folder.filename().string().starts_with("."); };
  for_each_path(
      project_,
      [this](const fs::path& path) {
        if (path.extension() == image_extension && images_.size() < most_files && is_file_of(project_, path)) {
          images_.push_back({path.lexically_relative(project_).string(), path});
        }
      },
      enters);
  std::ranges::sort(images_, {}, &Image::name);
  std::error_code error;
  if (const fs::path built = built_image(); fs::is_regular_file(built, error)) {
    images_.push_back({built.string(), built});
  }
  images_json_ = json::array();
  for (const Image& image : images_) {
    images_json_.push_back(image_json(image.name, image.path));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(project_, error)) {
    if (entry.path().extension() == settings_extension && settings_.size() < most_files &&
        is_file_of(project_, entry.path())) {
      settings_.push_back(entry.path().filename().string());
    }
  }
  std::ranges::sort(settings_);
}

fs::path ModuleFiles::image(const std::string& name) const {
  const auto found = std::ranges::find(images_, name, &Image::name);
  if (found == images_.end()) {
    throw InputError("image", 0, in_quotes(one_line(name)), "an image of the list");
  }
  static_cast<void>(host::read_image(found->path.string()));
  return fs::absolute(found->path);
}

fs::path ModuleFiles::settings(const std::string& name) const {
  if (std::ranges::find(settings_, name) == settings_.end()) {
    throw InputError("file", 0, in_quotes(one_line(name)), "a file of the list");
  }
  return fs::absolute(project_ / name);
}

fs::path ModuleFiles::new_settings(const std::string& name) const {
  constexpr std::size_t longest = 60;
  const bool is_name = is_visible_line(name) && name.size() <= longest && name.find('/') == std::string::npos &&
                       !name.starts_with(".") && name.ends_with(settings_extension);
  if (!is_name) {
    throw InputError("file", 0, in_quotes(one_line(name)), "a short name without a folder that ends in .params");
  }
  fs::path path = fs::absolute(project_ / name);
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) {
    throw InputError("file", 0, in_quotes(name) + ", which exists", "a new name");
  }
  return path;
}

}  // namespace proleg::tools
