#include "tools/proleg/run/receipt_text.hpp"

#include <optional>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/measure/measure.hpp"

namespace proleg::tools {
namespace {

constexpr std::string_view first_word = "proleg-receipt:1";

struct Word {
  std::string_view name;
  std::string Receipt::*text;
};
constexpr Word required_words[] = {{"scenario", &Receipt::scenario},
                                   {"core", &Receipt::core},
                                   {"engine", &Receipt::engine},
                                   {"seconds", &Receipt::seconds},
                                   {"world", &Receipt::world}};

[[noreturn]] void refuse(const std::string& found, const std::string& expected) {
  throw InputError("the receipt", 0, found, expected);
}

void take(std::string& place, std::string_view name, std::string_view text) {
  if (!place.empty()) {
    refuse("two words for " + in_quotes(name), "one");
  }
  place = text;
}

const sim::OverrideDeclaration* find_override(std::string_view name) {
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (declaration.name == name && name != "engine") {
      return &declaration;
    }
  }
  return nullptr;
}

void read_word(std::string_view word, Receipt& receipt) {
  const std::size_t equals = word.find('=');
  const std::string_view name = word.substr(0, equals);
  const std::string_view text = equals == std::string_view::npos ? "" : word.substr(equals + 1);
  if (text.empty()) {
    refuse(in_quotes(word), "NAME=TEXT");
  }
  for (const Word& required : required_words) {
    if (required.name == name) {
      take(receipt.*required.text, name, text);
      return;
    }
  }
  if (name == "set") {
    receipt.settings.emplace_back(text);
  } else if (const sim::OverrideDeclaration* const declaration = find_override(name)) {
    std::optional<std::string>& place = receipt.overrides.*declaration->word;
    if (place) {
      refuse("two words for " + in_quotes(name), "one");
    }
    place = text;
  } else if (sim::find_measure(name)) {
    take(receipt.measure, "the measure", name);
    receipt.value = text;
  } else {
    refuse(in_quotes(word), "a word of 'proleg receipt': another version may have written it");
  }
}

}  // namespace

std::string text_of(const Receipt& receipt) {
  std::string text(first_word);
  const auto add = [&](std::string_view name, const std::string& value) {
    text += ' ' + std::string(name) + '=' + value;
  };
  add("scenario", receipt.scenario);
  add("core", receipt.core);
  add("engine", receipt.engine);
  add("seconds", receipt.seconds);
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& word = receipt.overrides.*declaration.word) {
      add(declaration.name, *word);
    }
  }
  for (const std::string& setting : receipt.settings) {
    add("set", setting);
  }
  add(receipt.measure, receipt.value);
  add("world", receipt.world);
  return text;
}

Receipt read_receipt(std::string_view text) {
  const std::vector<std::string_view> all = words(text);
  if (all.empty() || all.front() != first_word) {
    refuse(all.empty() ? "nothing" : in_quotes(all.front()),
           in_quotes(first_word) + " and more, as 'proleg receipt FILE' prints it");
  }
  Receipt receipt;
  for (std::size_t i = 1; i < all.size(); ++i) {
    read_word(all[i], receipt);
  }
  for (const Word& required : required_words) {
    if ((receipt.*required.text).empty()) {
      refuse("no word " + in_quotes(std::string(required.name) + "="), "the whole line");
    }
  }
  if (receipt.measure.empty()) {
    refuse("no measure", "the whole line");
  }
  return receipt;
}

}  // namespace proleg::tools
