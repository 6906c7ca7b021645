#include "tools/proleg/ui/class_register.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* lock_name = ".class.lock";
constexpr int register_version = 1;
constexpr unsigned code_digits = 6;
constexpr std::size_t most_name_characters = 40;
constexpr const char* teacher_name = "Teacher";

std::size_t character_count(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }));
}

/// The name with single blanks. Throws JoinRefusal.
std::string name_in(const std::string& text) {
  std::string name;
  for (const std::string_view word : words(text)) {
    name += (name.empty() ? "" : " ") + std::string(word);
  }
  if (name.empty() || character_count(name) > most_name_characters || !is_visible_line(name)) {
    throw JoinRefusal(400, "name: found " + in_quotes(one_line(text)) + ", expected 1 to " +
                               std::to_string(most_name_characters) + " characters that a person sees");
  }
  return name;
}

bool is_name(const std::string& text) {
  try {
    return name_in(text) == text;
  } catch (const JoinRefusal&) {
    return false;
  }
}

std::string text_member(const json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || found->is_null()) {
    return {};
  }
  if (!found->is_string()) {
    throw JoinRefusal(400, std::string(name) + ": found no text, expected one");
  }
  return found->get<std::string>();
}

/// A new folder for files of a person with this name.
std::string new_folder(const fs::path& parent, const std::string& name, host::SeatNumber seat) {
  std::string plain = name;
  try {
    static_cast<void>(new_folder_in(parent, name, "name"));
  } catch (const InputError&) {
    plain = "learner " + std::to_string(seat);  // the name is none for a folder, such as ".." or "a/b"
  }
  std::string folder = plain;
  std::error_code error;
  // A file may have this name, too: that of the class itself.
  for (int number = 2; fs::exists(fs::symlink_status(parent / folder, error)); ++number) {
    folder = plain + " " + std::to_string(number);
  }
  if (!fs::create_directory(parent / folder, error)) {
    throw FileError(parent / folder, "cannot be created: " + error.message());
  }
  return folder;
}

/// A key that is as hard to guess as ours, or a new one.
std::string key_or_new(const std::string& key) {
  return host::AccessToken::parse(key) ? key : host::AccessToken::make().text();
}

}  // namespace

JoinWish JoinWish::parse(const std::string& body) {
  // Only one level is needed: a deep text would need as much stack.
  const auto at_most_one_level = [](int depth, json::parse_event_t, json&) { return depth <= 1; };
  const json wish = json::parse(body, at_most_one_level, false);
  if (!wish.is_object()) {
    throw JoinRefusal(400, "found no object of JSON, expected one with 'name' and 'code'");
  }
  return {name_in(text_member(wish, "name")), text_member(wish, "code"), text_member(wish, "key")};
}

bool WrongCodes::may_try(const std::string& computer, Time now) {
  while (!wrong_.empty() && wrong_.front().time + period <= now) {
    wrong_.pop_front();
  }
  const auto of_computer = std::ranges::count(wrong_, computer, &Attempt::computer);
  return of_computer == 0 || (static_cast<std::size_t>(of_computer) < most_of_computer && wrong_.size() < most_of_all);
}

ClassRegister::ClassRegister(fs::path folder, std::size_t most_of_address)
    : folder_(std::move(folder)), most_of_address_(most_of_address) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (const fs::path real = fs::canonical(folder_, error); !error && fs::is_directory(real, error)) {
    folder_ = real;
  } else {
    fs::create_directories(folder_, error);  // says why there is none
    throw InputError(folder_.string(), 0, error ? error.message() : "a file",
                     "a folder for the class, or a place where one can be made");
  }
  lock_ = open((folder_ / lock_name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock_ < 0 || flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    const int reason = errno;
    if (lock_ >= 0) {
      close(lock_);
    }
    if (reason == EWOULDBLOCK) {
      throw InputError(folder_.string(), 0, "a class that another program has open", "another folder");
    }
    throw FileError(folder_ / lock_name, std::generic_category().message(reason));
  }
  const fs::path path = folder_ / file_name;
  if (fs::exists(path, error)) {
    sim::DiskFiles disk;
    read(disk.read(path).value_or("").str());
  } else {
    code_ = host::random_digits(code_digits);
  }
  if (find(teacher) == nullptr) {
    add(teacher, teacher_name, {});
  }
}

ClassRegister::~ClassRegister() { close(lock_); }

void ClassRegister::read(const std::string& text) {
  const std::string path = (folder_ / file_name).string();
  const auto fail = [&path](const std::string& found) {
    throw InputError(path, 0, found, "a file of 'proleg ui --class'; move it away to begin a new class");
  };
  const json file = json::parse(text, nullptr, false);
  if (!file.is_object() || file.value("version", json()) != json(register_version)) {
    fail(file.is_object() ? "another version" : "no object of JSON");
  }
  try {
    code_ = file.at("code").get<std::string>();
    is_locked_ = file.value("is_locked", false);
    if (!file.at("learners").is_array()) {
      fail("no list of learners");
    }
    for (const json& entry : file.at("learners")) {
      const json& seat = entry.at("seat");
      const auto name = entry.at("name").get<std::string>();
      const auto token = host::AccessToken::parse(entry.at("token").get<std::string>());
      const auto folder = entry.at("folder").get<std::string>();
      const auto key = entry.at("key").get<std::string>();
      const bool is_plain = fs::path(folder).filename() == fs::path(folder) && !folder.empty() &&
                            folder.front() != '.' && is_visible_line(folder);
      // Without a key that is hard to guess everybody could have the robot.
      const bool has_secrets = token && host::AccessToken::parse(key);
      const bool has_seat = is_whole_number<host::SeatNumber>(seat) && seat.get<host::SeatNumber>() <= most_learners;
      if (!has_seat || !has_secrets || !is_plain || !is_name(name) || find(name) != nullptr ||
          find(seat.get<host::SeatNumber>()) != nullptr) {
        fail("an unusable entry of " + in_quotes(one_line(name)));
      }
      const auto number = seat.get<host::SeatNumber>();
      learners_.emplace(number, Learner{number, name, folder, key, *token, entry.value("is_let_in", false)});
    }
  } catch (const json::exception&) {
    fail("an entry without a member that all have");
  }
  if (code_.size() != code_digits || code_.find_first_not_of("0123456789") != std::string::npos) {
    fail("no code of " + std::to_string(code_digits) + " digits");
  }
}

void ClassRegister::save() const {
  json learners = json::array();
  for (const auto& [seat, learner] : learners_) {
    learners.push_back({{"seat", seat},
                        {"name", learner.name},
                        {"folder", learner.folder},
                        {"key", learner.key},
                        {"token", learner.token.text()},
                        {"is_let_in", learner.is_let_in}});
  }
  const json file{
      {"version", register_version}, {"code", code_}, {"is_locked", is_locked_}, {"learners", std::move(learners)}};
  host::write_private_file(folder_ / file_name, file.dump(2) + "\n");
}

const Learner* ClassRegister::find(host::SeatNumber seat) const {
  const auto found = learners_.find(seat);
  return found == learners_.end() ? nullptr : &found->second;
}

const Learner* ClassRegister::find(const std::string& name) const {
  const auto found = std::ranges::find_if(
      learners_, [&name](const auto& entry) { return lower_case(entry.second.name) == lower_case(name); });
  return found == learners_.end() ? nullptr : &found->second;
}

void ClassRegister::change(const std::function<void()>& make) {
  const std::map<host::SeatNumber, Learner> before = learners_;
  make();
  try {
    save();
  } catch (...) {
    learners_ = before;
    throw;
  }
}

Learner& ClassRegister::required(host::SeatNumber seat) {
  const auto found = learners_.find(seat);
  if (found == learners_.end() || seat == teacher) {
    throw InputError("seat", 0, std::to_string(seat), "the seat of a learner");
  }
  return found->second;
}

Learner* ClassRegister::with_name(const std::string& name) {
  const Learner* const found = find(name);
  return found == nullptr ? nullptr : &learners_.at(found->seat);
}

Learner& ClassRegister::add(host::SeatNumber seat, const std::string& name, const std::string& key) {
  Learner learner{seat, name, new_folder(folder_, name, seat), key_or_new(key), host::AccessToken::make(), false};
  const fs::path path = folder_ / learner.folder;
  try {
    change([&] { learners_.emplace(seat, std::move(learner)); });
  } catch (...) {
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
  return learners_.at(seat);
}

const Learner& ClassRegister::join(const JoinWish& wish, const std::string& computer, WrongCodes::Time now,
                                   const std::function<void(const Learner*)>& require_room) {
  Learner* const known = with_name(wish.name);
  if (known != nullptr && known->seat != teacher && !known->is_let_in && known->key == wish.key) {
    require_room(known);
    return *known;
  }
  if (!wrong_codes_.may_try(computer, now)) {
    throw JoinRefusal(429, "found too many wrong codes, expected none for a minute; then try again");
  }
  if (wish.code != code_) {
    wrong_codes_.note(computer, now);
    throw JoinRefusal(403, wish.code.empty() ? "found no code, expected the one that your teacher shows"
                                             : "found another code, expected the one that your teacher shows");
  }
  if (known != nullptr && !known->is_let_in) {
    throw JoinRefusal(409, "somebody has the name " + in_quotes(known->name) +
                               " already, expected another one; if it is you, your teacher can let you in again");
  }
  if (known != nullptr) {
    require_room(known);
    change([&] {
      known->key = key_or_new(wish.key);
      known->is_let_in = false;
    });
    return *known;
  }
  if (is_locked_) {
    throw JoinRefusal(409, "the class is locked, so nobody new can join; your teacher can unlock it");
  }
  host::SeatNumber seat = teacher + 1;
  while (learners_.contains(seat)) {
    ++seat;
  }
  if (seat > most_learners) {
    throw JoinRefusal(503, "found " + std::to_string(most_learners) + " names, expected fewer; ask your teacher");
  }
  require_seat_for(computer);
  require_room(nullptr);
  const Learner& learner = add(seat, wish.name, wish.key);
  addresses_[seat] = computer;
  return learner;
}

void ClassRegister::require_seat_for(const std::string& address) const {
  const bool is_this_computer = address == "127.0.0.1" || address == "::1" || address == "::ffff:127.0.0.1";
  const auto has = std::ranges::count_if(addresses_, [&](const auto& entry) { return entry.second == address; });
  if (!is_this_computer && static_cast<std::size_t>(has) >= most_of_address_) {
    throw JoinRefusal(503, "found " + std::to_string(has) +
                               " names from the address of this computer, expected at most " +
                               std::to_string(most_of_address_) +
                               ": go on with one of them, or ask your teacher (option --seats-per-address)");
  }
}

void ClassRegister::lock(bool is_locked) {
  const bool before = std::exchange(is_locked_, is_locked);
  try {
    save();
  } catch (...) {
    is_locked_ = before;
    throw;
  }
}

void ClassRegister::let_in(host::SeatNumber seat) {
  Learner& learner = required(seat);
  change([&learner] {
    learner.key = host::AccessToken::make().text();
    learner.token = host::AccessToken::make();
    learner.is_let_in = true;
  });
}

void ClassRegister::remove(host::SeatNumber seat) {
  static_cast<void>(required(seat));
  change([this, seat] { learners_.erase(seat); });
  addresses_.erase(seat);
}

}  // namespace proleg::tools
