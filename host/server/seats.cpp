#include "host/server/seats.hpp"

#include <algorithm>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

constexpr std::string_view seat_folder = "/robots/";

}  // namespace

std::optional<SeatPath> seat_path(std::string_view target) {
  if (!target.starts_with(seat_folder)) {
    return SeatPath{std::nullopt, target};
  }
  const std::string_view rest = target.substr(seat_folder.size());
  const std::string_view digits = rest.substr(0, rest.find('/'));
  const std::optional<SeatNumber> seat = parse_whole<SeatNumber>(digits);
  // One seat has one path, because the page keeps what belongs to a seat by its path.
  if (!seat || std::to_string(*seat) != digits || digits.size() == rest.size()) {
    return std::nullopt;
  }
  return SeatPath{seat, rest.substr(digits.size())};
}

bool only_looks(std::string_view target) {
  const std::size_t mark = target.find('?');
  return mark != std::string_view::npos && target.substr(mark + 1) == "look";
}

double SendingBudget::left(Time now) const {
  const std::chrono::duration<double> passed = now - time_;
  return std::min(most_bytes, left_ + passed.count() * bytes_per_second);
}

std::chrono::milliseconds SendingBudget::spend(Time now, std::size_t bytes) {
  left_ = left(now) - static_cast<double>(bytes);
  time_ = now;
  if (left_ >= 0) {
    return std::chrono::milliseconds(0);
  }
  return std::chrono::ceil<std::chrono::milliseconds>(std::chrono::duration<double>(-left_ / bytes_per_second));
}

bool SendingBudget::is_full(Time now) const { return left(now) >= most_bytes; }

std::unique_ptr<SeatVisitors::Visit> SeatVisitors::begin(SeatNumber seat, const std::string& address,
                                                         SendingBudget::Time now) {
  // A computer that leaves and comes back does not get a new budget.
  std::erase_if(shares_, [now](const auto& share) {
    const auto& [open, budget] = *share.second;
    return open == 0 && budget.is_full(now);
  });
  auto& share = shares_[{seat, address}];
  if (share == nullptr) {
    share = std::make_shared<std::pair<unsigned, SendingBudget>>(0U, SendingBudget(now));
  }
  return share->first < max_connections ? std::make_unique<Visit>(share) : nullptr;
}

}  // namespace proleg::host
