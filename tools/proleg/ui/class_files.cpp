#include "tools/proleg/ui/class_files.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/recording_file.hpp"
#include "tools/proleg/ui/folder_walk.hpp"
#include "tools/proleg/ui/hand_out.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* collected_folder = "collected";

/// Without the teacher: the learners that the argument names, or all of them.
std::vector<ClassRoom::Folder> learners_in(const json& arguments, const ClassRoom& room) {
  const auto seats = argument<std::vector<host::SeatNumber>>(arguments, "seats", "numbers of seats");
  std::vector<ClassRoom::Folder> folders = room.folders();
  std::erase_if(folders, [&](const ClassRoom::Folder& folder) {
    return folder.seat == ClassRegister::teacher || (seats && std::ranges::find(*seats, folder.seat) == seats->end());
  });
  if (seats) {
    for (const host::SeatNumber seat : *seats) {
      if (std::ranges::find(folders, seat, &ClassRoom::Folder::seat) == folders.end()) {
        throw InputError("seats", 0, std::to_string(seat), "seats of learners");
      }
    }
  }
  return folders;
}

json failure(const ClassRoom::Folder& folder, const std::exception& error) {
  return {{"seat", folder.seat}, {"error", one_line(error.what())}};
}

bool is_finished(const fs::path& recording) {
  try {
    return sim::Recording(recording).finished();
  } catch (const std::exception&) {
    return false;  // it begins, or is damaged
  }
}

/// The file is whole or not there.
void copy_whole(const fs::path& from, const fs::path& into) {
  const fs::path unfinished = into.string() + ".part";
  std::error_code error;
  fs::create_directories(into.parent_path(), error);
  if (!error) {
    fs::copy_file(from, unfinished, fs::copy_options::overwrite_existing, error);
  }
  if (!error) {
    fs::rename(unfinished, into, error);
  }
  if (error) {
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw FileError(into, "cannot be written: " + error.message());
  }
}

}  // namespace

CollectedRecordings collect_recordings(const fs::path& from, const fs::path& into) {
  std::vector<fs::path> files;
  const auto add = [&](const fs::path& path) {
    std::error_code error;
    if (path.extension() == ".proleg" && fs::is_regular_file(fs::symlink_status(path, error))) {
      files.push_back(path);
    }
  };
  for_each_path(from, add, [](const fs::path& folder) { return !folder.filename().string().starts_with('.'); });
  CollectedRecordings collected;
  for (const fs::path& file : files) {
    const fs::path copy = into / file.lexically_relative(from);
    std::error_code error;
    if (fs::exists(copy, error) && fs::file_size(copy, error) == fs::file_size(file, error) && !error) {
      ++collected.known;
    } else if (!is_finished(file)) {
      ++collected.running;
    } else {
      copy_whole(file, copy);
      ++collected.copied;
    }
  }
  return collected;
}

ClassFiles::ClassFiles(ClassRoom& room, const ProjectFiles& projects, SessionRequests& requests,
                       host::SessionOutput& output)
    : SessionThread(requests, output), room_(room), projects_(projects) {
  begin_thread();
}

ClassFiles::~ClassFiles() { end_thread(); }

void ClassFiles::serve() {
  static_cast<void>(requests_.take_holder());
  static_cast<void>(take_stops());
  take_operations();
  requests_.wait();
}

json ClassFiles::carry_out(const host::OperationRequest& operation) {
  using Handler = json (ClassFiles::*)(const json&);
  static const std::map<std::string_view, Handler> handlers{{"class.projects", &ClassFiles::list_projects},
                                                            {"class.hand_out", &ClassFiles::hand_out},
                                                            {"class.collect", &ClassFiles::collect}};
  return (this->*handler_of(handlers, operation.name))(operation.arguments);
}

json ClassFiles::list_projects(const json& /*arguments*/) {
  json projects = json::array();
  for (const ProjectFile& file : projects_.list()) {
    projects.push_back({{"file", file.file}, {"group", file.group}, {"title", file.title}, {"text", file.text}});
  }
  return {{"projects", std::move(projects)}};
}

json ClassFiles::hand_out(const json& arguments) {
  const auto file = required_argument<std::string>(arguments, "file", "a scenario of class.projects");
  if (!projects_.has(file)) {
    throw InputError("file", 0, in_quotes(file), "a scenario of class.projects");
  }
  const HandOut given(file);
  json handed = json::array();
  json failed = json::array();
  for (const ClassRoom::Folder& learner : learners_in(arguments, room_)) {
    try {
      const std::string copy = given.copy_to(learner.path).string();
      static_cast<void>(room_.tell(learner.seat, {{"do", "hand_out"}, {"file", copy}, {"title", given.title()}}));
      handed.push_back({{"seat", learner.seat}, {"file", copy}});
    } catch (const std::exception& error) {
      failed.push_back(failure(learner, error));
    }
  }
  return {{"handed", std::move(handed)}, {"failed", std::move(failed)}};
}

json ClassFiles::collect(const json& arguments) {
  const std::vector<ClassRoom::Folder> folders = room_.folders();
  const auto teacher = std::ranges::find(folders, ClassRegister::teacher, &ClassRoom::Folder::seat);
  if (teacher == folders.end()) {
    throw InputError("class.collect", 0, "no folder of the teacher", "one");
  }
  CollectedRecordings all;
  json failed = json::array();
  for (const ClassRoom::Folder& learner : learners_in(arguments, room_)) {
    try {
      const CollectedRecordings some =
          collect_recordings(learner.path, teacher->path / collected_folder / learner.path.filename());
      all.copied += some.copied;
      all.known += some.known;
      all.running += some.running;
    } catch (const std::exception& error) {
      failed.push_back(failure(learner, error));
    }
  }
  return {{"copied", all.copied}, {"known", all.known}, {"running", all.running}, {"failed", std::move(failed)}};
}

}  // namespace proleg::tools
