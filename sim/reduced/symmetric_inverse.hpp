#pragma once

#include <cstddef>

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// Inverts a positive definite matrix of n rows, from its lower half, which becomes its factors L D L^T. stride: from
/// row to row of both matrices.
template <typename Number>
inline void invert_symmetric(Number* matrix, Number* inverse_matrix, std::size_t n, std::size_t stride) {
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) {
      matrix[j * stride + j] -= matrix[j * stride + k] * matrix[j * stride + k] * matrix[k * stride + k];
    }
    const Number inverse = 1.0 / matrix[j * stride + j];
    for (std::size_t i = j + 1; i < n; ++i) {
      Number value = matrix[i * stride + j];
      for (std::size_t k = 0; k < j; ++k) {
        value -= matrix[i * stride + k] * matrix[j * stride + k] * matrix[k * stride + k];
      }
      matrix[i * stride + j] = value * inverse;
    }
  }
  for (std::size_t column = 0; column < n; ++column) {
    Number* x = inverse_matrix + column * stride;  // symmetric: a row is a column
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = Number{} + (i == column ? 1.0 : 0.0);
      for (std::size_t k = column; k < i; ++k) {
        x[i] -= matrix[i * stride + k] * x[k];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = x[i] / matrix[i * stride + i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) {
        x[i] -= matrix[k * stride + i] * x[k];
      }
    }
  }
}

/// The product of the first n rows with the vector.
template <typename Number>
inline void multiply(const Number* matrix, const Number* vector, Number* result, std::size_t n, std::size_t stride) {
  for (std::size_t i = 0; i < n; ++i) {
    Number sum{};
    for (std::size_t k = 0; k < n; ++k) {
      sum += matrix[i * stride + k] * vector[k];
    }
    result[i] = sum;
  }
}

}  // namespace
}  // namespace proleg::sim::reduced
