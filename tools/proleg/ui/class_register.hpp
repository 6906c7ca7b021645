#pragma once

// Who is in a class: names instead of accounts, in a file of the class's folder.

#include <chrono>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/server/request_policy.hpp"
#include "host/server/seats.hpp"

namespace proleg::tools {

/// Why somebody cannot join. what() is one line for a person.
class JoinRefusal : public std::runtime_error {
 public:
  /// status: of HTTP.
  JoinRefusal(unsigned status, const std::string& text) : std::runtime_error(text), status_(status) {}
  [[nodiscard]] unsigned status() const { return status_; }

 private:
  unsigned status_;
};

/// What a browser sends to join (docs/page-interface.md, "A class").
struct JoinWish {
  std::string name;  ///< as the learner is called from then on
  std::string code;
  /// What the learner's browser has kept of an earlier join, or has made for this one; empty: none. A browser that
  /// makes it can ask again if the answer was lost.
  std::string key;

  /// Throws JoinRefusal.
  [[nodiscard]] static JoinWish parse(const std::string& body);
};

/// Limits the attempts to guess a code. Who has tried no wrong one is not affected by others. The time is an argument.
class WrongCodes {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds period{60};
  static constexpr std::size_t most_of_computer = 10;
  static constexpr std::size_t most_of_all = 200;

  [[nodiscard]] bool may_try(const std::string& computer, Time now);
  void note(const std::string& computer, Time now) { wrong_.push_back({now, computer}); }

 private:
  struct Attempt {
    Time time;
    std::string computer;
  };
  std::deque<Attempt> wrong_;  ///< of the last period
};

struct Learner {
  host::SeatNumber seat = 0;
  std::string name;
  std::string folder;  ///< below that of the class
  std::string key;     ///< what the learner's browser must have
  host::AccessToken token;
  bool is_let_in = false;  ///< another browser may have the name once
};

/// The teacher has seat 0.
class ClassRegister {
 public:
  static constexpr host::SeatNumber teacher = 0;
  static constexpr std::size_t most_learners = 1000;
  /// Has the tokens and keys of all learners.
  static constexpr const char* file_name = "class.json";

  /// Reads class.json of the folder, or begins a class there. No other program can have the same class as long as this
  /// object exists. Throws InputError and FileError.
  /// most_of_address: new names that computers with one address may have; this computer has no limit, because a proxy
  /// or a tunnel here gives all learners its address.
  explicit ClassRegister(std::filesystem::path folder, std::size_t most_of_address = most_learners);
  ~ClassRegister();
  ClassRegister(const ClassRegister&) = delete;
  ClassRegister& operator=(const ClassRegister&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// What a learner types to join.
  [[nodiscard]] const std::string& code() const { return code_; }
  [[nodiscard]] bool is_locked() const { return is_locked_; }
  /// Nobody new may join, also after a restart. Throws FileError.
  void lock(bool is_locked);

  /// Null: nobody has this seat. The pointer is valid until the next change.
  [[nodiscard]] const Learner* find(host::SeatNumber seat) const;
  /// The same for a name.
  [[nodiscard]] const Learner* find(const std::string& name) const;
  /// The learner who joins: one who was here before, or a new one with a folder. computer: its address. require_room:
  /// called with the learner, or null for a new one, before anything changes; it may throw. Throws JoinRefusal, and
  /// FileError.
  const Learner& join(
      const JoinWish& wish, const std::string& computer, WrongCodes::Time now,
      const std::function<void(const Learner*)>& require_room = [](const Learner*) {});
  /// Lets another browser have the name; the one before has lost it. Throws InputError, FileError.
  void let_in(host::SeatNumber seat);
  /// Frees the name and the seat. The folder stays. Throws InputError, FileError.
  void remove(host::SeatNumber seat);

 private:
  void read(const std::string& text);
  void save() const;
  /// Throws JoinRefusal if computers with this address have as many names as they may have.
  void require_seat_for(const std::string& address) const;
  /// Changes the learners and the file, or neither of them. Throws FileError.
  void change(const std::function<void()>& make);
  [[nodiscard]] Learner* with_name(const std::string& name);
  [[nodiscard]] Learner& required(host::SeatNumber seat);
  Learner& add(host::SeatNumber seat, const std::string& name, const std::string& key);

  std::filesystem::path folder_;
  int lock_ = -1;  ///< descriptor
  std::string code_;
  bool is_locked_ = false;
  std::map<host::SeatNumber, Learner> learners_;
  const std::size_t most_of_address_;
  std::map<host::SeatNumber, std::string> addresses_;  ///< of those who have got a new name since this program started
  WrongCodes wrong_codes_;
};

}  // namespace proleg::tools
