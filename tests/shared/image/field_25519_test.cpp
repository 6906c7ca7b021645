// The arithmetic of the field against the integers of OpenSSL.

#include "shared/image/field_25519.hpp"

#include <gtest/gtest.h>
#include <openssl/bn.h>

#include <array>
#include <cstdio>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace proleg::image::field_25519 {
namespace {

constexpr std::uint32_t seed = 7;

/// An integer of OpenSSL.
class Integer {
 public:
  explicit Integer(const char* digits) { set(digits); }
  explicit Integer(const Number& number) { set(digits_of(number).c_str()); }

  static std::string digits_of(const Number& number) {
    std::string digits;
    for (auto word = number.rbegin(); word != number.rend(); ++word) {
      std::array<char, 9> text{};
      std::snprintf(text.data(), text.size(), "%08x", *word);
      digits += text.data();
    }
    return digits;
  }

  [[nodiscard]] Number number() const {
    std::array<std::uint8_t, 32> bytes{};
    check(BN_bn2lebinpad(value_.get(), bytes.data(), bytes.size()) == static_cast<int>(bytes.size()));
    return read_number(bytes);
  }

  /// Applies one of OpenSSL's operations modulo p.
  template <typename Function, typename... Operands>
  static Integer modulo_prime(Function function, const Operands&... operands) {
    static const std::unique_ptr<BN_CTX, decltype(&BN_CTX_free)> context(BN_CTX_new(), &BN_CTX_free);
    static const Integer modulus("7fffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffed");
    Integer result("0");
    check(function(result.value_.get(), operands.value_.get()..., modulus.value_.get(), context.get()) == 1);
    return result;
  }

 private:
  static void check(bool has_worked) {
    if (!has_worked) {
      throw std::runtime_error("libcrypto: cannot compute with an integer");
    }
  }
  void set(const char* digits) {
    BIGNUM* value = nullptr;
    check(BN_hex2bn(&value, digits) > 0);
    value_.reset(value);
  }

  std::unique_ptr<BIGNUM, decltype(&BN_free)> value_{nullptr, &BN_free};
};

/// Numbers at which a carry or a borrow begins or ends: close to 0, p, 2^255, 2 p and 2^256, and with words of 0 or of
/// ones.
std::vector<Number> special_numbers() {
  std::vector<Number> numbers;
  for (const std::uint32_t low : {0U, 1U, 2U, 18U, 19U, 20U, 37U, 38U, 39U, 0x7fffffffU, 0xffffffdaU, 0xffffffffU}) {
    numbers.push_back({low});
  }
  for (const std::uint32_t high : {0x7fffffffU, 0xffffffffU}) {
    for (const std::uint32_t low :
         {0xffffffd9U, 0xffffffdaU, 0xffffffdbU, 0xffffffecU, 0xffffffedU, 0xffffffeeU, 0xffffffffU}) {
      Number number;
      number.fill(0xffffffff);
      number.front() = low;
      number.back() = high;
      numbers.push_back(number);
    }
  }
  for (const std::uint32_t high : {1U, 0x80000000U, 0xffffffffU}) {
    numbers.push_back({0, 0, 0, 0, 0, 0, 0, high});
    numbers.push_back({high, 0, 0xffffffff, 0, 0xffffffff, 0, 0xffffffff, high});
  }
  return numbers;
}

Number random_number(std::mt19937& random) {
  Number number;
  for (std::uint32_t& word : number) {
    const std::uint32_t kind = random() % 8;
    word = kind == 0 ? 0 : kind == 1 ? 0xffffffff : static_cast<std::uint32_t>(random());
  }
  return number;
}

std::vector<std::pair<Number, Number>> pairs() {
  const std::vector<Number> special = special_numbers();
  std::vector<std::pair<Number, Number>> all;
  for (const Number& one : special) {
    for (const Number& other : special) {
      all.emplace_back(one, other);
    }
  }
  std::mt19937 random(seed);
  for (int i = 0; i < 3'000; ++i) {
    all.emplace_back(random_number(random), random_number(random));
  }
  return all;
}

Number canonical(Number number) {
  make_canonical(number);
  return number;
}

TEST(Field25519, AddsSubtractsAndMultipliesModuloThePrime) {
  for (const auto& [one, other] : pairs()) {
    SCOPED_TRACE(Integer::digits_of(one) + " and " + Integer::digits_of(other));
    Element result;
    add(result, one, other);
    ASSERT_EQ(canonical(result), Integer::modulo_prime(BN_mod_add, Integer(one), Integer(other)).number());
    subtract(result, one, other);
    ASSERT_EQ(canonical(result), Integer::modulo_prime(BN_mod_sub, Integer(one), Integer(other)).number());
    multiply(result, one, other);
    ASSERT_EQ(canonical(result), Integer::modulo_prime(BN_mod_mul, Integer(one), Integer(other)).number());
  }
}

TEST(Field25519, WritesAResultOverItsOperands) {
  for (const auto& [one, other] : pairs()) {
    SCOPED_TRACE(Integer::digits_of(one) + " and " + Integer::digits_of(other));
    for (const auto operation : {&add, &subtract, &multiply}) {
      Element expected;
      operation(expected, one, other);
      Element result = one;
      operation(result, result, other);
      ASSERT_EQ(result, expected);
      result = other;
      operation(result, one, result);
      ASSERT_EQ(result, expected);
      operation(expected, one, one);
      result = one;
      operation(result, result, result);
      ASSERT_EQ(result, expected);
    }
  }
}

TEST(Field25519, RaisesToThePowersOfRootsAndInverses) {
  const Integer root("0ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffd");     // (p - 5) / 8
  const Integer inverse("7fffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffeb");  // p - 2
  std::vector<Number> numbers = special_numbers();
  std::mt19937 random(seed);
  for (int i = 0; i < 30; ++i) {
    numbers.push_back(random_number(random));
  }
  for (const Number& number : numbers) {
    SCOPED_TRACE(Integer::digits_of(number));
    ASSERT_EQ(canonical(root_power(number)), Integer::modulo_prime(BN_mod_exp, Integer(number), root).number());
    ASSERT_EQ(canonical(invert(number)), Integer::modulo_prime(BN_mod_exp, Integer(number), inverse).number());
  }
}

TEST(Field25519, KnowsTheRepresentationsOfAnElement) {
  // 5, p + 5 and 2 p + 5; 2^256 is 2 p + 38.
  const std::array<Number, 3> five{number_of("0000000000000000000000000000000000000000000000000000000000000005"),
                                   number_of("7ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff2"),
                                   number_of("ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffdf")};
  for (const Number& one : five) {
    EXPECT_EQ(canonical(one), five.front());
    for (const Number& other : five) {
      EXPECT_TRUE(is_same(one, other));
    }
    EXPECT_FALSE(is_same(one, {6}));
    EXPECT_FALSE(is_same({4}, one));
  }
  EXPECT_EQ(canonical(prime), Number{});
}

TEST(Field25519, SubtractsAModulusOnceWhereItFits) {
  Number number = prime;
  number.front() -= 1;
  EXPECT_FALSE(reduce_once(number, prime));
  number.front() += 1;
  EXPECT_EQ(number, prime);
  EXPECT_TRUE(reduce_once(number, prime));
  EXPECT_EQ(number, Number{});
  number.fill(0xffffffff);
  EXPECT_TRUE(reduce_once(number, prime));
  EXPECT_EQ(number, number_of("8000000000000000000000000000000000000000000000000000000000000012"));
}

TEST(Field25519, ReadsTheLowestByteFirst) {
  std::array<std::uint8_t, 32> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(i);
  }
  EXPECT_EQ(read_number(bytes), number_of("1f1e1d1c1b1a191817161514131211100f0e0d0c0b0a09080706050403020100"));
}

}  // namespace
}  // namespace proleg::image::field_25519
