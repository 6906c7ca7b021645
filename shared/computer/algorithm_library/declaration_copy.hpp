#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "shared/gait/declaration.hpp"

namespace proleg {

/// The parts of a declaration in memory of fixed size. capture() only copies, so it may run on a declaration whose
/// pointers are wrong, in a guarded call.
struct CapturedDeclaration {
  static constexpr std::size_t max_name = 60;
  static constexpr std::size_t max_help = 400;

  /// A text or list of limited size. If it is too long it is cut, and `size` is its original size.
  template <std::size_t capacity>
  struct Text {
    std::array<char, capacity> characters;
    std::size_t size;
  };
  struct CapturedParameter {
    Text<max_name> name;
    Text<max_help> help;
    Parameter parameter;
  };
  struct CapturedValue {
    Text<max_name> name;
    Text<max_help> help;
    InternalValue value;
  };

  std::uint8_t id = 0;
  std::uint32_t sources = 0;
  Text<max_name> name{};
  Text<max_help> help{};
  std::array<CapturedParameter, max_parameters> parameters{};
  std::array<CapturedValue, max_internal_values> values{};
  std::array<FrameField, 6> frame{};
  std::size_t parameter_count = 0;
  std::size_t value_count = 0;
  std::size_t frame_count = 0;

  void capture(const Declaration& declaration);
};

/// A declaration that owns its texts and lists.
class DeclarationCopy {
 public:
  /// Checks all rules of docs/user-algorithms.md. file: name of the library. Throws InputError, which names the value
  /// that breaks a rule.
  DeclarationCopy(const CapturedDeclaration& captured, const std::string& file);
  DeclarationCopy(const DeclarationCopy&) = delete;
  DeclarationCopy& operator=(const DeclarationCopy&) = delete;

  [[nodiscard]] const Declaration& declaration() const { return declaration_; }

 private:
  std::string_view keep(std::string text);

  std::vector<std::unique_ptr<const std::string>> texts_;
  std::vector<Parameter> parameters_;
  std::vector<InternalValue> values_;
  std::vector<FrameField> frame_;
  Declaration declaration_{};
};

}  // namespace proleg
