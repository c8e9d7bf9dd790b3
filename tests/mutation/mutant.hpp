// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <type_traits>
#include <utility>

/// Every mutant of a source is in one program, and TUINA_MUTANT chooses which one is alive:
/// mutate.py writes the sources anew with calls of these functions in the place of operators,
/// constants and conditions. Each function takes the number of its first mutant; the mutants after
/// it count on.
namespace tuina::mutation {

inline int chosen() {
  static const int number = [] {
    const char* text = std::getenv("TUINA_MUTANT");
    return text == nullptr ? -1 : std::atoi(text);
  }();
  return number;
}
inline bool is(int number) {
  return chosen() == number;
}

/// The value of an expression, which for Eigen is a matrix and no promise to compute one.
template <typename T>
auto value(const T& x) {
  if constexpr (requires { x.eval(); }) {
    return typename T::PlainObject(x);
  } else {
    return x;
  }
}

#define TUINA_OPERATOR(name, op)                                           \
  struct name {                                                            \
    static auto of(const auto& a, const auto& b) { return value(a op b); } \
  };
TUINA_OPERATOR(less, <)
TUINA_OPERATOR(at_most, <=)
TUINA_OPERATOR(more, >)
TUINA_OPERATOR(at_least, >=)
TUINA_OPERATOR(equal, ==)
TUINA_OPERATOR(unequal, !=)
TUINA_OPERATOR(plus, +)
TUINA_OPERATOR(minus, -)
TUINA_OPERATOR(times, *)
TUINA_OPERATOR(over, /)
#undef TUINA_OPERATOR
struct left {
  static auto of(const auto& a, const auto&) { return value(a); }
};
struct scaled_down {  // the scalar stands before the vector
  static auto of(const auto& a, const auto& b) { return value(b / a); }
};

/// The operator `Original`, or one of the others in its place.
template <typename Original, typename... Others>
auto binary(int number, const auto& a, const auto& b) {
  auto result = Original::of(a, b);
  int i = number;
  ((is(i++) ? void(result = Others::of(a, b)) : void()), ...);
  return result;
}

/// The operands of a logical operator are functions, so that the right one is still left out where
/// it must be.
inline bool both(int number, auto&& a, auto&& b) {
  if (is(number)) return a() || b();
  if (is(number + 1)) return a();
  if (is(number + 2)) return b();
  return a() && b();
}
inline bool either(int number, auto&& a, auto&& b) {
  if (is(number)) return a() && b();
  if (is(number + 1)) return a();
  if (is(number + 2)) return b();
  return a() || b();
}

inline bool condition(int number, bool holds) {
  return is(number) || (holds && !is(number + 1));
}

template <typename T, typename... Others>
T constant(int number, T original, Others... others) {
  T result = original;
  int i = number;
  ((is(i++) ? void(result = static_cast<T>(others)) : void()), ...);
  return result;
}

inline auto negated(int number, const auto& x) {
  return is(number) ? value(x) : value(-x);
}
inline bool inverted(int number, bool x) {
  return is(number) ? x : !x;
}

/// A returned value: nothing, or the other truth, instead.
template <typename T>
T returned(int number, const T& x) {
  if (!is(number)) return x;
  if constexpr (std::is_same_v<T, bool>) {
    return !x;
  } else {
    return value(x - x);
  }
}

}  // namespace tuina::mutation
